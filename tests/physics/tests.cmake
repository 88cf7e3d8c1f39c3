# GCC 12 takes vectors of three numbers, read as part of a wide one, for reads beyond their end.
set_source_files_properties(physics/material/rotation_test.cpp physics/model/rods_test.cpp
  PROPERTIES COMPILE_OPTIONS $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)
supple_test(physics LABEL unit LINKS supple::physics supple::eigensolver
  SOURCES physics/body/locking_test.cpp physics/body/supports_test.cpp physics/heat/heat_conduction_test.cpp physics/material/materials_test.cpp
          physics/material/rotation_test.cpp physics/mesh/cell_mesh_test.cpp physics/mesh/elements_test.cpp
          physics/mesh/tet_mesh_test.cpp physics/mesh/triangle_mesh_test.cpp physics/model/discrete_shell_test.cpp
          physics/model/force_model_test.cpp physics/model/rods_test.cpp physics/model/solid_conformance_test.cpp
          physics/model/tet_elasticity_test.cpp physics/statics/static_solver_test.cpp
          physics/system/dynamical_system_test.cpp physics/system/full_system_test.cpp
          physics/system/nodal_frames_test.cpp physics/time/first_order_test.cpp physics/time/newmark_test.cpp)
supple_test(time_integrators OPTIMIZED LABEL unit LINKS supple::physics
  SOURCES physics/time/energy_test.cpp physics/time/time_integrator_test.cpp)
supple_test(mixed_systems LABEL unit LINKS supple::reduction
  SOURCES physics/load/outside_force_test.cpp physics/model/composite_model_test.cpp physics/system/any_system_test.cpp)

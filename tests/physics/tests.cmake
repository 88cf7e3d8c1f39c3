supple_test(cholmod_solver LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/cholmod_solver_test.cpp LINKS supple::physics)
supple_test(physics LABEL unit LINKS supple::physics
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/dynamical_system_test.cpp ${CMAKE_CURRENT_LIST_DIR}/force_model_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/full_system_test.cpp ${CMAKE_CURRENT_LIST_DIR}/materials_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/newmark_test.cpp ${CMAKE_CURRENT_LIST_DIR}/newton_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/static_solver_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/tet_elasticity_test.cpp ${CMAKE_CURRENT_LIST_DIR}/tet_mesh_test.cpp)
supple_test(shells LABEL unit LINKS supple::physics
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/discrete_shell_test.cpp ${CMAKE_CURRENT_LIST_DIR}/triangle_mesh_test.cpp)
supple_test(elements LABEL unit LINKS supple::physics
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/elements_test.cpp ${CMAKE_CURRENT_LIST_DIR}/solid_conformance_test.cpp)
supple_test(rods LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/rods_test.cpp LINKS supple::physics)
supple_test(composite_model LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/composite_model_test.cpp LINKS supple::reduction)

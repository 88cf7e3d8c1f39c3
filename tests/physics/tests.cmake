supple_test(cholmod_solver LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/cholmod_solver_test.cpp LINKS supple::physics)
supple_test(physics LABEL unit LINKS supple::physics
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/dynamical_system_test.cpp ${CMAKE_CURRENT_LIST_DIR}/force_model_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/full_system_test.cpp ${CMAKE_CURRENT_LIST_DIR}/materials_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/newmark_test.cpp ${CMAKE_CURRENT_LIST_DIR}/newton_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/rotation_test.cpp ${CMAKE_CURRENT_LIST_DIR}/static_solver_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/tet_elasticity_test.cpp ${CMAKE_CURRENT_LIST_DIR}/tet_mesh_test.cpp)
supple_test(shells LABEL unit LINKS supple::physics
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/discrete_shell_test.cpp ${CMAKE_CURRENT_LIST_DIR}/triangle_mesh_test.cpp)
supple_test(elements LABEL unit LINKS supple::physics
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/elements_test.cpp ${CMAKE_CURRENT_LIST_DIR}/solid_conformance_test.cpp)
supple_test(cell_mesh LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/cell_mesh_test.cpp LINKS supple::physics)
supple_test(rods LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/rods_test.cpp LINKS supple::physics)
supple_test(composite_model LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/composite_model_test.cpp LINKS supple::reduction)

if(TARGET gent_plugin)  # an example
  foreach(plugin no_plugin other_version twice)
    supple_plugin(${plugin} ${PROJECT_SOURCE_DIR}/tests/plugins/${plugin}.cpp)
    target_include_directories(${plugin} PRIVATE ${PROJECT_SOURCE_DIR})
    supple_build_options(${plugin})
    set_target_properties(${plugin} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/plugins)
  endforeach()
  supple_test(plugin LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/plugin_test.cpp LINKS supple::physics supple::testing)
  target_compile_definitions(test_plugin PRIVATE SUPPLE_PLUGINS="${PROJECT_BINARY_DIR}/plugins")
  add_dependencies(test_plugin no_plugin other_version twice gent_plugin spring_tets_plugin)
endif()
supple_test(heat LABEL unit LINKS supple::physics
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/first_order_test.cpp ${CMAKE_CURRENT_LIST_DIR}/heat_conduction_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/lu_solver_test.cpp)

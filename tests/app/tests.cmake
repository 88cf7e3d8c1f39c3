if(TARGET supple)
  supple_test(app LABEL unit
    LINKS supple::reduction supple::io nlohmann_json::nlohmann_json
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/reduce_command_test.cpp ${CMAKE_CURRENT_LIST_DIR}/simulate_command_test.cpp
            ${CMAKE_CURRENT_LIST_DIR}/compare_selectors_test.cpp ${CMAKE_CURRENT_LIST_DIR}/edit_command_test.cpp ${CMAKE_CURRENT_LIST_DIR}/select_command_test.cpp ${CMAKE_CURRENT_LIST_DIR}/command_line_test.cpp ${CMAKE_CURRENT_LIST_DIR}/supple_process.cpp)
  target_compile_definitions(test_app PRIVATE SUPPLE_COMMAND="$<TARGET_FILE:supple>"
    SUPPLE_README="${PROJECT_SOURCE_DIR}/README.md")
  add_dependencies(test_app supple)
  if(TARGET gent_plugin)
    target_compile_definitions(test_app PRIVATE SUPPLE_PLUGINS="${PROJECT_BINARY_DIR}/plugins")
    add_dependencies(test_app gent_plugin no_plugin spring_tets_plugin)
  endif()
  supple_test(real_shapes LABEL slow LINKS supple::core nlohmann_json::nlohmann_json
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/real_shapes_test.cpp ${CMAKE_CURRENT_LIST_DIR}/supple_process.cpp)
  target_compile_definitions(test_real_shapes PRIVATE SUPPLE_COMMAND="$<TARGET_FILE:supple>"
    SUPPLE_SHARED_MESHES="${PROJECT_SOURCE_DIR}/../shared/meshes")
  add_dependencies(test_real_shapes supple)
endif()

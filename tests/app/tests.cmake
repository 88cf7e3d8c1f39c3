if(TARGET supple)
  supple_test(app LABEL unit
    LINKS supple::reduction supple::io supple::pictures nlohmann_json::nlohmann_json
    SOURCES app/command_line_test.cpp app/compare_selectors_test.cpp app/edit_command_test.cpp app/model_search_test.cpp
            app/pareto_test.cpp app/reduce_command_test.cpp app/select_command_test.cpp app/simulate_command_test.cpp app/static_command_test.cpp app/stress_command_test.cpp
            app/supple_process.cpp)
  target_compile_definitions(test_app PRIVATE SUPPLE_COMMAND="$<TARGET_FILE:supple>"
    SUPPLE_README="${PROJECT_SOURCE_DIR}/README.md")
  add_dependencies(test_app supple)
  if(TARGET gent_plugin)
    target_compile_definitions(test_app PRIVATE SUPPLE_PLUGINS="${PROJECT_BINARY_DIR}/plugins")
    add_dependencies(test_app gent_plugin no_plugin spring_tets_plugin)
  endif()
  supple_test(kept_files LABEL unit LINKS supple::core nlohmann_json::nlohmann_json
    SOURCES app/kept_files_test.cpp app/supple_process.cpp)
  target_compile_definitions(test_kept_files PRIVATE SUPPLE_COMMAND="$<TARGET_FILE:supple>")
  add_dependencies(test_kept_files supple)
  if(TARGET supple_view_server)
    supple_test(view_command LABEL unit LINKS supple::core nlohmann_json::nlohmann_json
      SOURCES app/view_command_test.cpp app/supple_process.cpp)
    target_compile_definitions(test_view_command PRIVATE SUPPLE_COMMAND="$<TARGET_FILE:supple>")
    add_dependencies(test_view_command supple)
  endif()
  supple_test(real_shapes LABEL slow LINKS supple::core nlohmann_json::nlohmann_json
    SOURCES app/real_shapes_test.cpp app/supple_process.cpp)
  target_compile_definitions(test_real_shapes PRIVATE SUPPLE_COMMAND="$<TARGET_FILE:supple>"
    SUPPLE_SHARED_MESHES="${PROJECT_SOURCE_DIR}/../shared/meshes")
  add_dependencies(test_real_shapes supple)
endif()

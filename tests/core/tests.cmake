supple_test(core LABEL unit LINKS supple::core nlohmann_json::nlohmann_json
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/output_file_test.cpp ${CMAKE_CURRENT_LIST_DIR}/pack_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/parallel_test.cpp ${CMAKE_CURRENT_LIST_DIR}/random_test.cpp ${CMAKE_CURRENT_LIST_DIR}/recording_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/tensor_file_test.cpp)
target_compile_definitions(test_core PRIVATE SUPPLE_TEST_SCRIPTS="${CMAKE_CURRENT_LIST_DIR}")

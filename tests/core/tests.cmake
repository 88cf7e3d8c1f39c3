supple_test(core QUICK LABEL unit LINKS supple::core nlohmann_json::nlohmann_json
  SOURCES core/checkpoint_test.cpp core/output_file_test.cpp core/pack_test.cpp
          core/parallel_test.cpp core/random_test.cpp core/recording_test.cpp core/registry_test.cpp
          core/stable_norm_test.cpp core/tensor_file_test.cpp)
target_compile_definitions(test_core PRIVATE SUPPLE_TEST_SCRIPTS="${CMAKE_CURRENT_LIST_DIR}")

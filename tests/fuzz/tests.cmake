# Readers of files on bytes that no writer wrote; see fuzz_target.hpp. The tests replay a short part, scripts/fuzz runs the rest.
set(readers fuzz/reader_targets.cpp io/mesh_files.cpp io/surface_files.cpp)
set(models fuzz/model_targets.cpp fuzz/small_models.cpp fuzz/tensor_edits.cpp)
if(TARGET supple_app)
  supple_test(fuzz LABEL unit LINKS supple_app ZLIB::ZLIB
    SOURCES ${readers} ${models} fuzz/claims_test.cpp fuzz/corruption_test.cpp fuzz/replay_test.cpp io/damage.cpp)
  target_compile_definitions(test_fuzz PRIVATE SUPPLE_FUZZ_CORPUS="${CMAKE_CURRENT_LIST_DIR}/corpus")
endif()

# supple_fuzzer(<name> <library> <source>...): its targets are those of <name>_targets().
function(supple_fuzzer name library)
  add_executable(fuzz_${name} ${ARGN} fuzz/fuzzer.cpp)
  target_include_directories(fuzz_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(fuzz_${name} PRIVATE SUPPLE_FUZZ_TARGETS=${name}_targets)
  target_link_libraries(fuzz_${name} PRIVATE ${library} ZLIB::ZLIB)
  target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  supple_build_options(fuzz_${name})
endfunction()
if(SUPPLE_BUILD_FUZZERS AND TARGET supple_app)  # two programs, since whoever runs the first need not wait for all floors to be built
  supple_fuzzer(reader "supple::io;supple::pictures" ${readers})
  supple_fuzzer(model supple_app ${models})
endif()

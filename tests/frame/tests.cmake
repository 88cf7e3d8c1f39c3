add_test(NAME frame.includes_run_downward
  COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -P ${CMAKE_CURRENT_LIST_DIR}/check_includes.cmake)
set_tests_properties(frame.includes_run_downward PROPERTIES LABELS unit)

add_test(NAME frame.tutorials_show_code_that_runs
  COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DDOCS=materials.md,elements.md,selectors.md,subspaces.md,integrators.md,loads.md,plugins.md,viewer.md
          -P ${CMAKE_CURRENT_LIST_DIR}/check_docs.cmake)
set_tests_properties(frame.tutorials_show_code_that_runs PROPERTIES LABELS unit)

find_program(CLANG_FORMAT clang-format-14)
mark_as_advanced(CLANG_FORMAT)
add_test(NAME frame.code_is_formatted
  COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DCLANG_FORMAT=${CLANG_FORMAT}
          -P ${CMAKE_CURRENT_LIST_DIR}/check_format.cmake)
set_tests_properties(frame.code_is_formatted PROPERTIES LABELS unit SKIP_REGULAR_EXPRESSION "skipped: ")

# What is wrong with a model of a user's own, the compiler says in words and first.
add_test(NAME frame.concepts_fail_in_words
  COMMAND ${CMAKE_COMMAND} -DCOMPILER=${CMAKE_CXX_COMPILER} -DINCLUDE=${PROJECT_SOURCE_DIR}
          -DEIGEN=$<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>
          "-DDEFINITIONS=$<TARGET_PROPERTY:supple_core,INTERFACE_COMPILE_DEFINITIONS>"
          -DSOURCES=${CMAKE_CURRENT_LIST_DIR}/wrong -P ${CMAKE_CURRENT_LIST_DIR}/concept_messages.cmake)
set_tests_properties(frame.concepts_fail_in_words PROPERTIES LABELS slow TIMEOUT 1200)

# Projects outside the tree build against the installed package. Sanitized libraries need sanitized consumers, so this is
# for the plain builds.
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  return()
endif()
set(prefix ${PROJECT_BINARY_DIR}/installed)
add_test(NAME frame.package_installs
  COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR} -DPREFIX=${prefix} -P ${CMAKE_CURRENT_LIST_DIR}/install.cmake)
set_tests_properties(frame.package_installs PROPERTIES LABELS slow FIXTURES_SETUP installed_package)

# supple_package_test(<name> SCRIPT <script> SOURCE <folder> [DEFINE NAME=value ...]): a script that uses the package.
function(supple_package_test name)
  cmake_parse_arguments(ARG "" "SCRIPT;SOURCE" "DEFINE" ${ARGN})
  list(TRANSFORM ARG_DEFINE PREPEND -D)
  add_test(NAME frame.${name}
    COMMAND ${CMAKE_COMMAND} -DPREFIX=${prefix} -DSOURCE=${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${ARG_SOURCE}
            -DWORK=${PROJECT_BINARY_DIR}/consumers/${name} -DGENERATOR=${CMAKE_GENERATOR}
            -DCOMPILER=${CMAKE_CXX_COMPILER} ${ARG_DEFINE} -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${ARG_SCRIPT})
  set_tests_properties(frame.${name} PROPERTIES LABELS slow TIMEOUT 1200 FIXTURES_REQUIRED installed_package)
endfunction()

# Consumers may be compiled for other instruction sets than the library.
foreach(march x86-64 native)
  supple_package_test(consumer_compiled_for_${march} SCRIPT run_consumer.cmake SOURCE consumer
    DEFINE FLAGS=-march=${march})
endforeach()
supple_package_test(parts_of_ones_own SCRIPT run_own_parts.cmake SOURCE own_parts
  DEFINE PARTS=${PROJECT_SOURCE_DIR}/examples)

# A component needs the packages named here and none of the others; Eigen and threads are behind all of them.
function(supple_component_test component)
  cmake_parse_arguments(ARG "" "" "NEEDS" ${ARGN})
  set(hidden NLopt CHOLMOD UMFPACK Anasazi MPI ZLIB pugixml PNG GTest nlohmann_json CLI11 Boost)
  if(ARG_NEEDS)
    list(REMOVE_ITEM hidden ${ARG_NEEDS})
  endif()
  list(JOIN hidden "," hidden)
  supple_package_test(component_${component}_alone SCRIPT run_component.cmake SOURCE components
    DEFINE COMPONENT=${component} HIDDEN=${hidden})
endfunction()
supple_component_test(core)
supple_component_test(sparse NEEDS NLopt)
supple_component_test(numerics NEEDS NLopt CHOLMOD UMFPACK)
supple_component_test(eigensolver NEEDS NLopt CHOLMOD UMFPACK Anasazi MPI)
supple_component_test(physics NEEDS NLopt CHOLMOD UMFPACK)
supple_component_test(reduction NEEDS NLopt CHOLMOD UMFPACK Anasazi MPI)
supple_component_test(viewer NEEDS NLopt CHOLMOD UMFPACK Anasazi MPI)
supple_component_test(io NEEDS NLopt CHOLMOD UMFPACK ZLIB pugixml)
supple_component_test(pictures NEEDS NLopt CHOLMOD UMFPACK ZLIB PNG)

supple_package_test(unknown_component_is_refused_by_name SCRIPT refuse_component.cmake SOURCE components
  DEFINE COMPONENT=teapot "EXPECTED=there is no component 'teapot'")
supple_package_test(missing_package_is_named SCRIPT refuse_component.cmake SOURCE components
  DEFINE COMPONENT=io HIDDEN=pugixml EXPECTED=pugixml)

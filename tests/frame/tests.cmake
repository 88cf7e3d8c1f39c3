add_test(NAME frame.includes_run_downward
  COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -P ${CMAKE_CURRENT_LIST_DIR}/check_includes.cmake)
set_tests_properties(frame.includes_run_downward PROPERTIES LABELS unit)

add_test(NAME frame.tutorials_show_code_that_runs
  COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DDOCS=materials.md,elements.md,selectors.md,subspaces.md,integrators.md,loads.md
          -P ${CMAKE_CURRENT_LIST_DIR}/check_docs.cmake)
set_tests_properties(frame.tutorials_show_code_that_runs PROPERTIES LABELS unit)

# What is wrong with a model of a user's own, the compiler says in words and first.
add_test(NAME frame.concepts_fail_in_words
  COMMAND ${CMAKE_COMMAND} -DCOMPILER=${CMAKE_CXX_COMPILER} -DINCLUDE=${PROJECT_SOURCE_DIR}
          -DEIGEN=$<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>
          -DSOURCES=${CMAKE_CURRENT_LIST_DIR}/wrong -P ${CMAKE_CURRENT_LIST_DIR}/concept_messages.cmake)
set_tests_properties(frame.concepts_fail_in_words PROPERTIES LABELS slow TIMEOUT 1200)

# The installed package serves consumers compiled for other instruction sets than its own. Sanitized libraries need
# sanitized consumers, so this is for the plain builds.
if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  foreach(march x86-64 native)
    add_test(NAME frame.consumer_compiled_for_${march}
      COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR} -DSOURCE=${CMAKE_CURRENT_LIST_DIR}/consumer
              -DWORK=${PROJECT_BINARY_DIR}/consumer-${march} -DFLAGS=-march=${march} -DGENERATOR=${CMAKE_GENERATOR}
              -P ${CMAKE_CURRENT_LIST_DIR}/run_consumer.cmake)
    set_tests_properties(frame.consumer_compiled_for_${march} PROPERTIES LABELS slow TIMEOUT 1200)
  endforeach()
  add_test(NAME frame.parts_of_ones_own
    COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR} -DSOURCE=${CMAKE_CURRENT_LIST_DIR}/own_parts
            -DPARTS=${PROJECT_SOURCE_DIR}/examples -DWORK=${PROJECT_BINARY_DIR}/own-parts
            -DGENERATOR=${CMAKE_GENERATOR} -P ${CMAKE_CURRENT_LIST_DIR}/run_own_parts.cmake)
  set_tests_properties(frame.parts_of_ones_own PROPERTIES LABELS slow TIMEOUT 1200)
endif()

# The page of `supple view`: its parts by themselves, then the whole in a browser. Both skip, with the reason, where the page
# was not built or a tool is missing.
if(NOT TARGET supple_view_server)
  return()
endif()
find_program(NODE node)
find_program(CHROMIUM NAMES chromium chromium-browser google-chrome)
mark_as_advanced(NODE CHROMIUM)
function(supple_page_test name)
  add_test(NAME page.${name}
    COMMAND ${CMAKE_COMMAND} -DWHAT=${name} -DROOT=${PROJECT_SOURCE_DIR} -DBUILD=${PROJECT_BINARY_DIR} -DNPM=${NPM}
            -DNODE=${NODE} -DCHROMIUM=${CHROMIUM} -DSUPPLE=$<TARGET_FILE:supple> -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/run.cmake)
  set_tests_properties(page.${name} PROPERTIES SKIP_REGULAR_EXPRESSION "skipped: " TIMEOUT 600 ${ARGN})
endfunction()
supple_page_test(parts LABELS unit)
supple_page_test(in_a_browser LABELS slow RUN_SERIAL ON)

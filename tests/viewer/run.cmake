# Tests the page. Arguments: WHAT (parts, in_a_browser), ROOT, BUILD (the build tree), SUPPLE (the program), and the programs
# NPM, NODE and CHROMIUM, which may be missing.
cmake_minimum_required(VERSION 3.25)
set(page ${BUILD}/viewer/page)
set(work ${BUILD}/tests/page/${WHAT})

function(skip reason)
  message("skipped: ${reason}")
endfunction()
# run(COMMAND …): ends the test if it fails.
function(run)
  execute_process(${ARGN} WORKING_DIRECTORY ${work} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

if(NOT NODE OR NOT NPM)
  skip("node and npm are not installed")
  return()
elseif(NOT EXISTS ${page}/page.built)
  skip("the page was not built")
  return()
endif()
file(REMOVE_RECURSE ${work})

if(WHAT STREQUAL "parts")
  file(COPY ${ROOT}/viewer/page/ DESTINATION ${work} PATTERN node_modules EXCLUDE PATTERN dist EXCLUDE)
  file(CREATE_LINK ${page}/source/node_modules ${work}/node_modules SYMBOLIC)
  run(COMMAND ${NPM} test)
  return()
endif()

if(NOT CHROMIUM)
  skip("Chromium is not installed")
  return()
endif()
file(COPY ${ROOT}/tests/viewer/ DESTINATION ${work} PATTERN node_modules EXCLUDE)
execute_process(COMMAND ${NPM} ci --prefer-offline --no-audit --no-fund --fetch-retries=1 --fetch-timeout=20000
  WORKING_DIRECTORY ${work} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT code EQUAL 0)
  skip("npm could not fetch what drives the browser:\n${output}")
  return()
endif()
run(COMMAND ${SUPPLE} reduce bar:16x4x4 --fix x<=0 --modes 9 --poses 40 --points 60 -o bar.supple)
set(test ${CMAKE_COMMAND} -E env SUPPLE_COMMAND=${SUPPLE} SUPPLE_MODEL=bar.supple CHROMIUM=${CHROMIUM} ${NPM} test)
execute_process(COMMAND ${test} WORKING_DIRECTORY ${work} RESULT_VARIABLE code)
if(NOT code EQUAL 0)  # on a busy machine a browser may be late once
  message("trying once more")
  run(COMMAND ${test})
endif()

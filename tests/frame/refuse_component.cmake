# Configures a consumer that cannot have what it asks for, and fails unless it is told why.
# Arguments: PREFIX, SOURCE, WORK, GENERATOR, COMPILER, COMPONENT, HIDDEN (a package, may be empty), EXPECTED (words).
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})
if(HIDDEN)
  set(hide -DCMAKE_DISABLE_FIND_PACKAGE_${HIDDEN}=ON)
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK} -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${PREFIX}
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCOMPONENT=${COMPONENT} ${hide}
  RESULT_VARIABLE code OUTPUT_QUIET ERROR_VARIABLE messages)
string(REGEX REPLACE "[ \n]+" " " messages "${messages}")
string(FIND "${messages}" "${EXPECTED}" place)
if(code EQUAL 0)
  message(FATAL_ERROR "find_package(supple COMPONENTS ${COMPONENT}) succeeds, expected \"${EXPECTED}\"")
elseif(place EQUAL -1)
  message(FATAL_ERROR "expected \"${EXPECTED}\", found \"${messages}\"")
endif()

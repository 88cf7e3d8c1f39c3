# Builds and runs a consumer of one component where the packages of other components are hidden, and fails if one of them
# appears in what the compiler reads or the linker is given. Arguments: PREFIX, SOURCE, WORK, GENERATOR, COMPILER,
# COMPONENT, HIDDEN (names as in find_package, separated by commas).
cmake_minimum_required(VERSION 3.25)
string(REPLACE "," ";" HIDDEN "${HIDDEN}")

# What the headers and libraries of a package have in their paths.
set(traces_of_NLopt "nlopt")
set(traces_of_CHOLMOD "cholmod|suitesparse|liblapack|lib(open)?blas")
set(traces_of_UMFPACK "umfpack")
set(traces_of_Anasazi "anasazi|trilinos|teuchos")
set(traces_of_MPI "openmpi|libmpi|mpi\\.h")
set(traces_of_ZLIB "libz\\.|zlib\\.h")
set(traces_of_pugixml "pugixml")
set(traces_of_PNG "libpng|png\\.h")
set(traces_of_GTest "gtest|gmock")
set(traces_of_nlohmann_json "nlohmann|json\\.hpp")
set(traces_of_CLI11 "/cli/")
set(traces_of_Boost "boost")

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
set(flags -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O1")
foreach(package IN LISTS HIDDEN)
  list(APPEND flags -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK} -G ${GENERATOR} -DCOMPONENT=${COMPONENT} ${flags}
    --no-warn-unused-cli
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK} --verbose
  OUTPUT_VARIABLE log ERROR_VARIABLE log RESULT_VARIABLE code)
string(REPLACE "${WORK}" "" log "${log}")
string(REPLACE "${PREFIX}" "" log "${log}")
string(REPLACE "${SOURCE}" "" log "${log}")
if(NOT code EQUAL 0)
  message(FATAL_ERROR "the consumer of ${COMPONENT} does not build:\n${log}")
endif()
foreach(expected "Eigen/Core" "libsupple_core")  # so that an empty list of headers or libraries is no success
  if(NOT log MATCHES "${expected}")
    message(FATAL_ERROR "${expected} is not in the list of headers and libraries:\n${log}")
  endif()
endforeach()
string(TOLOWER "${log}" log)
foreach(package IN LISTS HIDDEN)
  if(NOT traces_of_${package})  # an empty expression matches anything
    message(FATAL_ERROR "nobody has said what traces ${package} leaves")
  endif()
  if(log MATCHES "[^ \n]*(${traces_of_${package}})[^ \n]*")
    message(SEND_ERROR "a consumer of ${COMPONENT} meets ${package}: ${CMAKE_MATCH_0}")
  endif()
endforeach()
execute_process(COMMAND ${WORK}/consumer WORKING_DIRECTORY ${WORK} COMMAND_ERROR_IS_FATAL ANY)

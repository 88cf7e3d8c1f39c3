# One library per floor, its headers included as <folder/header.hpp> in the tree and after installation.

# supple_library(<floor> HEADERS ... [SOURCES ...] [LINKS ...] [PRIVATE_LINKS ...] [FINDS ...])
# FINDS are the packages that whoever links the installed library has to find, each a line of find_dependency.
function(supple_library name)
  cmake_parse_arguments(ARG "" "" "HEADERS;SOURCES;LINKS;PRIVATE_LINKS;FINDS" ${ARGN})
  set(target supple_${name})
  if(ARG_SOURCES)
    add_library(${target} STATIC ${ARG_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE ${ARG_PRIVATE_LINKS})
    supple_build_options(${target})
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(supple::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} ${scope} cxx_std_20)
  target_link_libraries(${target} ${scope} ${ARG_LINKS})
  target_sources(${target} ${scope} FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
  install(TARGETS ${target} EXPORT supple-${name}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/supple)
  # what suppleConfig.cmake has to know: the floors below, and the packages behind this one
  set(floors ${ARG_LINKS})
  list(FILTER floors INCLUDE REGEX "^supple::")
  list(TRANSFORM floors REPLACE "^supple::" "")
  list(JOIN ARG_FINDS "|" finds)
  set_property(GLOBAL APPEND PROPERTY supple_floors ${name})
  set_property(GLOBAL APPEND_STRING PROPERTY supple_floors_text
    "set(supple_${name}_stands_on ${floors})\nset(supple_${name}_finds \"${finds}\")\n")
endfunction()

# Headers alone, used when compiling a target and unknown to whoever links it.
function(supple_private_headers target package)
  target_include_directories(${target} SYSTEM PRIVATE $<TARGET_PROPERTY:${package},INTERFACE_INCLUDE_DIRECTORIES>)
endfunction()

# Options of code that is built here and never imposed on a consumer: instruction set and warnings.
function(supple_build_options target)
  if(SUPPLE_MARCH)
    target_compile_options(${target} PRIVATE -march=${SUPPLE_MARCH})
  endif()
  target_compile_options(${target} PRIVATE -fno-math-errno)
  if(PROJECT_IS_TOP_LEVEL)
    supple_warnings(${target})
  endif()
endfunction()

# GCC 12 is wrong in two places that no pragma of ours can reach: -Wrestrict about the C++ library's strings
# (https://gcc.gnu.org/bugzilla/show_bug.cgi?id=105651), and -Wmaybe-uninitialized about the vectors in structs of options
# that a caller begins as {.name = ...}; libraries, which begin none, keep that warning. In a batch of sources no source is the
# main file, and every one with an unnamed namespace would earn -Wsubobject-linkage.
function(supple_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow
    $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi -Wno-restrict $<$<BOOL:${CMAKE_UNITY_BUILD}>:-Wno-subobject-linkage>>)
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL STATIC_LIBRARY)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  endif()
endfunction()

# One export file a floor, so that a consumer finds what its floor needs and nothing else.
function(supple_install)
  include(CMakePackageConfigHelpers)
  set(destination ${CMAKE_INSTALL_LIBDIR}/cmake/supple)
  get_property(SUPPLE_FLOORS GLOBAL PROPERTY supple_floors)
  get_property(SUPPLE_FLOORS_TEXT GLOBAL PROPERTY supple_floors_text)
  foreach(floor IN LISTS SUPPLE_FLOORS)
    install(EXPORT supple-${floor} NAMESPACE supple:: DESTINATION ${destination})
  endforeach()
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/suppleConfig.cmake.in
    ${PROJECT_BINARY_DIR}/suppleConfig.cmake INSTALL_DESTINATION ${destination})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/suppleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/suppleConfig.cmake ${PROJECT_BINARY_DIR}/suppleConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindCHOLMOD.cmake ${PROJECT_SOURCE_DIR}/cmake/FindUMFPACK.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindAnasazi.cmake
    ${PROJECT_SOURCE_DIR}/cmake/SupplePlugin.cmake
    DESTINATION ${destination})
endfunction()

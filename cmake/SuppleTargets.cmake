# One library per folder, its headers included as <folder/header.hpp> in the tree and after installation.

# supple_library(<folder> HEADERS ... [SOURCES ...] [LINKS ...] [PRIVATE_LINKS ...])
function(supple_library name)
  cmake_parse_arguments(ARG "" "" "HEADERS;SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
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
  install(TARGETS ${target} EXPORT suppleTargets
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/supple)
endfunction()

# Options of code that is built here and never imposed on a consumer: instruction set and warnings.
function(supple_build_options target)
  if(SUPPLE_MARCH)
    target_compile_options(${target} PRIVATE -march=${SUPPLE_MARCH})
  endif()
  target_compile_options(${target} PRIVATE -fno-math-errno)
endfunction()

function(supple_install)
  include(CMakePackageConfigHelpers)
  set(destination ${CMAKE_INSTALL_LIBDIR}/cmake/supple)
  install(EXPORT suppleTargets NAMESPACE supple:: DESTINATION ${destination})
  configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/suppleConfig.cmake.in
    ${PROJECT_BINARY_DIR}/suppleConfig.cmake INSTALL_DESTINATION ${destination})
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/suppleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/suppleConfig.cmake ${PROJECT_BINARY_DIR}/suppleConfigVersion.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindCHOLMOD.cmake ${PROJECT_SOURCE_DIR}/cmake/FindUMFPACK.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindAnasazi.cmake
    ${PROJECT_SOURCE_DIR}/cmake/SupplePlugin.cmake
    DESTINATION ${destination})
endfunction()

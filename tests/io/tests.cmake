supple_test(io_output LABEL unit LINKS supple::io
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/colour_test.cpp ${CMAKE_CURRENT_LIST_DIR}/csv_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/image_test.cpp ${CMAKE_CURRENT_LIST_DIR}/json_fields_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/picture_test.cpp ${CMAKE_CURRENT_LIST_DIR}/plot_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/unit_test.cpp ${CMAKE_CURRENT_LIST_DIR}/vtu_writer_test.cpp)

supple_test(io_meshes LABEL unit LINKS supple::io ZLIB::ZLIB
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/mesh_awkward_test.cpp ${CMAKE_CURRENT_LIST_DIR}/mesh_builtin_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/mesh_files.cpp ${CMAKE_CURRENT_LIST_DIR}/mesh_node_sets_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/mesh_reader_test.cpp ${CMAKE_CURRENT_LIST_DIR}/solid_mesh_reader_test.cpp)
supple_test(io_surfaces LABEL unit LINKS supple::io ZLIB::ZLIB
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/mesh_files.cpp ${CMAKE_CURRENT_LIST_DIR}/surface_awkward_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/surface_builtin_test.cpp ${CMAKE_CURRENT_LIST_DIR}/surface_files.cpp
          ${CMAKE_CURRENT_LIST_DIR}/surface_reader_test.cpp)
# Real models and awkward inputs that are no part of the project: tests skip where they are absent.
foreach(test test_io_meshes test_io_surfaces)
  target_compile_definitions(${test} PRIVATE SUPPLE_SHARED_MESHES="${PROJECT_SOURCE_DIR}/../shared/meshes")
endforeach()
supple_test(io_mesh_fuzz LABEL unit LINKS supple::io ZLIB::ZLIB
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/damage.cpp ${CMAKE_CURRENT_LIST_DIR}/mesh_files.cpp
          ${CMAKE_CURRENT_LIST_DIR}/mesh_fuzz_test.cpp ${CMAKE_CURRENT_LIST_DIR}/surface_files.cpp
          ${CMAKE_CURRENT_LIST_DIR}/surface_fuzz_test.cpp)
supple_test(io_matrices LABEL unit LINKS supple::io SOURCES ${CMAKE_CURRENT_LIST_DIR}/matrix_file_test.cpp)

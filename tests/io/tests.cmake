supple_test(io LABEL unit LINKS supple::io supple::pictures ZLIB::ZLIB
  SOURCES io/mesh_files.cpp io/builtin/mesh_builtin_test.cpp io/frames/vtu_writer_test.cpp io/mesh/mesh_abaqus_test.cpp
          io/mesh/mesh_awkward_test.cpp
          io/mesh/mesh_groups_test.cpp io/mesh/mesh_node_sets_test.cpp io/mesh/mesh_reader_test.cpp io/mesh/solid_mesh_reader_test.cpp
          io/picture/colour_test.cpp io/picture/image_test.cpp io/picture/picture_test.cpp io/picture/plot_test.cpp
          io/table/csv_test.cpp io/table/matrix_file_test.cpp io/text/json_fields_test.cpp io/text/unit_test.cpp)
supple_test(io_surfaces OPTIMIZED LABEL unit LINKS supple::io ZLIB::ZLIB
  SOURCES io/mesh_files.cpp io/surface_files.cpp io/builtin/surface_builtin_test.cpp io/surface/surface_awkward_test.cpp
          io/surface/surface_reader_test.cpp)
# Real models and awkward inputs that are no part of the project: tests skip where they are absent.
foreach(test test_io test_io_surfaces)
  target_compile_definitions(${test} PRIVATE SUPPLE_SHARED_MESHES="${PROJECT_SOURCE_DIR}/../shared/meshes")
endforeach()

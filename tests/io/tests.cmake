supple_test(io_output LABEL unit LINKS supple::io
  SOURCES ${CMAKE_CURRENT_LIST_DIR}/csv_test.cpp ${CMAKE_CURRENT_LIST_DIR}/json_fields_test.cpp
          ${CMAKE_CURRENT_LIST_DIR}/plot_test.cpp ${CMAKE_CURRENT_LIST_DIR}/unit_test.cpp ${CMAKE_CURRENT_LIST_DIR}/vtu_writer_test.cpp)

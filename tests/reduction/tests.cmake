supple_test(anasazi_adapter LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/anasazi_adapter_test.cpp
  LINKS supple::reduction Anasazi::Anasazi)
supple_test(eigensolver LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/eigensolver_test.cpp LINKS supple::reduction)

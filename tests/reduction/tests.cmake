supple_test(anasazi_adapter LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/anasazi_adapter_test.cpp
  LINKS supple::reduction Anasazi::Anasazi)
supple_test(eigensolver LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/eigensolver_test.cpp LINKS supple::reduction)
supple_test(subspace LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/subspace_test.cpp LINKS supple::reduction)
supple_test(force_fitting LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/force_fitting_test.cpp LINKS supple::reduction)
supple_test(reduced_system LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/reduced_system_test.cpp LINKS supple::reduction)
supple_test(reduce LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/reduce_test.cpp LINKS supple::reduction)
supple_test(editor LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/editor_test.cpp LINKS supple::reduction)
supple_test(selection_study LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/selection_study_test.cpp LINKS supple::reduction)

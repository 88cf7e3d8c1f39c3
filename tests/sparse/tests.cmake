supple_test(fitting_problem LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/fitting_problem_test.cpp LINKS supple::sparse)
supple_test(nnls LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/nnls_test.cpp LINKS supple::sparse)
supple_test(nn_htp LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/nn_htp_test.cpp LINKS supple::sparse)

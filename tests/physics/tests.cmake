supple_test(cholmod_solver LABEL unit SOURCES ${CMAKE_CURRENT_LIST_DIR}/cholmod_solver_test.cpp LINKS supple::physics)

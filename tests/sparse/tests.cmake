supple_test(sparse QUICK LABEL unit LINKS supple::sparse
  SOURCES sparse/nnls/pruning_test.cpp sparse/problem/fitting_problem_test.cpp sparse/problem/stacked_problem_test.cpp
          sparse/selectors/exchanging_test.cpp sparse/selectors/nn_htp_test.cpp)
supple_test(nnls LABEL unit LINKS supple::sparse SOURCES sparse/nnls/nnls_adversarial_test.cpp sparse/nnls/nnls_test.cpp)
supple_test(selectors OPTIMIZED LABEL unit LINKS supple::sparse SOURCES sparse/selectors/selectors_test.cpp)

supple_test(cholmod_solver LABEL unit LINKS supple::physics SOURCES numerics/linear/cholmod_solver_test.cpp)
supple_test(lu_solver LABEL unit LINKS supple::physics SOURCES numerics/linear/lu_solver_test.cpp)
supple_test(newton LABEL unit LINKS supple::physics SOURCES numerics/optimize/newton_test.cpp)
supple_test(anasazi_adapter LABEL unit LINKS supple::eigensolver Anasazi::Anasazi
  SOURCES numerics/eigen/anasazi_adapter_test.cpp)
supple_test(eigensolver LABEL unit LINKS supple::reduction SOURCES numerics/eigen/eigensolver_test.cpp)

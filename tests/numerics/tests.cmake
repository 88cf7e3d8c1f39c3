supple_test(numerics LABEL unit LINKS supple::physics
  SOURCES numerics/linear/cholmod_solver_test.cpp numerics/linear/lu_solver_test.cpp
          numerics/linear/symmetric_eigen_test.cpp numerics/optimize/newton_test.cpp)
supple_test(anasazi_adapter LABEL unit LINKS supple::eigensolver Anasazi::Anasazi
  SOURCES numerics/eigen/anasazi_adapter_test.cpp)
supple_test(eigensolver LABEL unit LINKS supple::reduction SOURCES numerics/eigen/eigensolver_test.cpp)

// A sparse matrix, factorised.
#include <numerics/linear/cholmod_solver.hpp>

using namespace supple;

int main() {
  SparseMatrix A(3, 3);
  A.setIdentity();
  A *= 2;
  CholmodSolver cholesky;
  cholesky.analyze(A);
  return cholesky.factorize(A) && cholesky.solve(Vector::Ones(3)).isApproxToConstant(0.5) ? 0 : 1;
}

// The lowest eigenvalue of a diagonal matrix.
#include <numerics/eigen/eigensolver.hpp>

using namespace supple;

int main() {
  SparseMatrix K(5, 5);
  for (int i = 0; i < 5; ++i) K.insert(i, i) = i + 1;
  const EigenPairs pairs = smallest_eigenpairs(K, Vector::Ones(5), Matrix(5, 0), {.num_modes = 1});
  return pairs.omega_squared.isApproxToConstant(1) ? 0 : 1;
}

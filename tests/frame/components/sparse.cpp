// A matrix, a vector and a selector.
#include <sparse/selectors/nn_htp.hpp>

using namespace supple;

int main() {
  Random random(1);
  Matrix A = Matrix::NullaryExpr(40, 60, [&] { return random.normal(); });
  Vector b = A.col(3) + 2 * A.col(14);
  const Selection few = NnHtp{}(DenseProblem(A, b), 2);
  return few.indices == std::vector<Index>{3, 14} && few.report.training_error < 1e-10 ? 0 : 1;
}

// I have a matrix and a vector, and want few columns: min ‖A w − b‖, w ≥ 0, at most s weights. No mesh
// involved. From files: A = read_matrix("A.npy"), b = read_vector("b.npy") of <io/table/matrix_file.hpp>, or the
// command 'supple select'.
//
// Sample run:
//   40 of 500 columns, error 2.7e-01 (random: 6.3e-01)
//   with columns 3 and 7 kept: 40, error 2.7e-01
//   error of at most 0.2: 52 columns

#include <sparse/selectors/baselines.hpp>
#include <sparse/selectors/nn_sp.hpp>

#include <cstdio>

int main() {
  supple::Random random(1);
  supple::Matrix A = supple::Matrix::NullaryExpr(200, 500, [&] { return random.uniform(); });
  A.rowwise() -= A.colwise().mean() * 0.9;
  supple::Vector b = A.rowwise().sum();

  const supple::DenseProblem problem(A, b);
  const supple::Selection few = supple::NnSp{}(problem, 40);  // indices, weights > 0, report
  const supple::Selection any = supple::UniformRandom{}(problem, 40);
  std::printf("%ld of %ld columns, error %.1e (random: %.1e)\n", static_cast<long>(few.size()),
              static_cast<long>(problem.cols()), few.report.training_error, any.report.training_error);

  supple::SelectionRequest request(40);
  request.must_keep = {3, 7};
  request.warm_start = few;  // an earlier answer to improve
  const supple::Selection kept = supple::NnSp{}(problem, request);
  std::printf("with columns 3 and 7 kept: %ld, error %.1e\n", static_cast<long>(kept.size()),
              kept.report.training_error);

  const supple::Selection enough = supple::NnSp{}(problem, supple::SelectionRequest::to_error(0.2));
  std::printf("error of at most 0.2: %ld columns\n", static_cast<long>(enough.size()));
  return few.report.training_error < any.report.training_error ? 0 : 1;
}

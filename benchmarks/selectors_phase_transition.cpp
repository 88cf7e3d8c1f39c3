// How many weights can a selector recover? For planted signals w with s entries and A of independent normal
// numbers, counts the trials in which the selector finds w from b = A w. Prints CSV, one row for each
// selector, kind of signal and sparsity. Arguments: rows of A (100), columns (200), trials (100).
//
// The transition from always to never is the classical yardstick of compressed sensing: Blumensath & Davies
// 2010 (NIHT), Foucart 2011 (HTP), Donoho & Tanner 2010 (non-negative signals).

#include <core/parallel.hpp>
#include <sparse/selectors/selectors.hpp>

#include <cstdio>
#include <cstdlib>

using namespace supple;

namespace {

struct Signal {
  DenseProblem problem;
  Vector w;
};

// Columns of unit length in the mean; entries of w normal, or their absolute value.
Signal plant(Index rows, Index cols, Index s, Signs signs, std::uint64_t seed) {
  Random random(seed);
  const double scale = 1 / std::sqrt(static_cast<double>(rows));
  Matrix A = Matrix::NullaryExpr(rows, cols, [&] { return scale * random.normal(); });
  Vector w = Vector::Zero(cols);
  for (Index j : random.sample(all_positions(cols), s)) {
    const double value = random.normal();
    w[j] = signs == Signs::Any ? value : std::abs(value);
  }
  Vector b = A * w;
  return {DenseProblem(std::move(A), std::move(b)), std::move(w)};
}

bool recovers(std::string_view name, const Signal& signal, Index s, std::uint64_t seed) {
  constexpr double all = std::numeric_limits<double>::infinity();
  const SelectionRequest request(s);
  // The lazy methods see all columns in each iteration here, and have time.
  const Selection c =
      name == "nn-sp" ? NnSp{.max_iterations = 200, .candidates_per_size = all, .seed = seed}(signal.problem, request)
      : name == "nn-htp"
          ? NnHtp{.max_iterations = 200, .candidates_per_size = all, .seed = seed}(signal.problem, request)
          : select_by_name(name, signal.problem, request, seed);
  Vector w = Vector::Zero(signal.w.size());
  w(c.indices) = c.weights;
  return (w - signal.w).norm() <= 1e-4 * signal.w.norm();
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int k, Index otherwise) { return argc > k ? std::atol(argv[k]) : otherwise; };
  const Index rows = argument(1, 100), cols = argument(2, 200), trials = argument(3, 100),
              step = std::max<Index>(1, rows / 20);
  std::printf("selector,signal,rows,columns,s,trials,recovered\n");
  for (Signs signs : {Signs::NonNegative, Signs::Any})
    for (std::string_view name : {"nn-sp", "nn-htp", "nn-omp", "ecsw", "nn-niht", "htp", "niht"}) {
      if (signs == Signs::Any && name != "htp" && name != "niht") continue;
      for (Index s = step; s <= 3 * rows / 4; s += step) {
        std::vector<char> recovered(trials);
        parallel_for(trials, [&](Index trial) {
          recovered[trial] = recovers(name, plant(rows, cols, s, signs, 1000 * s + trial), s, trial);
        });
        const auto count = std::count(recovered.begin(), recovered.end(), 1);
        std::printf("%s,%s,%ld,%ld,%ld,%ld,%ld\n", std::string(name).c_str(),
                    signs == Signs::Any ? "signed" : "non-negative", static_cast<long>(rows), static_cast<long>(cols),
                    static_cast<long>(s), static_cast<long>(trials), static_cast<long>(count));
        std::fflush(stdout);
        if (count == 0) break;
      }
    }
}

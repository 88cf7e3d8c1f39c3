// Every selector on one force fitting of 4500 rows and 12 000 columns: a St. Venant–Kirchhoff cube in a
// smooth basis of d = 45, T = 100 random poses, and 50 more that none of them sees. Prints CSV, medians over
// seeds. Arguments: s, as many as wanted (50 100 200); one thread, so that times compare.

#include <core/median.hpp>
#include <core/parallel.hpp>
#include <sparse/selectors/selectors.hpp>
#include <tests/sparse/problems.hpp>

#include <cstdio>
#include <cstdlib>

using namespace supple;

int main(int argc, char** argv) {
  set_num_threads(1);
  std::vector<Index> sizes;
  for (int k = 1; k < argc; ++k) sizes.push_back(std::atol(argv[k]));
  if (sizes.empty()) sizes = {50, 100, 200};

  const Index d = 45, T = 100, held_out = 50, m = 12000;
  const DenseProblem all = test::force_fitting_on_a_cube(d / 3, T + held_out, m, 1);
  const DenseProblem training(all.matrix().topRows(d * T), all.rhs().head(d * T), d);
  const Matrix A_held_out = all.matrix().bottomRows(d * held_out);
  const Vector b_held_out = all.rhs().tail(d * held_out);

  std::printf("selector,s,size,training_error,held_out_error,seconds,columns_evaluated\n");
  const auto report = [&](const std::string& name, Index s, const auto& select_with_seed) {
    std::vector<double> size, error, held_out_error, seconds, evaluated;
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      const Selection c = select_with_seed(seed);
      const Vector r = b_held_out - A_held_out(Eigen::all, c.indices) * c.weights;
      size.push_back(static_cast<double>(c.size()));
      error.push_back(c.report.training_error);
      held_out_error.push_back(r.norm() / b_held_out.norm());
      seconds.push_back(c.report.seconds);
      evaluated.push_back(static_cast<double>(c.report.columns_evaluated));
    }
    std::printf("%s,%ld,%.0f,%.3e,%.3e,%.3f,%.0f\n", name.c_str(), static_cast<long>(s), median(size), median(error),
                median(held_out_error), median(seconds), median(evaluated));
    std::fflush(stdout);
  };
  for (Index s : sizes) {
    for (std::string_view name : selector_names)
      if (name != "all")
        report(std::string(name), s, [&](std::uint64_t seed) { return select_by_name(name, training, s, seed); });
    report("nn-sp 10 iterations", s,
           [&](std::uint64_t seed) { return NnSp{.max_iterations = 10, .seed = seed}(training, s); });
    report("greedy T_s 10", s,
           [&](std::uint64_t seed) { return GreedyCubature{.subset_groups = 10, .seed = seed}(training, s); });
    report("nn-omp 1.3", s, [&](std::uint64_t seed) { return NnOmp{.overshoot = 1.3, .seed = seed}(training, s); });
    report("sketched nn-sp", s, [&](std::uint64_t seed) {
      return Sketched<NnSp>{{.seed = seed}, 0, seed}(training, s);
    });
    report("sketched nn-omp", s, [&](std::uint64_t seed) { return Sketched<NnOmp>{{}, 0, seed}(training, s); });
  }
}

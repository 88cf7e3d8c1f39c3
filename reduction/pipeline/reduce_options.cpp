#include <core/check.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/reduce_options.hpp>
#include <sparse/selectors/selector_library.hpp>

namespace supple {

ReduceOptions ReduceOptions::paper() {
  ReduceOptions options;
  options.poses.count = 1000;
  options.poses.omega_exponent = 1;
  options.poses.amplitudes = {0.07};
  options.norm = ForceNorm::Mass;
  options.selector = "nn-htp";
  options.equilibria = 0;
  return options;
}

void check(const ReduceOptions& options) {
  require(options.points >= 1, "number of points is " + std::to_string(options.points) + ", expected at least 1");
  require(options.target_error >= 0, "target error is negative or not a number, expected 0 or more");
  require(options.equilibria.value_or(0) >= 0, "number of equilibria is negative, expected 0 or more");
  require(options.held_out_poses >= 0, "number of held-out poses is negative, expected 0 or more");
  check(options.subspace_choice());
  (void)AnySelector(options.selector);
}

}  // namespace supple

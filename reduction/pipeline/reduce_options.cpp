#include <core/check.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/reduce_options.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <algorithm>
#include <cmath>
#include <string>

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

ReduceOptions ReduceOptions::relaxed_derivatives(Index modes) {
  ReduceOptions options;
  options.subspace = "derivatives:num_derivatives=" + std::to_string(std::max<Index>(1, 7 * modes / 2));
  options.modes = modes;
  options.points = 0;
  options.relaxed = true;
  options.selector = "nn-sp:max_iterations=24";  // more lower the training error, not the one against the full object
  options.poses.count = 100;
  options.poses.amplitudes = {0.002};
  options.equilibria = 32;
  options.equilibrium_weight = 3;
  options.held_out_poses = 50;
  options.full_loads = 8;
  return options;
}

ReduceOptions ReduceOptions::relaxed_extended(Index modes) {
  ReduceOptions options = relaxed_derivatives();
  options.subspace = "extended";
  options.modes = modes;
  options.points = 250;
  return options;
}

void check(const ReduceOptions& options) {
  require(options.points >= 0, "number of points is " + std::to_string(options.points) +
                                   ", expected at least 1, or 0 for a multiple of the dimension");
  require(options.target_error >= 0, "target error is negative or not a number, expected 0 or more");
  require(options.equilibria.value_or(0) >= 0, "number of equilibria is negative, expected 0 or more");
  require(options.equilibrium_weight > 0,
          "weight of equilibria is " + std::to_string(options.equilibrium_weight) + ", expected > 0");
  for (const double a : options.equilibrium_amplitudes)
    require(std::isfinite(a) && a > 0, "amplitude of the equilibria is " + std::to_string(a) + ", expected > 0");
  require(options.full_loads >= 0, "number of loads on the full object is negative, expected 0 or more");
  require(!options.relaxed || options.equilibria != 0, "forces can relax at equilibria only, of which there are none");
  require(options.held_out_poses >= 0, "number of held-out poses is negative, expected 0 or more");
  check(options.subspace_choice());
  (void)AnySelector(options.selector);
}

}  // namespace supple

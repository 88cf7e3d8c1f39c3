#include <reduction/training/training_poses.hpp>

namespace supple {

PoseSampler::PoseSampler(const ReducedModes& modes, double omega_exponent, double total_mass) : Phi_(modes.Phi) {
  require(std::isfinite(omega_exponent), "omega exponent is not finite");
  deviations_ = modes.positive_omega().array().pow(-omega_exponent);
  deviations_.head(modes.num_zero).setZero();
  deviations_ *= std::sqrt(total_mass) / deviations_.norm();
  require(deviations_.allFinite(), "omega exponent is " + std::to_string(omega_exponent) +
                                       ", with which deviations of poses are no numbers; the paper's is 1");
}

Vector PoseSampler::draw(Random& random) const {
  Vector coordinates(deviations_.size());
  for (Index k = 0; k < coordinates.size(); ++k) coordinates[k] = deviations_[k] * random.normal();
  return Phi_ * coordinates;
}

}  // namespace supple

#include <reduction/training_poses.hpp>

namespace supple {

PoseSampler::PoseSampler(const ReducedModes& modes, double omega_exponent, double total_mass) : Phi_(modes.Phi) {
  deviations_ = modes.positive_omega().array().pow(-omega_exponent);
  deviations_.head(modes.num_zero).setZero();
  deviations_ *= std::sqrt(total_mass) / deviations_.norm();
}

Vector PoseSampler::draw(Random& random) const {
  Vector coordinates(deviations_.size());
  for (Index k = 0; k < coordinates.size(); ++k) coordinates[k] = deviations_[k] * random.normal();
  return Phi_ * coordinates;
}

}  // namespace supple

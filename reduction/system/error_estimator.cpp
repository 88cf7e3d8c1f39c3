#include <reduction/system/error_estimator.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {

ErrorEstimator::ErrorEstimator(Forces second, const ErrorIndicator& indicator, const ReducedModes& modes)
    : second_(std::move(second)),
      rigid_(modes.Phi.leftCols(modes.num_zero)),
      outside_stiffness_(indicator.outside_stiffness),
      scale_(indicator.scale),
      trained_size_(indicator.trained_size) {
  require_size("indicator.rows.cols()", indicator.rows.cols(), modes.Phi.rows() + indicator.num_outside());
  constexpr Index softest = 40;  // as many as forces are fitted by, see EquilibriumFitting
  modes_ = modes.Phi.middleCols(modes.num_zero, std::min(softest, modes.Phi.cols() - modes.num_zero));
  stiffness_ = modes.omega.segment(modes.num_zero, modes_.cols()).cwiseAbs2();
}

ErrorEstimate ErrorEstimator::operator()(VectorIn q, VectorIn force) const {
  require_size("q", q.size(), modes_.rows());
  require_size("force", force.size(), q.size());
  Vector state = Vector::Zero(q.size() + outside_stiffness_.size());
  state.head(q.size()) = q;
  const Vector second = second_(state);
  ErrorEstimate estimate;
  estimate.lacking = scale_ * (modes_.transpose() * (force - second.head(q.size())));
  estimate.fit = estimate.lacking.cwiseQuotient(stiffness_).norm();
  estimate.outside = scale_ * second.tail(outside_stiffness_.size()).cwiseQuotient(outside_stiffness_).norm();
  const double size = std::sqrt(std::max(0.0, q.squaredNorm() - (rigid_.transpose() * q).squaredNorm()));
  estimate.beyond_training = size > trained_size_;
  return estimate;
}

MotionErrorEstimator::MotionErrorEstimator(ErrorEstimator states, const RayleighDamping& damping)
    : states_(std::move(states)),
      damping_(damping),
      lacking_(Vector::Zero(states_.stiffness().size())),
      displacement_(lacking_),
      velocity_(lacking_) {}

void MotionErrorEstimator::start_from(VectorIn q, VectorIn force) {
  require(time_ == 0, "the motion has begun");
  lacking_ = states_(q, force).lacking;
  displacement_ = lacking_.cwiseQuotient(states_.stiffness());
}

ErrorEstimate MotionErrorEstimator::advance(double time, VectorIn q, VectorIn force) {
  require(time > time_, "times of a motion do not ascend");
  ErrorEstimate estimate = states_(q, force);
  constexpr int parts = 4;  // in which the force is linear; the average acceleration of Newmark's method in each
  const double since = time - time_, h = since / parts;
  for (Index k = 0; k < lacking_.size(); ++k) {
    const double stiffness = states_.stiffness()[k], damping = damping_.alpha + damping_.beta * stiffness;
    const double now = estimate.lacking[k];
    double &e = displacement_[k], &v = velocity_[k];
    if (std::sqrt(stiffness) * since > std::numbers::pi) {  // too fast to be seen
      e = now / stiffness;
      v = 0;
    } else {
      for (int part = 1; part <= parts; ++part) {
        const auto force_at = [&](int at) { return lacking_[k] + (now - lacking_[k]) * at / parts; };
        const double a = force_at(part - 1) - damping * v - stiffness * e;
        const double a_new =
            (force_at(part) - damping * (v + 0.5 * h * a) - stiffness * (e + h * v + 0.25 * h * h * a)) /
            (1 + 0.5 * h * damping + 0.25 * h * h * stiffness);
        e += h * v + 0.25 * h * h * (a + a_new);
        v += 0.5 * h * (a + a_new);
      }
    }
    lacking_[k] = now;
  }
  time_ = time;
  estimate.fit = displacement_.norm();
  return estimate;
}

}  // namespace supple

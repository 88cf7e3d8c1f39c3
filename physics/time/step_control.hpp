#pragma once
/// \file Steps that are halved where they fail.

#include <physics/time/any_integrator.hpp>
#include <physics/time/energy_account.hpp>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace supple {

/// When a step is taken again as two of half its length.
struct StepControl {
  int max_halvings = 6;    ///< of one step; 0: never
  double residual = 1e-4;  ///< a step fails where its residual stays above; where it is not finite in any case
  /// And where it makes more than this share of the energies there are; one that conserves energy, a hundredth of it.
  double energy_made = 0.1;
};

/// An integrator with its EnergyAccount, that takes a step again as two of half its length where it fails, those again, and
/// so on; what worked is kept for the next steps, and the full length tried again after a while. Where the shortest fails,
/// too, another integrator may take its place, one that damps. The state only ever moves by steps that did not fail, unless
/// all that did; where that is not finite, it stays.
template <DynamicalSystem System>
class ControlledIntegrator {
 public:
  using MatrixType = typename System::MatrixType;
  using State = supple::State;
  using Make = std::function<AnyIntegrator<System>(double h)>;

  /// \param system  must outlive this.  \param make  integrator of this system by step [s].  \param damping  as it has.
  /// \param rescue  what takes the shortest steps that fail, such as BackwardEuler; may be empty.
  ControlledIntegrator(const System& system, double h, Make make, const RayleighDamping& damping = {},
                       const StepControl& control = {}, Make rescue = {})
      : system_(&system),
        h_(h),
        make_(std::move(make)),
        make_rescue_(std::move(rescue)),
        damping_(damping),
        control_(control) {
    require(control.max_halvings >= 0 && control.max_halvings <= 20,
            "max_halvings is " + std::to_string(control.max_halvings) + ", expected 0 to 20");
    levels_.push_back(make_(h));
    if (levels_.front().energy_behaviour() == EnergyBehaviour::Conserved) control_.energy_made *= 0.01;
  }

  double step_size() const { return h_; }  ///< [s], of a whole step
  int order() const { return levels_.front().order(); }
  EnergyBehaviour energy_behaviour() const { return levels_.front().energy_behaviour(); }
  State at_rest() const { return levels_.front().at_rest(); }

  /// The acceleration that u and v imply under this load.
  void balance(const SystemLoad<MatrixType>& load, State& state) const { levels_.front().balance(load, state); }

  /// One whole step. The account starts with the first, at the state it comes from.
  /// \return of all its parts together, the worst residual.
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, State& state) {
    if (!account_) account_.emplace(*system_, damping_, state);
    const State start = state;
    const EnergyAccount<System> account = *account_;
    halved_ = false;
    StepReport report{};
    report.status = Status::Converged;
    report.residual = 0;
    const Index rescued = rescued_;
    const std::size_t level = level_;
    for (Index part = 0; part < Index{1} << level && report.status != Status::NotFinite; ++part)
      advance(level, load, state, report);
    if (report.status == Status::NotFinite) {
      state = start;
      account_ = account;
      rescued_ = rescued;
      return report;
    }
    state.time = start.time + h_;
    parts_ += halved_ || level > 0;
    calm_ = halved_ ? 0 : calm_ + 1;
    if (calm_ >= calm_enough && level_ > 0) {
      --level_;
      calm_ = 0;
    }
    return report;
  }

  /// Energies after the last step. \pre a step was taken.
  const EnergyBalance& energies() const { return account_->now(); }
  Index halved_steps() const { return parts_; }     ///< steps that were taken in parts, so far
  Index rescued_parts() const { return rescued_; }  ///< of these parts, those that the other integrator took

 private:
  static constexpr int calm_enough = 8;  // steps without a failure, until longer ones are tried

  /// A part of a step: h / 2^level.
  template <typename Load>
  void advance(std::size_t level, const Load& load, State& state, StepReport& all) {
    while (levels_.size() <= level) levels_.push_back(make_(std::ldexp(h_, -static_cast<int>(levels_.size()))));
    Trial trial = attempt(levels_[level], load, state, all);
    if (trial.failed && static_cast<int>(level) < control_.max_halvings) {
      halved_ = true;
      level_ = std::max(level_, level + 1);
      for (int half = 0; half < 2 && all.status != Status::NotFinite; ++half) advance(level + 1, load, state, all);
      return;
    }
    if (trial.failed && level > 0 && make_rescue_) {
      if (!rescue_) rescue_.emplace(make_rescue_(std::ldexp(h_, -static_cast<int>(level))));
      Trial damped = attempt(*rescue_, load, state, all);
      if (!damped.failed || !trial.finite) {
        trial = std::move(damped);
        ++rescued_;
      }
    }
    all.residual = std::max(all.residual, trial.report.residual);
    if (trial.report.status != Status::Converged) all.status = trial.report.status;
    if (!trial.finite) {
      all.status = Status::NotFinite;
      return;
    }
    state = std::move(trial.state);
    account_ = trial.account;
  }

  /// A step that may be taken.
  struct Trial {
    StepReport report;
    State state;
    EnergyAccount<System> account;
    bool finite = false, failed = true;
  };
  template <typename Load>
  Trial attempt(AnyIntegrator<System>& integrator, const Load& load, const State& state, StepReport& all) const {
    Trial trial{{}, state, *account_};
    trial.report = integrator.step(load, trial.state);
    all.iterations += trial.report.iterations;
    all.tangents += trial.report.tangents;
    trial.finite = trial.report.status != Status::NotFinite && trial.state.u.allFinite() && trial.state.v.allFinite();
    if (!trial.finite) return trial;
    trial.account.add_step(load_at<MatrixType>(load, 0.5 * (state.time + trial.state.time)), state, trial.state);
    trial.failed = failed(trial.report, account_->now(), trial.account.now());
    return trial;
  }

  bool failed(const StepReport& report, const EnergyBalance& before, const EnergyBalance& after) const {
    if (!(report.residual <= control_.residual) && report.status != Status::Converged) return true;
    const double there = before.kinetic + before.elastic + std::abs(after.work - before.work);
    return !(after.made() - before.made() <= control_.energy_made * there);
  }

  const System* system_;
  double h_;
  Make make_, make_rescue_;
  RayleighDamping damping_;
  StepControl control_;
  std::vector<AnyIntegrator<System>> levels_;    // of steps h, h/2, h/4 …, as far as they were needed
  std::optional<AnyIntegrator<System>> rescue_;  // of the shortest
  std::optional<EnergyAccount<System>> account_;
  std::size_t level_ = 0;  // where steps start
  int calm_ = 0;
  bool halved_ = false;
  Index parts_ = 0, rescued_ = 0;
};

}  // namespace supple

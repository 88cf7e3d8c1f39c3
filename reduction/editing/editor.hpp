#pragma once
/// \file Editor by deformation: the shape of least energy under handles (Eq. 3 and Sec. 6).

#include <physics/load/loads.hpp>
#include <physics/statics/static_solver.hpp>
#include <reduction/editing/handles.hpp>

namespace supple {

/// Handles on an object and its equilibrium under them and what else acts. Handles come, go and move at any time; each solve starts from
/// the last state. Works on the reduced system (milliseconds) and on the full one (the reference) alike:
///
///     Editor editor(system, positions, {.solver = LineSearchBfgs{}});
///     const Index hand = editor.add({nodes, 100, weight});
///     editor.move(hand, RigidMotion::turn({0, 0, 1}, 0.3, wrist));
///     editor.solve();
///     const Vector u = system.expand(editor.state());
template <DynamicalSystem System>
class Editor {
 public:
  /// \param system          must outlive the editor.  \param rest_positions  n × 3 [m]
  Editor(const System& system, Points rest_positions, const StaticOptions& options = {})
      : system_(system), rest_positions_(std::move(rest_positions)), solver_(system, options) {
    reset();
  }

  /// \return the number to call the handle by. \throws std::invalid_argument for nodes that do not exist.
  Index add(Handle handle) {
    (void)handle_loads({handle}, rest_positions_);  // are its nodes there?
    handles_.push_back(std::move(handle));
    changed_ = true;
    return static_cast<Index>(handles_.size()) - 1;
  }
  void remove_all() {
    handles_.clear();
    changed_ = true;
  }
  /// From rest to where the motion takes it, not from the last place.
  void move(Index handle, const RigidMotion& motion) {
    require(handle >= 0 && handle < static_cast<Index>(handles_.size()),
            "handle " + std::to_string(handle) + " does not exist, there are " + std::to_string(handles_.size()));
    handles_[handle].motion = motion;
  }
  const std::vector<Handle>& handles() const { return handles_; }
  /// What acts beside the handles, such as gravity; nothing at first. \throws std::invalid_argument as check_loads().
  void set_loads(Loads loads) {
    check_loads(loads, rest_positions_.rows());
    loads_ = std::move(loads);
    changed_ = true;
  }

  /// To the equilibrium under the handles, from the last state. \return see StaticSolver; a state that is not finite
  /// is not kept.
  SolveReport solve() {
    const std::vector<PointSpring> springs = handle_loads(handles_, rest_positions_).springs;
    const auto first = static_cast<Index>(loads_.springs.size());
    if (changed_) {  // the stiffness depends on the samples only
      Loads all = loads_;
      all.springs.insert(all.springs.end(), springs.begin(), springs.end());
      load_ = system_.project(all);
      dead_force_ = load_.dead_force();
      changed_ = false;
    } else if (!load_.springs.empty()) {
      Vector& targets = load_.springs.targets;
      for (std::size_t k = 0; k < springs.size(); ++k)
        targets.segment<3>(3 * (first + static_cast<Index>(k))) = springs[k].displacement;
      load_.force = dead_force_ + load_.springs.pull_of_targets();
    }
    Vector u = state_;
    const SolveReport report = solver_.solve(load_, u);
    if (report.status != Status::NotFinite) state_ = std::move(u);
    return report;
  }

  const Vector& state() const { return state_; }  ///< unknowns of the system
  void reset() { state_ = Vector::Zero(system_.dim()); }
  /// Where the next solve starts; a full system likes to be led by a reduced one.
  void start_from(Vector state) {
    require_size("state", state.size(), system_.dim());
    state_ = std::move(state);
  }

  /// What forces leave at the state, f(u) + k (u − u*): zero in equilibrium.
  Vector imbalance() const {
    Vector g(system_.dim());
    system_.force(state_, g);
    if (load_.force.size() == 0) return g;  // nothing was solved yet
    load_.add_net_pull(state_, g);
    return g - load_.dead_force();
  }
  double elastic_energy() const { return system_.energy(state_); }  ///< [J]
  /// E^C [J].
  double control_energy(VectorIn displacement) const {
    double sum = 0;
    for (const Handle& handle : handles_) sum += supple::control_energy(handle, rest_positions_, displacement);
    return sum;
  }

 private:
  const System& system_;
  Points rest_positions_;
  StaticSolver<System> solver_;
  std::vector<Handle> handles_;
  Loads loads_;  // beside those of the handles
  SystemLoad<typename System::MatrixType> load_;
  Vector dead_force_;
  Vector state_;
  bool changed_ = true;
};

}  // namespace supple

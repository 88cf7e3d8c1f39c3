#include <core/check.hpp>
#include <core/stopwatch.hpp>
#include <core/text.hpp>
#include <physics/time/integrator_library.hpp>
#include <viewer/session/scaled_system.hpp>
#include <viewer/session/simulation_session.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

namespace {

constexpr Index most_held = 100;                   // springs
constexpr Index most_on_floor = 200;               // nodes: their rows of the basis are read in every evaluation
constexpr double reach_of_pulls = 100;             // how far from the object a target may be, in diagonals
constexpr double held_stiffness = 1e3;             // over λ₁ M, of all springs together
constexpr StepControl control{.max_halvings = 3};  // a step that nobody has time for helps nobody

StepOptions step_options(const ViewSettings& settings) {
  return {.damping = settings.damping, .solver = Bfgs{}};
}

/// Whether the object answers the same forces in the same way.
bool move_alike(const ViewSettings& a, const ViewSettings& b) {
  return a.stiffness == b.stiffness && a.damping.alpha == b.damping.alpha && a.damping.beta == b.damping.beta;
}

}  // namespace

double default_pull_stiffness(const ViewModel& model) {
  return 4 * model.softness();
}

std::vector<Index> spread_sample(const Points& points, Index count) {
  std::vector<Index> sample;
  if (points.rows() == 0 || count < 1) return sample;
  Vector nearest = Vector::Constant(points.rows(), std::numeric_limits<double>::infinity());
  Index next = 0;
  points.col(1).minCoeff(&next);
  while (static_cast<Index>(sample.size()) < std::min(count, points.rows())) {
    sample.push_back(next);
    const Eigen::RowVector3d last = points.row(next);
    nearest = nearest.cwiseMin((points.rowwise() - last).rowwise().squaredNorm());
    nearest[next] = -1;  // never again
    nearest.maxCoeff(&next);
  }
  std::ranges::sort(sample);
  return sample;
}

SimulationSession::SimulationSession(std::shared_ptr<const ViewModel> model)
    : model_(std::move(model)), system_(model_->system), state_(State::at_rest(model_->dim())) {
  settings_.step = model_->default_step();
  settings_.damping = damping(model_->model.body);
  check_settings(settings_, model_->diagonal);
  project_loads();
  rebuild_integrator();
  restart_estimate();
}

void SimulationSession::set(const ViewSettings& settings) {
  check_settings(settings, model_->diagonal);
  const auto floor = settings.floor == settings_.floor ? floor_
                     : settings.floor                  ? floor_term(*settings.floor)
                                                       : nullptr;
  const bool alike = move_alike(settings, settings_);
  settings_ = settings;
  floor_ = floor;
  system_ = scaled(model_->system, settings.stiffness);
  project_loads();
  rebuild_integrator();
  if (!alike) restart_estimate();
}

void SimulationSession::pull(int client, const Pull& pull) {
  const ViewGeometry& geometry = model_->geometry;
  require(pull.node >= 0 && pull.node < geometry.num_surface_nodes, "node " + std::to_string(pull.node) +
                                                                        " is not on the surface, expected 0 to " +
                                                                        std::to_string(geometry.num_surface_nodes - 1));
  require(!std::ranges::binary_search(geometry.fixed, pull.node),
          "node " + std::to_string(pull.node) + " is held by the model");
  const Point middle = 0.5 * (model_->box.lower + model_->box.upper);
  require((pull.target - middle).norm() <= reach_of_pulls * model_->diagonal,  // false for NaN
          "the target is more than 100 diagonals away from the object");
  const double softness = model_->softness(), stiffness = pull.stiffness.value_or(default_pull_stiffness(*model_));
  require(stiffness >= 1e-6 * softness && stiffness <= 1e6 * softness,
          "the stiffness of a pull is " + shown(stiffness) + " N/m, expected " + shown(1e-6 * softness) + " to " +
              shown(1e6 * softness));
  const auto before = pulls_.find(client);
  const bool same = before != pulls_.end() && before->second.node == pull.node && before->second.stiffness == stiffness;
  pulls_[client] = {pull.node, pull.target, stiffness};
  if (same)
    aim_springs();
  else
    project_loads();
}

void SimulationSession::release(int client) {
  if (pulls_.erase(client) > 0) project_loads();
}

void SimulationSession::hold(const std::vector<Index>& nodes) {
  const ViewGeometry& geometry = model_->geometry;
  (void)geometry.in_mesh(nodes);  // are they there?
  held_ = nodes;
  std::ranges::sort(held_);
  held_.erase(std::unique(held_.begin(), held_.end()), held_.end());
  const std::vector<Index> sample = spread_sample(geometry.rest(held_, Eigen::all), most_held);
  holding_.clear();
  for (const Index k : sample) {
    const Index node = geometry.nodes[held_[k]];
    holding_.push_back({node, held_stiffness * model_->softness() / static_cast<double>(sample.size()),
                        system_.displacement(state_.u, node)});
  }
  project_loads();
}

StepOutcome SimulationSession::step() {
  StepOutcome outcome;
  const Stopwatch watch;
  const State before = state_;
  try {
    outcome.report = integrator_->step(load_, state_);
    const EnergyBalance& energy = integrator_->energies();
    const double noise = 1e-9 * model_->softness() * model_->diagonal * model_->diagonal;
    if (outcome.report.status == Status::NotFinite)
      outcome.failure = "a step is not finite; a shorter step may help";
    else if (energy.made_share() > 1 && energy.made() > noise)
      outcome.failure =
          settings_.integrator.name +
          " made more energy than there was; a shorter step, average-vector-field or backward-euler may help";
    else
      makes_energy_ = energy.made_share() > 0.01 && energy.made() > noise;
  } catch (const SolverError& error) {
    outcome.failure = error.what();
  }
  if (!outcome.failure.empty()) {
    state_ = before;
    rebuild_integrator();
  } else {
    made_ = integrator_->energies().made();
    ++num_steps_;
    if (num_steps_ % MotionErrorEstimator::every == 0) estimate();
  }
  outcome.seconds = watch.seconds();
  return outcome;
}

void SimulationSession::reset() {
  state_ = State::at_rest(model_->dim());
  num_steps_ = 0;
  for (PointSpring& spring : holding_) spring.displacement.setZero();
  project_loads();
  rebuild_integrator();
  restart_estimate();
  made_before_ = 0;
}

double SimulationSession::outside_potential() const {
  return load_.net_pull_energy(state_.u) - dead_force_.dot(state_.u);
}

void SimulationSession::rebuild_integrator() {
  made_before_ += made_;
  made_ = 0;
  makes_energy_ = false;
  integrator_.emplace(
      make_controlled_integrator(settings_.integrator, system_, settings_.step, step_options(settings_), control));
  integrator_->balance(load_, state_);
}

void SimulationSession::restart_estimate() {
  estimator_.reset();
  if (model_->estimator && settings_.stiffness == 1) estimator_.emplace(*model_->estimator, settings_.damping);
  estimate_from_ = state_.time;
  estimated_error_ = not_known;
  beyond_training_ = false;
}

void SimulationSession::estimate() {
  if (!estimator_) return;
  const ErrorEstimate error = estimator_->advance(state_.time - estimate_from_, state_.u, system_.force(state_.u));
  const double size = state_.u.norm();
  estimated_error_ = size > 0 ? error.total() / size : not_known;
  beyond_training_ = error.beyond_training;
}

std::vector<PointSpring> SimulationSession::springs() const {
  std::vector<PointSpring> springs = holding_;
  for (const auto& [client, pull] : pulls_)
    springs.push_back({model_->geometry.nodes[pull.node], *pull.stiffness,
                       pull.target - model_->geometry.rest.row(pull.node).transpose()});
  return springs;
}

void SimulationSession::project_loads() {
  load_ = system_.project({.gravity = settings_.gravity, .springs = springs()});
  dead_force_ = load_.dead_force();
  if (floor_) load_.others.push_back(floor_);
}

void SimulationSession::aim_springs() {
  Index k = 0;
  for (const PointSpring& spring : springs()) load_.springs.targets.segment<3>(3 * k++) = spring.displacement;
  load_.force = dead_force_ + load_.springs.pull_of_targets();
}

std::shared_ptr<const OutsideTerm<Matrix>> SimulationSession::floor_term(const Floor& floor) const {
  const ViewGeometry& geometry = model_->geometry;
  std::vector<Index> nodes;
  for (const Index k : spread_sample(geometry.rest.topRows(geometry.num_surface_nodes), most_on_floor))
    nodes.push_back(geometry.nodes[k]);
  const auto count = static_cast<double>(nodes.size());
  // a tenth of the nodes bears the weight where it has sunk in by a two-hundredth of the diagonal, and the object gives way first
  const double weight = model_->mass * std::max(9.81, settings_.gravity.norm());
  const double stiffness = std::max(10 * weight / (0.005 * model_->diagonal), 100 * model_->softness());
  const FloorParameters parameters{.axis = floor.axis, .height = floor.height, .stiffness = stiffness};
  Loads loads;
  loads.others.emplace_back(
      PenaltyFloor(model_->rest(), nodes, Vector::Constant(static_cast<Index>(nodes.size()), 1 / count), parameters));
  return system_.project(loads).others.front();
}

}  // namespace supple

#include <core/check.hpp>
#include <viewer/session/edit_session.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {

namespace {

constexpr std::size_t most_moments = 1000, most_edits = 1000;
constexpr double reach_of_handles = 100;                // how far a handle may go, in diagonals
constexpr double turn_at_once = std::numbers::pi / 12;  // of a handle in a solve [rad]
constexpr double way_at_once = 0.05;                    // of its centre, in diagonals
constexpr int most_attempts = 20;                       // solves that go on where the last one ended
const StaticOptions options{.solver = Newton{}, .tolerance = 1e-6, .max_iterations = 30};

/// How many solves a motion of a body about `centre` takes.
double solves_for(const RigidMotion& way, const Point& centre, double diagonal) {
  const double angle = Eigen::AngleAxisd(way.rotation).angle();
  return std::max({1.0, angle / turn_at_once, (way(centre) - centre).norm() / (way_at_once * diagonal)});
}

}  // namespace

EditSession::EditSession(std::shared_ptr<const ViewModel> model)
    : model_(std::move(model)), editor_(model_->system, model_->rest(), options) {
  displacements_ = Vector::Zero(model_->rest().size());
}

EditHandle EditSession::make(HandleRegion region) {
  require(now_.handles.size() < most_handles,
          "there are " + std::to_string(most_handles) + " handles, as many as may be");
  std::ranges::sort(region.nodes);
  region.nodes.erase(std::unique(region.nodes.begin(), region.nodes.end()), region.nodes.end());
  for (const Index v : region.nodes)
    require(v >= 0 && v < model_->rest().rows(), "node " + std::to_string(v) + " does not exist");
  const std::vector<Index>& fixed = fixed_nodes(model_->model.body);
  std::erase_if(region.nodes, [&](Index v) { return std::ranges::binary_search(fixed, v); });
  require(!region.nodes.empty(), "the handle has no nodes that the model leaves free");
  const auto taken = [&](const std::string& name) {
    return std::ranges::any_of(now_.handles, [&](const EditHandle& other) { return other.region->name == name; });
  };
  require(region.name.empty() || !taken(region.name), "there is a handle '" + region.name + "' already");
  for (Index k = next_id_; region.name.empty(); ++k)
    if (const std::string name = "handle " + std::to_string(k); !taken(name)) region.name = name;
  require(region.name.size() <= 200, "the name of the handle is longer than 200 bytes");
  return {.id = next_id_++, .region = std::make_shared<const HandleRegion>(std::move(region))};
}

Index EditSession::add(HandleRegion region) {
  EditHandle made = make(std::move(region));
  remember();
  now_.handles.push_back(std::move(made));
  now_.reached.emplace_back();
  regrasp();
  EditHandle& added = now_.handles.back();
  if (!state().isZero(0)) {
    const std::vector<Index>& samples = editor_.handles().back().samples;
    const Points before = model_->rest()(samples, Eigen::all);
    Points after = before;
    for (std::size_t k = 0; k < samples.size(); ++k)
      after.row(static_cast<Index>(k)) += model_->system.displacement(state(), samples[k]).transpose();
    added.motion = now_.reached.back() = RigidMotion::fit(before, after);
  }
  unsettle();
  return added.id;
}

EditHandle& EditSession::handle(Index id) {
  const auto found = std::ranges::find(now_.handles, id, &EditHandle::id);
  require(found != now_.handles.end(), "handle " + std::to_string(id) + " does not exist");
  return *found;
}

void EditSession::move(Index id, const RigidMotion& motion, Grab grab) {
  EditHandle& moved = handle(id);
  require(moved.region->movable, "handle '" + moved.region->name + "' is not movable");
  require((motion(moved.centre) - moved.centre).norm() <= reach_of_handles * model_->diagonal,  // false for NaN
          "the motion leads more than 100 diagonals away");
  if (grab == Grab::Yes) remember();
  moved.motion = motion;
  waypoints_.clear();
  unsettle();
}

void EditSession::remove(Index id) {
  const auto at = &handle(id) - now_.handles.data();
  remember();
  now_.handles.erase(now_.handles.begin() + at);
  now_.reached.erase(now_.reached.begin() + at);
  regrasp();
  unsettle();
}

EditSession::Moment EditSession::moment() const {
  Moment moment = now_;
  moment.q = state();
  moment.settled = settled_;
  return moment;
}

void EditSession::remember() {
  waypoints_.clear();
  past_.push_back(moment());
  if (past_.size() > most_moments) past_.pop_front();
  future_.clear();
}

void EditSession::unsettle() {
  settled_ = false;
  attempts_ = 0;
}

void EditSession::restore(Moment moment) {
  waypoints_.clear();
  editor_.start_from(moment.q);
  settled_ = moment.settled;
  attempts_ = 0;
  now_ = std::move(moment);
  regrasp();
}

void EditSession::undo() {
  if (past_.empty()) return;
  future_.push_back(moment());
  restore(std::move(past_.back()));
  past_.pop_back();
}

void EditSession::redo() {
  if (future_.empty()) return;
  past_.push_back(moment());
  restore(std::move(future_.back()));
  future_.pop_back();
}

void EditSession::reset() {
  if (state().isZero(0) && settled_) return;
  remember();
  for (std::size_t k = 0; k < now_.handles.size(); ++k) now_.handles[k].motion = now_.reached[k] = RigidMotion();
  editor_.reset();
  settled_ = true;
}

EditScene EditSession::regions() const {
  EditScene scene;
  scene.seed = now_.seed;
  scene.loads = now_.loads;
  for (const EditHandle& some : now_.handles) scene.handles.push_back(*some.region);
  return scene;
}

void EditSession::regrasp() {
  editor_.remove_all();
  editor_.set_loads(now_.loads);
  const std::vector<Handle> grasps = make_handles(regions(), model_->softest_eigenvalue(), model_->mass);
  for (std::size_t k = 0; k < grasps.size(); ++k) {
    (void)editor_.add(grasps[k]);
    editor_.move(static_cast<Index>(k), now_.reached[k]);
    now_.handles[k].centre = grasps[k].centre(model_->rest());
  }
}

EditScene EditSession::scene() const {
  require(!now_.handles.empty(), "there are no handles to save");
  EditScene scene = regions();
  scene.description = model_->name;
  Edit edit;
  double solves = 1;
  for (std::size_t k = 0; k < now_.handles.size(); ++k) {
    const auto& [id, region, motion, centre] = now_.handles[k];
    if (motion.rotation.isIdentity(0) && motion.translation.isZero(0)) continue;
    edit.moves.emplace_back(static_cast<Index>(k), motion);
    solves = std::max(solves, solves_for(motion, centre, model_->diagonal));
  }
  edit.increments = static_cast<Index>(std::ceil(solves));
  scene.edits.push_back(std::move(edit));
  return scene;
}

void EditSession::load(const EditScene& scene) {
  require(scene.edits.size() <= most_edits, "the scene has " + std::to_string(scene.edits.size()) +
                                                " edits, expected at most " + std::to_string(most_edits));
  require(scene.loads.others.empty(), "the scene has outside forces, which no edit here takes");
  const Moment before = now_;
  const Index next_id = next_id_;
  std::vector<EditHandle> made;
  try {
    now_.handles.clear();
    for (const HandleRegion& region : scene.handles) now_.handles.push_back(make(region));
    made = std::exchange(now_.handles, before.handles);
  } catch (...) {
    now_ = before;
    next_id_ = next_id;
    throw;
  }
  remember();
  now_.handles = std::move(made);
  now_.reached.assign(now_.handles.size(), RigidMotion());
  now_.seed = scene.seed;
  now_.loads = scene.loads;
  editor_.reset();
  regrasp();
  std::vector<RigidMotion> last = now_.reached;
  for (const Edit& edit : scene.edits) {
    for (const auto& [k, motion] : edit.moves) last[k] = motion;
    waypoints_.push_back(last);
  }
  for (std::size_t k = 0; k < last.size(); ++k) now_.handles[k].motion = last[k];
  unsettle();
}

SolveReport EditSession::solve() {
  if (now_.handles.empty()) {  // nothing holds the object anywhere else
    editor_.reset();
    settled_ = true;
    return {{.status = Status::Converged, .iterations = 0, .residual = 0}};
  }
  std::vector<RigidMotion> targets;
  if (waypoints_.empty())
    for (const EditHandle& some : now_.handles) targets.push_back(some.motion);
  else
    targets = waypoints_.front();

  double solves = 1;
  std::vector<RigidMotion> ways;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    ways.push_back(targets[k].after(now_.reached[k].inverse()));
    solves = std::max(solves, solves_for(ways[k], now_.reached[k](now_.handles[k].centre), model_->diagonal));
  }
  const bool arrives = solves <= 1;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    RigidMotion& reached = now_.reached[k];
    reached = arrives ? targets[k] : ways[k].part(1 / solves, reached(now_.handles[k].centre)).after(reached);
    editor_.move(static_cast<Index>(k), reached);
  }
  const SolveReport report = editor_.solve();
  if (!arrives) return report;
  if (!waypoints_.empty()) waypoints_.pop_front();
  settled_ = waypoints_.empty() && (report.status != Status::MaxIterations || ++attempts_ >= most_attempts);
  return report;
}

void EditSession::give_up() {
  waypoints_.clear();
  for (std::size_t k = 0; k < now_.handles.size(); ++k) now_.handles[k].motion = now_.reached[k];
  settled_ = true;
}

const Vector& EditSession::displacements_of_samples() const {
  for (const Handle& grasp : editor_.handles())
    for (const Index v : grasp.samples) displacements_.segment<3>(3 * v) = model_->system.displacement(state(), v);
  return displacements_;
}

double EditSession::control_energy() const {
  return editor_.control_energy(displacements_of_samples());
}

double EditSession::held() const {
  return control_displacement(editor_.handles(), model_->rest(), displacements_of_samples(),
                              model_->softest_eigenvalue(), model_->mass) /
         model_->diagonal;
}

}  // namespace supple

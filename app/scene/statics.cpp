#include <app/scene/statics.hpp>
#include <core/stopwatch.hpp>
#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/body/body_system.hpp>
#include <physics/body/force_models.hpp>
#include <physics/statics/static_solver.hpp>
#include <reduction/subspace/rigid_modes.hpp>

#include <algorithm>

namespace supple {

namespace {

/// A share of an outside force.
class ScaledForce {
 public:
  ScaledForce(AnyOutsideForce whole, double share) : whole_(std::move(whole)), share_(share) {}
  std::span<const Index> nodes() const { return whole_.nodes(); }
  void force(const Points& u, Points& f) const {
    whole_.force(u, f);
    f *= share_;
  }
  void stiffness(const Points& u, ForceGradient& K) const {
    ForceGradient of_whole;
    whole_.stiffness(u, of_whole);
    for (const auto& [a, b, block] : of_whole.blocks()) K.add(a, b, share_ * block);
  }

 private:
  AnyOutsideForce whole_;
  double share_;
};

Loads scaled(Loads loads, double share) {
  loads.gravity *= share;
  for (NodalForce& load : loads.forces) load.force *= share;
  for (PointSpring& spring : loads.springs) spring.displacement *= share;
  for (AnyOutsideForce& other : loads.others)
    if (other.is_load() && share < 1) other = ScaledForce(other, share);
  return loads;
}

template <typename MatrixType>
Statics solve(const AnySystem<MatrixType>& system, const Loads& loads, const StaticsOptions& options,
              const Progress& progress) {
  constexpr double smallest = 1.0 / 1024;
  Statics result;
  result.unknowns = system.dim();
  const Stopwatch watch;
  StaticSolver<AnySystem<MatrixType>> solver(
      system, {.solver = options.solver, .tolerance = options.tolerance, .max_iterations = options.max_iterations});
  Vector u = Vector::Zero(system.dim());
  double reached = 0, step = 1.0 / static_cast<double>(options.steps);
  while (reached < 1) {
    const double next = reached + step > 1 - 1e-9 ? 1 : reached + step;
    Vector tried = u;
    const SolveReport report = solver.solve(system.project(scaled(loads, next)), tried);
    result.iterations += report.iterations;
    if (!is_equilibrium(report)) {
      step /= 2;
      ++result.halved_steps;
      if (step < smallest)
        throw SolverError("no equilibrium found beyond " + shown(100 * reached, 3) + " % of the loads (" +
                          std::string(to_string(report.status)) + ", residual " + shown(report.residual, 2) +
                          "): the object may buckle, invert or be torn there");
      continue;
    }
    u = std::move(tried);
    reached = next;
    ++result.steps;
    result.residual = report.residual;
    tell(progress, "load steps", reached);
  }
  result.seconds = watch.seconds();
  result.elastic = system.energy(u);
  result.u = system.expand(u);
  return result;
}

void require_held(const Body& body, const Loads& loads) {
  if (!std::ranges::all_of(loads.others, &AnyOutsideForce::is_load)) return;  // a floor may hold it
  const std::string motions = unheld_motions(body, loads.springs);
  if (!motions.empty())
    throw InputError("nothing holds the object: it can " + motions +
                     " without resistance, so it has no equilibrium; hold more (--fix)");
}

}  // namespace

bool is_equilibrium(const SolveReport& report) {
  constexpr double good_enough = 1e-6;
  return report.status == Status::Converged || (report.status == Status::Stagnated && report.residual <= good_enough);
}

std::string unheld_motions(const Body& body, const std::vector<PointSpring>& springs) {
  const Index n = num_nodes(body);
  const FreeComponents parts = with_force_model(body, [&](const auto& model) {
    std::vector<Index> stencils;
    for (Index i = 0; i < model->num_components(); ++i)
      stencils.insert(stencils.end(), model->stencil(i).begin(), model->stencil(i).end());
    return find_free_components(stencils, static_cast<Index>(model->stencil(0).size()), NodeNumbering(n, {}));
  });
  const Matrix rigid = rigid_modes(node_positions(body), parts);
  std::vector<Index> rows;  // unknowns that something holds
  for (const Index v : fixed_nodes(body))
    for (int c = 0; c < 3; ++c) rows.push_back(3 * v + c);
  for (const auto& [v, axes] : held_axes(body))
    for (int c = 0; c < 3; ++c)
      if (axes >> c & 1) rows.push_back(3 * v + c);
  for (const PointSpring& spring : springs)
    for (int c = 0; c < 3; ++c) rows.push_back(3 * spring.node + c);
  const Matrix held = rigid(rows, Eigen::all);
  for (Index part = 0; part < rigid.cols() / 6; ++part) {
    const auto own = held.middleCols(6 * part, 6);
    const SymmetricEigen eigen = symmetric_eigen(own.transpose() * own);
    const Index free = (eigen.values.array() <= 1e-10 * std::max(1.0, eigen.values[5])).count();
    if (free == 0) continue;
    constexpr const char* names[]{"move along x", "move along y", "move along z",
                                  "turn about x", "turn about y", "turn about z"};
    const Vector share = eigen.vectors.leftCols(free).rowwise().squaredNorm();
    std::string text;
    for (Index k = 0; k < 6; ++k)
      if (share[k] > 0.3) text += (text.empty() ? "" : ", ") + std::string(names[k]);
    return text.empty() ? "move" : text;
  }
  return "";
}

Statics full_equilibrium(const Body& body, const Loads& loads, const StaticsOptions& options,
                         const Progress& progress) {
  require_held(body, loads);
  return solve(full_system(body), loads, options, progress);
}

Statics reduced_equilibrium(const ReducedModel& model, const Loads& loads, const StaticsOptions& options,
                            const Progress& progress) {
  require_held(model.body, loads);
  return solve(model.system(), loads, options, progress);
}

}  // namespace supple

// The columns of the paper's Table 1 for one object, and what the paper does not show: held-out errors, the
// stiffness at rest, and the deviation of a trajectory from the same subspace without fitting. Prints one
// JSON object.
//
//   $ benchmark_table1 dragon.msh --fix 'y<4%' --recipe paper --points 150
#include <core/random.hpp>
#include <core/stopwatch.hpp>
#include <io/builtin_meshes.hpp>
#include <io/mesh_reader.hpp>
#include <io/node_sets.hpp>
#include <physics/newmark.hpp>
#include <reduction/reduce.hpp>

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>
#include <numbers>
#include <numeric>

using namespace supple;
using nlohmann::json;

namespace {

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// Median microseconds of a call, in batches that last long enough to time.
template <typename Call>
double microseconds(const Call& call) {
  std::vector<double> batches;
  for (int batch = 0; batch < 25; ++batch) {
    const Stopwatch watch;
    int calls = 0;
    for (; watch.seconds() < 2e-3; ++calls) call();
    batches.push_back(1e6 * watch.seconds() / calls);
  }
  return median(batches);
}

/// What the lateral pull does: 120 steps of a 60th of the slowest period, without damping.
struct Scene {
  Point pull;   ///< acceleration [m/s²]
  double step;  ///< [s]
  int steps = 120;
};

struct Run {
  Matrix trajectory;  // d × steps
  json numbers;
};

template <DynamicalSystem System>
Run simulate(const System& system, const Scene& scene, NonlinearSolver solver, double tolerance) {
  Newmark newmark(system, scene.step, {.solver = solver, .tolerance = tolerance});
  State state = State::at_rest(system.dim());
  const auto load = system.project({.gravity = scene.pull});
  newmark.balance(load, state);
  Run run{Matrix(system.dim(), scene.steps), {}};
  std::vector<double> seconds;
  double iterations = 0, refreshes = 0, worst = 0;
  int missed = 0;
  for (int k = 0; k < scene.steps; ++k) {
    const Stopwatch watch;
    const StepReport report = newmark.step(load, state);
    seconds.push_back(watch.seconds());
    iterations += static_cast<double>(report.iterations);
    refreshes += static_cast<double>(report.refreshes);
    worst = std::max(worst, report.residual);
    missed += report.status != Status::Converged;
    run.trajectory.col(k) = state.u;
  }
  run.numbers = {{"step_median_us", 1e6 * median(seconds)},
                 {"step_mean_us", 1e6 * std::accumulate(seconds.begin(), seconds.end(), 0.0) / scene.steps},
                 {"iterations", iterations / scene.steps},
                 {"refreshes", refreshes / scene.steps},
                 {"worst_residual", worst},
                 {"steps_that_missed_the_tolerance", missed}};
  return run;
}

double largest_displacement(const ReducedModel& model, VectorIn q) {
  return std::visit(
      [&](const auto& basis) {
        const Vector u = basis->reconstruct(q);
        return Eigen::Map<const Points>(u.data(), u.size() / 3, 3).rowwise().norm().maxCoeff();
      },
      model.subspace);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli("Table 1 for one object");
  std::string mesh_name, recipe = "default", law = "stvk", subspace = "extended", selector;
  std::vector<std::string> fix;
  Index modes = 15, points = 150, poses = 0;
  double target = 0.25, amplitude = 0, tolerance = 1e-6;
  std::uint64_t seed = 1;
  bool trajectories = true;
  cli.add_option("mesh", mesh_name, "file or built-in")->required();
  cli.add_option("--fix", fix);
  cli.add_option("--recipe", recipe)->check(CLI::IsMember({"default", "paper"}));
  cli.add_option("--law", law);
  cli.add_option("--subspace", subspace);
  cli.add_option("--selector", selector);
  cli.add_option("--modes", modes);
  cli.add_option("--points", points);
  cli.add_option("--poses", poses);
  cli.add_option("--amplitude", amplitude);
  cli.add_option("--seed", seed);
  cli.add_option("--target", target, "largest displacement in the violent scene, as a share of the diagonal");
  cli.add_option("--tolerance", tolerance);
  cli.add_flag("!--no-trajectories", trajectories);
  CLI11_PARSE(cli, argc, argv);

  const TetMesh mesh = is_builtin(mesh_name) ? builtin_mesh(mesh_name) : read_tet_mesh(mesh_name);
  std::vector<Index> fixed;
  for (const std::string& rule : fix) {
    const std::vector<Index> nodes = select_nodes(mesh, rule);
    fixed.insert(fixed.end(), nodes.begin(), nodes.end());
  }
  std::sort(fixed.begin(), fixed.end());
  fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
  const Solid solid = isotropic_solid(mesh, {.young = 1e5, .poisson = 0.4}, fixed, law);

  ReduceOptions options = recipe == "paper" ? ReduceOptions::paper() : ReduceOptions{};
  options.modes = modes;
  options.points = points;
  options.subspace = subspace;
  options.seed = seed;
  if (poses > 0) options.poses.count = poses;
  if (amplitude > 0) options.poses.amplitudes = {amplitude};
  if (!selector.empty()) options.selector = selector;
  ReduceReport report;
  ReducedModel model = reduce(solid, options, &report);

  json out{{"mesh", mesh_name},
           {"tets", report.tets},
           {"d", report.dimension},
           {"modes", modes},
           {"recipe", recipe},
           {"selector", options.selector},
           {"T", report.poses},
           {"s", report.points},
           {"seed", seed},
           {"training_error", report.training_error},
           {"selection_iterations", report.selection.iterations},
           {"stop_reason", report.selection.stop_reason},
           {"total_seconds", report.total_seconds},
           {"peak_memory_MB", report.peak_memory / 1e6},
           {"inverted_poses", report.inverted_poses},
           {"softest_fitted", report.fitted_eigenvalues[0]},
           {"softest_exact", report.exact_eigenvalues[0]},
           {"notes", report.notes}};
  for (const auto& [stage, seconds] : report.seconds) out["seconds"][stage] = seconds;
  for (const auto& [share, error] : report.held_out)
    out["held_out"][std::to_string(share).substr(0, 3)] = error;

  const double diagonal = bounding_box(mesh.nodes).diagonal(), omega = std::sqrt(report.exact_eigenvalues[0]);
  Scene scene{Point(0.5, 0.1, 1).normalized(), 2 * std::numbers::pi / omega / 60};
  Matrix fitted[2];
  const double shares[2] = {0.05, target};
  Point pulls[2];
  with_reduced_system(model, [&](const auto& system) {
    Random random(7);
    Vector q(system.dim()), f(system.dim());
    for (double& x : q) x = 1e-3 * random.normal();
    Matrix K;
    out["force_us"] = microseconds([&] { system.force(q, f); });
    double energies = 0;  // used, so that the call is not optimised away
    out["energy_us"] = microseconds([&] { energies += system.energy(q); });
    if (!std::isfinite(energies)) throw SolverError("the energy is not finite");
    out["tangent_us"] = microseconds([&] { system.stiffness(q, K); });
    if (!trajectories) return;
    // the pull whose suddenly applied linear response would reach the target, about twice the static one
    const Matrix shifted =
        system.rest_stiffness() + 1e-6 * omega * omega * Matrix::Identity(system.dim(), system.dim());
    const Vector q_static = shifted.llt().solve(system.project({.gravity = scene.pull}).force);
    for (int k = 0; k < 2; ++k) {
      pulls[k] = scene.pull * (shares[k] * diagonal / (1.5 * largest_displacement(model, q_static)));
      const Scene pulled{pulls[k], scene.step, scene.steps};
      const char* name = k == 0 ? "moderate" : "violent";
      Run newton = simulate(system, pulled, NonlinearSolver::Newton, tolerance);
      const Run broyden = simulate(system, pulled, NonlinearSolver::Broyden, tolerance);
      double reached = 0;
      for (Index j = 0; j < newton.trajectory.cols(); ++j)
        reached = std::max(reached, largest_displacement(model, newton.trajectory.col(j)) / diagonal);
      out[name] = {{"newton", newton.numbers},
                   {"broyden", broyden.numbers},
                   {"largest_displacement", reached},
                   {"newton_against_broyden",
                    (newton.trajectory - broyden.trajectory).norm() / newton.trajectory.norm()}};
      fitted[k] = std::move(newton.trajectory);
    }
  });
  if (trajectories) {
    ReducedModel unfitted = model;
    unfitted.indices.resize(mesh.num_tets());
    std::iota(unfitted.indices.begin(), unfitted.indices.end(), Index{0});
    unfitted.weights = Vector::Ones(mesh.num_tets());
    with_reduced_system(unfitted, [&](const auto& system) {
      for (int k = 0; k < 2; ++k) {
        const Run exact =
            simulate(system, {pulls[k], scene.step, scene.steps}, NonlinearSolver::Broyden, tolerance);
        out[k == 0 ? "moderate" : "violent"]["deviation_from_unfitted"] =
            (fitted[k] - exact.trajectory).norm() / exact.trajectory.norm();
      }
    });
  }
  std::cout << out.dump(1) << '\n';
}

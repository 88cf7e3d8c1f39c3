// The columns of the paper's Table 1 for one object, and what the paper does not show: held-out errors, the
// stiffness at rest, and the deviation of a trajectory from the same subspace without fitting. Prints one
// JSON object.
//
//   $ benchmark_table1 dragon.msh --fix 'y<4%' --recipe paper --points 150
#include <core/median.hpp>
#include <core/random.hpp>
#include <core/stopwatch.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/node_sets.hpp>
#include <reduction/model/with_reduced_system.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <reduction/training/pull_test.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>
#include <numeric>

using namespace supple;
using nlohmann::json;

namespace {

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

json numbers(const PulledMotion& motion) {
  const double count = static_cast<double>(motion.seconds.size());
  const double total = std::accumulate(motion.seconds.begin(), motion.seconds.end(), 0.0);
  return {{"step_median_us", 1e6 * median(motion.seconds)},
          {"step_mean_us", 1e6 * total / count},
          {"iterations", motion.iterations},
          {"refreshes", motion.refreshes},
          {"worst_residual", motion.worst_residual},
          {"steps_that_missed_the_tolerance", motion.missed_steps}};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli("Table 1 for one object");
  std::string mesh_name, recipe = "subspace", law = "stvk", subspace = "extended", selector;
  std::vector<std::string> fix;
  Index modes = 15, points = 150, poses = 0;
  double target = 0.25, amplitude = 0;
  std::uint64_t seed = 1;
  bool trajectories = true;
  cli.add_option("mesh", mesh_name, "file or built-in")->required();
  cli.add_option("--fix", fix);
  cli.add_option("--recipe", recipe)->check(CLI::IsMember({"subspace", "paper"}));
  cli.add_option("--law", law);
  cli.add_option("--subspace", subspace);
  cli.add_option("--selector", selector);
  cli.add_option("--modes", modes);
  cli.add_option("--points", points);
  cli.add_option("--poses", poses);
  cli.add_option("--amplitude", amplitude);
  cli.add_option("--seed", seed);
  cli.add_option("--target", target, "largest displacement in the violent scenes, as a share of the diagonal");
  cli.add_flag("!--no-trajectories", trajectories);
  CLI11_PARSE(cli, argc, argv);

  const TetMesh mesh = is_builtin(mesh_name) ? builtin_mesh(mesh_name) : read_tet_mesh(mesh_name);
  const std::vector<Index> fixed = select_nodes(mesh.nodes, fix);
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
           {"tets", report.components},
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
  for (const auto& [share, error] : report.held_out) out["held_out"][std::to_string(share).substr(0, 3)] = error;

  const double diagonal = bounding_box(mesh.nodes).diagonal();
  ReducedModel unfitted = model;
  unfitted.indices.resize(mesh.num_cells());
  std::iota(unfitted.indices.begin(), unfitted.indices.end(), Index{0});
  unfitted.weights = Vector::Ones(mesh.num_cells());
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
    const AnySystem<Matrix> erased = model.system();  // what a value costs beside the type known when compiling
    out["erased_force_us"] = microseconds([&] { erased.force(q, f); });
    if (!trajectories) return;
    const PullTest pulls({{.name = "moderate", .target = 0.05},
                          {.name = "violent", .target = target},
                          {.name = "violent, ramped", .target = target, .ramp = 60},
                          {.name = "violent, damped", .target = target, .damping = 0.05}},
                         reduced_modes(model), diagonal, system);
    std::vector<PulledMotion> motions;
    for (std::size_t k = 0; k < pulls.scenes().size(); ++k) {  // one by one, for the times
      motions.push_back(pulls.move(system, k));
      const PulledMotion newton = pulls.move(system, k, Newton{});
      out[pulls.scenes()[k].name] = {{"bfgs", numbers(motions[k])},
                                     {"broyden", numbers(pulls.move(system, k, Broyden{}))},
                                     {"newton", numbers(newton)},
                                     {"newton_against_bfgs", deviation(newton, motions[k])},
                                     {"largest_displacement", pulls.reach(system, motions[k].q)}};
    }
    with_reduced_system(unfitted, [&](const auto& exact) {
      if constexpr (std::is_same_v<decltype(exact), decltype(system)>) {
        const std::vector<PulledMotion> references = pulls.move(exact);
        for (std::size_t k = 0; k < references.size(); ++k)
          out[pulls.scenes()[k].name]["deviation_from_unfitted"] = deviation(motions[k], references[k]);
      }
    });
  });
  std::cout << out.dump(1) << '\n';
}

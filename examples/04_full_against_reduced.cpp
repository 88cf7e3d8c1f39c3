// The same motion in full and reduced: the tip of a bar that is pulled aside and let go (Figure 10 of the
// paper). Writes trajectory.csv, and trajectory.png if gnuplot is there.
//
//   $ example_04_full_against_reduced
//   1800 unknowns in full, 72 reduced; 2304 tets, 80 evaluated
//   tip of the bar: largest deviation 1.4 % of its amplitude; a step takes 31.2 ms in full, 0.02 ms reduced
#include <core/stopwatch.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/picture/plot.hpp>
#include <io/table/csv.hpp>
#include <physics/body/solid_model.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/newmark.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <cstdio>

using namespace supple;

struct Motion {
  Vector time, tip;
  double seconds_per_step;
};

/// 1.2 s of a pull that ends after 0.4 s; the z-displacement of a node is watched.
template <ObjectSystem System>
Motion simulate(const System& system, const NonlinearSolver& solver, Index watched) {
  const int steps = 120;
  Newmark newmark(system, 0.01, {.damping = {.beta = 0.001}, .solver = solver});
  State state = newmark.at_rest();
  const auto pull = system.project({.gravity = {0, 0, 3}}), nothing = system.project({});
  newmark.balance(pull, state);
  Motion motion{Vector(steps), Vector(steps), 0};
  const Stopwatch watch;
  for (int k = 0; k < steps; ++k) {
    if (newmark.step(k < 40 ? pull : nothing, state).status != Status::Converged)
      throw SolverError("a step did not converge");
    motion.time[k] = state.time;
    motion.tip[k] = system.displacement(state.u, watched)[2];
  }
  motion.seconds_per_step = watch.seconds() / steps;
  return motion;
}

int main() {
  const TetMesh mesh = builtin_mesh("bar:24x4x4");
  const Solid solid = isotropic_solid(mesh, {.young = 2e5, .poisson = 0.4}, select_nodes(mesh.nodes, "x<1%"));
  const Index watched = select_nodes(mesh.nodes, "x>99%").front();

  const FullSystem full(make_model<StVenantKirchhoff>(solid), solid.nodal_mass(), solid.fixed_nodes);
  const Motion reference = simulate(full, Newton{}, watched);

  const ReducedModel model = reduce(solid, {.modes = 8, .points = 80});
  const Motion motion = simulate(model.system(), Bfgs{}, watched);

  std::printf("%td unknowns in full, %td reduced; %td tets, %zu evaluated\n", full.dim(), model.dim(), mesh.num_cells(),
              model.indices.size());
  const double deviation = (motion.tip - reference.tip).cwiseAbs().maxCoeff() / reference.tip.cwiseAbs().maxCoeff();
  std::printf(
      "tip of the bar: largest deviation %.1f %% of its amplitude; a step takes %.1f ms in full, %.2f ms "
      "reduced\n",
      100 * deviation, 1e3 * reference.seconds_per_step, 1e3 * motion.seconds_per_step);

  CsvTable table{{"time", "s"}, {"full", "m"}, {"reduced", "m"}};
  for (Index k = 0; k < motion.time.size(); ++k) table.add_row(motion.time[k], reference.tip[k], motion.tip[k]);
  write_csv("trajectory.csv", table);
  if (can_plot())
    draw_plot("trajectory.png", {.title = "Tip of a bar that is pulled aside and let go",
                                 .x = {.label = "time [s]"},
                                 .y = {.label = "displacement [m]"},
                                 .series = {{"full", reference.time, reference.tip},
                                            {"reduced", motion.time, motion.tip, PlotStyle::DashedLine}}});
  return deviation < 0.1 ? 0 : 1;
}

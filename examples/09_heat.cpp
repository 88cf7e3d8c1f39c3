// Physics that is not elasticity: heat in a bar whose conductivity grows with temperature, warmed by two burners, in
// full and reduced. One unknown a node, no potential, tangents that are not symmetric; the rest is as for elastic
// bodies.
//
//   $ example_09_heat
//   1944 unknowns in full, 12 reduced, closest to it within 0.0033; up to 189 K; a step in full takes 26.2 ms
//   NN-OMP 60 of 9216 tets in 0.9 s: error 0.0004 in training, 0.0026 held out, 0.0041 on the way; a step takes 0.03 ms
//   NN-HTP 60 of 9216 tets in 0.0 s: error 0.0007 in training, 0.0024 held out, 0.0039 on the way; a step takes 0.03 ms
#include <core/stopwatch.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/heat/heat_conduction.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/first_order.hpp>
#include <reduction/basis/pca_basis.hpp>
#include <reduction/system/reduced_system.hpp>
#include <reduction/training/force_fitting.hpp>
#include <reduction/training/training_poses.hpp>
#include <sparse/selectors/nn_htp.hpp>
#include <sparse/selectors/nn_omp.hpp>

#include <cmath>
#include <cstdio>

using namespace supple;
using Model = HeatConduction<LinearConductivity>;

/// Two burners that swell and fade, differently for each phase: heat flows into nodes [W] at a time [s].
struct Burners {
  Index num_nodes;
  std::vector<Index> at_end, at_side;

  Vector operator()(double time, double phase) const {
    Vector flow = Vector::Zero(num_nodes);
    for (const Index v : at_end)
      flow[v] += 2500 * (1 + std::sin(2e-3 * time + phase)) / static_cast<double>(at_end.size());
    for (const Index v : at_side)
      flow[v] += 2000 * (1 + std::cos(3e-3 * time + 2 * phase)) / static_cast<double>(at_side.size());
    return flow;
  }
};

struct Heating {
  Matrix temperatures;  // of all nodes, one column a step
  double seconds_per_step;
};

/// 100 steps of 60 s from rest; to_nodes(u) are the temperatures of all nodes.
template <SemidiscreteSystem System, typename ToNodes>
Heating heat_up(const System& system, const Burners& burners, double phase, const ToNodes& to_nodes) {
  FirstOrderIntegrator integrator(system, 60);
  FirstOrderState state = FirstOrderState::at_rest(system.dim());
  Heating heating{Matrix(burners.num_nodes, 100), 0};
  const Stopwatch watch;
  for (Index k = 0; k < 100; ++k) {
    if (integrator.step(system.project(burners(state.time + 60, phase)), state).status != Status::Converged)
      throw SolverError("a step did not converge");
    heating.temperatures.col(k) = to_nodes(state.u);
  }
  heating.seconds_per_step = watch.seconds() / 100;
  return heating;
}

int main() {
  const TetMesh mesh = builtin_mesh("bar:24x8x8");
  const Burners burners{mesh.num_nodes(), select_nodes(mesh.nodes, "x>99%"),
                        nodes_in_box(mesh.nodes, "0.4,0.33,0:0.6,0.34,0.34")};
  // steel-like: k doubles in 200 K; held at the reference temperature at x = 0
  const FullSystem<Model> full(Model(mesh, LinearConductivity<double>::from(40, 0.005)),
                               lumped_heat_capacity(mesh, 7800, 460), select_nodes(mesh.nodes, "x<1%"));
  const auto expand = [&](VectorIn u) { return full.expand(u); };
  const Heating seen = heat_up(full, burners, 0, expand), unseen = heat_up(full, burners, 1, expand);

  const auto U = std::make_shared<const DenseBasis>(PcaBasis{.snapshots = seen.temperatures, .dimension = 12}(full));
  const Matrix K_rest = project_stiffness(*U, full);
  const auto fitting = [&](const Heating& heating) {
    return ForceFitting<Model, DenseBasis>(full.shared_model(), U,
                                           force_metric(ForceNorm::Stiffness, reduced_modes(K_rest)),
                                           poses_in_subspace(*U, full.nodal_mass(), heating.temperatures));
  };
  const auto training = fitting(seen), held_out = fitting(unseen);
  const auto off = [&](const Matrix& temperatures) {
    return (temperatures - unseen.temperatures).norm() / unseen.temperatures.norm();
  };
  std::printf(
      "%td unknowns in full, %td reduced, closest to it within %.4f; up to %.0f K; a step in full takes %.1f ms\n",
      full.dim(), U->dim(), off(U->W * held_out.poses()), unseen.temperatures.maxCoeff(),
      1e3 * unseen.seconds_per_step);

  bool good = true;
  const auto report = [&](const char* name, const Selection& selected) {
    const ReducedSystem reduced(full.shared_model(), U, selected.indices, selected.weights, K_rest, full.nodal_mass());
    const Heating heating = heat_up(reduced, burners, 1, [&](VectorIn q) { return U->reconstruct(q); });
    const double error = off(heating.temperatures);
    std::printf(
        "%-6s %td of %td tets in %.1f s: error %.4f in training, %.4f held out, %.4f on the way; a step takes %.2f "
        "ms\n",
        name, selected.size(), mesh.num_cells(), selected.report.seconds, selected.report.training_error,
        held_out.error(selected.indices, selected.weights), error, 1e3 * heating.seconds_per_step);
    good = good && error < 0.05;
  };
  report("NN-OMP", NnOmp{}(training, 60));
  report("NN-HTP", NnHtp{}(training, 60));
  return good ? 0 : 1;
}

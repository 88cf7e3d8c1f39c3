// Deformation-based editing: grasp a tube at both ends, bend it, and see how little the elastic energy that the reduced
// model found differs from the full one's.

#include <io/builtin/builtin_surfaces.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/picture/picture.hpp>
#include <physics/model/discrete_shell.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/editing/editor.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <cstdio>
#include <numbers>
#include <span>

using namespace supple;

int main() {
  const TriangleMesh mesh = builtin_surface("cylinder:24x40");
  const Shell shell = isotropic_shell(mesh, {.young = 1e6, .poisson = 0.4}, /*thickness=*/0.1);
  const ReducedModel model = reduce(shell, {.modes = 15, .points = 300});

  const double height = bounding_box(mesh.nodes).extent()[1];
  const Handle foot(select_nodes(mesh.nodes, "y<5%"), /*samples=*/100, /*weight=*/1e4),
      head(select_nodes(mesh.nodes, "y>95%"), 100, 1e4);
  // grasps both ends and turns the head in ten steps
  const auto bend = [&](auto& editor) {
    editor.add(foot);
    const Index hand = editor.add(head);
    for (int k = 1; k <= 10; ++k) {
      editor.move(hand, RigidMotion::turn({0, 0, 1}, 0.025 * k * std::numbers::pi, {0, height / 2, 0}));
      const SolveReport report = editor.solve();
      if (report.status != Status::Converged) std::printf("solve %d: residual %.1e\n", k, report.residual);
    }
  };
  const auto system = model.system();
  Editor editor(system, mesh.nodes, {.solver = LineSearchBfgs{}});
  bend(editor);
  const Vector u = system.expand(editor.state());

  const FullSystem<DiscreteShell> full(DiscreteShell(mesh, shell.materials), shell.nodal_mass());
  Editor reference(full, mesh.nodes);
  bend(reference);
  const double off = (u - full.expand(reference.state())).norm() / u.norm();
  std::printf("%ld flaps; %ld unknowns reduced to %ld\n", static_cast<long>(interior_edges(mesh).size()),
              static_cast<long>(full.dim()), static_cast<long>(model.dim()));
  std::printf("elastic energy: reduced %.3g J, full %.3g J; displacements differ by %.1f %%\n", editor.elastic_energy(),
              reference.elastic_energy(), 100 * off);

  PictureObject object{.positions = mesh.nodes + Eigen::Map<const Points>(u.data(), mesh.num_nodes(), 3),
                       .triangles = mesh.triangles};
  write_png("bent_tube.png", draw_picture(std::span(&object, 1)));
  return off < 0.2 ? 0 : 1;
}

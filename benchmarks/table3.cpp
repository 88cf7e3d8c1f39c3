// The columns of the paper's Table 3 for one object: seconds for the vibration modes, for extending them by
// linear maps, and for all their modal derivatives; skinning eigenmodes of as many dimensions beside them.
// Prints one JSON object.
//
//   $ benchmark_table3 dragon.msh --fix 'y<4%' --modes 15
#include <core/parallel.hpp>
#include <core/stopwatch.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/body/body.hpp>
#include <physics/body/force_models.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/basis/modal_derivatives.hpp>
#include <reduction/basis/skinning_modes.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>

using namespace supple;

int main(int argc, char** argv) {
  CLI::App cli("Table 3 for one object");
  std::string mesh_name, law = "stvk";
  std::vector<std::string> fix;
  Index num_modes = 15;
  int threads = 0;
  cli.add_option("mesh", mesh_name, "file or built-in")->required();
  cli.add_option("--fix", fix);
  cli.add_option("--law", law);
  cli.add_option("--modes", num_modes, "r, beside rigid ones");
  cli.add_option("--threads", threads);
  CLI11_PARSE(cli, argc, argv);
  set_num_threads(threads);

  const TetMesh mesh = is_builtin(mesh_name) ? builtin_mesh(mesh_name) : read_tet_mesh(mesh_name);
  const std::vector<Index> fixed = select_nodes(mesh.nodes, fix);
  const Solid solid = isotropic_solid(mesh, {.young = 1e5, .poisson = 0.4}, fixed, law);

  nlohmann::json out{{"mesh", mesh_name}, {"nodes", mesh.num_nodes()}, {"tets", mesh.num_cells()}, {"r", num_modes}};
  with_force_model(solid, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    const FullSystem<Model> system(model, solid.nodal_mass(), fixed);
    const RestState object = system.rest_state();
    const Index rigid = find_free_components(object.stencils, object.stencil_size, object.numbering).num_rigid_modes();

    Stopwatch watch;
    const VibrationModes modes = vibration_modes(system, {.num_modes = rigid + num_modes});
    out["seconds"]["modes"] = watch.seconds();
    watch = {};
    const NodalBasis extended = extend_modes(modes, object.positions, object.nodal_mass);
    out["seconds"]["extension"] = watch.seconds();
    out["d"]["extension"] = extended.dim();
    watch = {};
    const ModalDerivativeVectors derivatives = modal_derivatives(object, modes);
    out["seconds"]["derivatives"] = watch.seconds();
    out["residual of derivatives"] = derivatives.residual;
    watch = {};
    const DenseBasis basis = ModalDerivatives{.num_modes = num_modes}(system);
    out["seconds"]["modes, derivatives and their basis"] = watch.seconds();
    out["d"]["derivatives"] = basis.dim();
    watch = {};
    const NodalBasis skinning = SkinningModes{.num_weights = (extended.dim() + 11) / 12}(system);
    out["seconds"]["skinning modes"] = watch.seconds();
    out["d"]["skinning modes"] = skinning.dim();
  });
  std::cout << out.dump(1) << '\n';
}

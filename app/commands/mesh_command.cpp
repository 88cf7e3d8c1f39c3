#include <app/commands/mesh_command.hpp>
#include <app/commands/mesh_source.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <io/frames/vtu_writer.hpp>

#include <CLI/CLI.hpp>

#include <concepts>

namespace supple {

void MeshCommand::run() const {
  require_writable(output);
  const NamedMesh named = load_mesh(source);
  const ExitGuard guard(output);
  std::visit(
      [&]<typename Mesh>(const Mesh& mesh) {
        if constexpr (std::same_as<Mesh, TriangleMesh>) {
          write_vtu(output, mesh.nodes, mesh.triangles, {});
        } else {
          VtuFields fields;
          if (!mesh.region.empty()) {
            RowMatrix region(mesh.num_cells(), 1);
            for (Index e = 0; e < mesh.num_cells(); ++e) region(e, 0) = mesh.region[e];
            fields.cell_data.push_back({"region", region});
          }
          write_vtu(output, mesh.nodes, mesh.cells, fields);
        }
      },
      named.mesh);
}

void MeshCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("mesh", "Write a built-in or other mesh for ParaView");
  command.add_option("SOURCE", source, "Mesh file or built-in mesh")->required();
  command.add_option("-o,--output", output, "File to write")->required()->type_name("FILE.vtu");
  command.footer(builtin_help());
  command.callback([this] { run(); });
}

}  // namespace supple

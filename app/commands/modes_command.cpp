#include <app/commands/modes_command.hpp>
#include <app/commands/option_checks.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/result_fields.hpp>
#include <core/parallel.hpp>
#include <core/version.hpp>
#include <io/table/csv.hpp>
#include <physics/body/force_models.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/basis/modal_basis.hpp>

#include <CLI/CLI.hpp>

#include <numbers>

namespace supple {

namespace {

void write_frequencies(const std::filesystem::path& path, const VibrationModes& modes) {
  CsvTable table{{"mode"}, {"frequency", "Hz"}, {"omega", "rad/s"}, {"residual"}};
  for (Index k = 0; k < modes.omega.size(); ++k)
    table.add_row(k + 1, modes.omega[k] / (2 * std::numbers::pi), modes.omega[k], modes.residuals[k]);
  const ExitGuard guard;
  write_csv(path, table);
}

/// All shapes over the object at rest, each with a largest displacement of a tenth of the diagonal.
void write_shapes(const std::filesystem::path& path, const Body& body, const VibrationModes& modes) {
  VtuFields fields;
  const double size = 0.1 * bounding_box(node_positions(body)).diagonal();
  for (Index k = 0; k < modes.omega.size(); ++k) {
    Vector shape = modes.vectors.col(k);
    shape *= size / shape.reshaped<Eigen::RowMajor>(shape.size() / 3, 3).rowwise().norm().maxCoeff();
    fields.point_data.push_back(vector_field(
        "mode " + std::to_string(k + 1) + ", " + shown(modes.omega[k] / (2 * std::numbers::pi), 5) + " Hz", shape));
  }
  write_body(path, body, node_positions(body), std::move(fields));
}

}  // namespace

void ModesCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  StageTimes times;
  const Body body = load_body(*this, load_mesh(mesh, mesh_unit));
  if (const auto note = locking_note(*this, body)) warn(*note);
  const OutputFolder folder(output);
  times.finish("read object");
  const Progress progress = progress_bar();
  Index unknowns = 0;
  const VibrationModes modes = with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    const FullSystem<Model> system(model, nodal_mass(body), fixed_nodes(body), held_axes(body));
    unknowns = system.dim();
    Index asked = std::min(unknowns, count + (is_free(body) ? 6 : 0));
    const Index most = unknowns - static_cast<Index>(system.numbering().held_unknowns().size());
    while (true) {  // hinges and planes of symmetry leave more motions without energy
      VibrationModes found =
          vibration_modes(system.rest_state(), {.num_modes = asked, .seed = seed, .progress = progress});
      const Index wanted = std::min(most, count + found.num_zero);
      if (asked >= wanted) return found;
      asked = wanted;
    }
  });
  times.finish("vibration modes");
  if (!output.empty()) {
    write_frequencies(output / "frequencies.csv", modes);
    write_shapes(output / "modes.vtu", body, modes);
    times.finish("results");
  }
  clear_progress();
  const Vector hertz = modes.omega / (2 * std::numbers::pi);
  Json report;
  report["command"] = "modes";
  report["version"] = SUPPLE_VERSION;
  report["mesh"] = mesh;
  report["unknowns"] = unknowns;
  report["motions_without_energy"] = modes.num_zero;
  report["frequencies"] = json_numbers(hertz);
  report["residuals"] = json_numbers(modes.residuals);
  report["mass"] = nodal_mass(body).sum();
  report["threads"] = num_threads();
  report["seconds"] = json_seconds(times.seconds(), times.total());
  Rows rows{{"unknowns", shown_count(unknowns)},
            {"mass", shown(nodal_mass(body).sum()) + " kg"},
            {"motions without energy", std::to_string(modes.num_zero)}};
  for (Index k = modes.num_zero; k < hertz.size(); ++k)
    rows.emplace_back("mode " + std::to_string(k + 1), shown(hertz[k], 6) + " Hz");
  if (!output.empty()) {
    rows.emplace_back("results", output.string());
    write_json(output / "report.json", report);
  }
  if (!is_stdout(json)) {
    print_rows(stdout, "modes of " + mesh, rows);
    print_stages(stdout, times.seconds(), times.total());
  }
  write_json(json, report);
}

void ModesCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("modes", "Find natural frequencies and their shapes");
  declare_object(command, *this);
  command.add_option("--count", count, "Number of modes behind the motions without energy")
      ->capture_default_str()
      ->type_name("N")
      ->check(whole_number());
  command.add_option("-o,--output", output, "Folder for frequencies.csv, modes.vtu and the report")->type_name("DIR");
  declare_seed(command, seed);
  declare_json(command, json);
  declare_threads(command, threads);
  command.footer([] {
    return material_help() + "\n" + builtin_help() +
           "\nExample:\nsupple modes bracket.msh --young '210 GPa' --poisson 0.3 --density 7850 --fix 'z=0' -o modes";
  });
  command.callback([this] { run(); });
}

}  // namespace supple

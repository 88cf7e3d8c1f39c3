#include <app/commands/compare_command.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/coloured_picture.hpp>
#include <app/scene/comparison.hpp>
#include <app/scene/trajectory.hpp>
#include <core/check.hpp>
#include <core/parallel.hpp>
#include <core/version.hpp>
#include <io/picture/plot.hpp>
#include <io/table/csv.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

namespace {

/// Frames of both at the same times.
std::vector<std::pair<Index, Index>> common_frames(const CompareCommand& command, const Trajectory& a,
                                                   const Trajectory& b) {
  const double horizon = std::min(a.time[a.num_frames() - 1], b.time[b.num_frames() - 1]);
  const double tolerance = 1e-6 * std::max({a.step, b.step, 1e-9 * horizon});
  const auto inside = [&](const Trajectory& t) {
    return std::count_if(t.time.begin(), t.time.end(), [&](double x) { return x <= horizon + tolerance; });
  };
  const bool a_is_sparse = inside(a) <= inside(b);
  const Trajectory &few = a_is_sparse ? a : b, &many = a_is_sparse ? b : a;
  std::vector<std::pair<Index, Index>> pairs;
  for (Index f = 0; f < inside(few); ++f) {
    const double time = few.time[f];
    const Index at = std::lower_bound(many.time.begin(), many.time.end(), time - tolerance) - many.time.begin();
    if (at == many.num_frames() || many.time[at] > time + tolerance)
      throw InputError((a_is_sparse ? command.reference : command.first).string() + ": there is no frame at " +
                       shown(time, 8) + " s, where " + (a_is_sparse ? command.first : command.reference).string() +
                       " has one; run both with the same --step and --every");
    pairs.push_back(a_is_sparse ? std::pair(f, at) : std::pair(at, f));
  }
  return pairs;
}

std::pair<std::string, std::string> names(const CompareCommand& command, const Trajectory& a, const Trajectory& b) {
  if (a.reduced != b.reduced) return a.reduced ? std::pair("reduced", "full") : std::pair("full", "reduced");
  return {command.first.filename().string(), command.reference.filename().string()};
}

void write_errors(const std::filesystem::path& path, const Comparison& c) {
  CsvTable table{{"time", "s"}, {"position_error"}, {"velocity_error"}, {"energy_error"}, {"largest_distance", "m"}};
  const Vector position = c.position.share(), velocity = c.velocity.share(), energy = c.energy.share();
  for (Index f = 0; f < c.time.size(); ++f)
    table.add_row(c.time[f], position[f], velocity[f], energy[f], c.largest_distance[f]);
  const ExitGuard guard;
  write_csv(path, table);
}

void draw_errors(const std::filesystem::path& path, const Comparison& c) {
  const ExitGuard guard;
  draw_plot(path, {.title = "Deviation over time, against the reference's largest value",
                   .x = {.label = "time [s]", .low = 0.0, .high = c.time[c.time.size() - 1]},
                   .y = {.label = "deviation [%]", .low = 0.0},
                   .series = {{"positions", c.time, 100 * c.position.share()},
                              {"velocities", c.time, 100 * c.velocity.share()},
                              {"energy", c.time, 100 * c.energy.share()}}});
}

void draw_comparison(const std::filesystem::path& path, const Body& body,
                     const std::pair<std::string, std::string>& name, const Vector& u_a, const Vector& u_b,
                     double time) {
  const Surface surface(body);
  const Points rest = surface.rows(node_positions(body)), a = surface.rows(as_points(u_a)),
               b = surface.rows(as_points(u_b));
  char text[32];
  std::snprintf(text, sizeof text, ", t = %.3f s", time);
  std::vector<PictureObject> objects(2);
  objects[0] = {.positions = rest + b, .triangles = surface.triangles};
  objects[0].caption = name.second + text;
  objects[1] = {.positions = rest + a, .triangles = surface.triangles};
  objects[1].scalar = (a - b).rowwise().norm();
  objects[1].caption = name.first + text;
  write_coloured_picture(path, objects, "distance [m]", 1600, 800);
}

}  // namespace

void CompareCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  const Trajectory a = load_trajectory(first), b = load_trajectory(reference);
  const ReducedModel model_b = load_model_of(b, reference);
  const bool one_model = a.model_checksum == b.model_checksum && a.model == b.model;
  if (one_model && a.u.cols() != (a.reduced ? model_b.dim() : 3 * num_nodes(model_b.body)))
    throw InputError(first.string() + ": its frames do not fit its model");
  const ReducedModel model_a = one_model ? model_b : load_model_of(a, first);
  const Points& nodes = node_positions(model_b.body);
  if (!has_nodes(model_a.body, nodes))
    throw InputError(first.string() + " and " + reference.string() + " are of different meshes");
  const std::vector<std::pair<Index, Index>> frames = common_frames(*this, a, b);
  const OutputFolder folder(output);

  const Progress progress = progress_bar();
  const Comparison result = compare({a, model_a}, {b, model_b}, frames, progress);
  Index worst = 0;
  result.position.difference.maxCoeff(&worst);
  const double diagonal = bounding_box(nodes).diagonal(), distance = result.largest_distance.maxCoeff();
  const auto name = names(*this, a, b);
  if (!output.empty()) {
    write_errors(output / "errors.csv", result);
    if (!(result.time[result.time.size() - 1] > 0 && result.position.share().allFinite() &&
          result.velocity.share().allFinite() && result.energy.share().allFinite()))
      warn("the reference does not move: there will be no errors.png");
    else if (can_plot())
      draw_errors(output / "errors.png", result);
    else
      warn("gnuplot is not installed: there will be no errors.png");
    tell(progress, "picture", 0);
    const auto [f, g] = frames[worst];
    draw_comparison(output / "comparison.png", model_b.body, name, frame_displacement(a, model_a, f),
                    frame_displacement(b, model_b, g), result.time[worst]);
  }
  clear_progress();

  Json report;
  report["command"] = "compare";
  report["version"] = SUPPLE_VERSION;
  report["first"] = {
      {"source", first.string()}, {"system", a.reduced ? "reduced" : "full"}, {"steps_per_second", a.steps_per_second}};
  report["reference"] = {{"source", reference.string()},
                         {"system", b.reduced ? "reduced" : "full"},
                         {"steps_per_second", b.steps_per_second}};
  report["frames"] = frames.size();
  report["frames_left_out"] = a.num_frames() + b.num_frames() - 2 * static_cast<Index>(frames.size());
  report["until"] = result.time[result.time.size() - 1];
  const auto add = [&](const char* key, const Deviation& series) {
    report[key] = {{"relative", series.relative()}, {"largest", series.largest()}};
  };
  add("position_error", result.position);
  add("velocity_error", result.velocity);
  add("energy_error", result.energy);
  report["largest_distance"] = {{"metres", distance}, {"share_of_diagonal", distance / diagonal}};
  report["speed_up"] =
      b.steps_per_second > 0 ? a.steps_per_second / b.steps_per_second : std::numeric_limits<double>::quiet_NaN();
  if (!output.empty()) write_json(output / "report.json", report);
  if (!is_stdout(json)) {
    const auto errors = [](const Deviation& series) {
      return shown_percent(series.relative()) + "; worst frame " + shown_percent(series.largest()) + " of the largest";
    };
    Rows rows{{"frames", std::to_string(frames.size()) + " until " + shown(result.time[result.time.size() - 1]) + " s"},
              {"positions", errors(result.position)},
              {"velocities", errors(result.velocity)},
              {"energy", errors(result.energy)},
              {"farthest node",
               shown(distance, 3) + " m apart, " + shown_percent(distance / diagonal, 2) + " of the diagonal"}};
    if (b.steps_per_second > 0)  // not of edits
      rows.emplace_back("steps/s", shown(a.steps_per_second) + " against " + shown(b.steps_per_second) + ": " +
                                       shown(a.steps_per_second / b.steps_per_second, 3) + " times as fast");
    if (!output.empty()) rows.emplace_back("results", output.string());
    print_rows(stdout, name.first + " against " + name.second, rows);
  }
  write_json(json, report);
}

void CompareCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("compare", "Measure how far one trajectory is from another");
  command.add_option("FIRST", first, "Folder or trajectory file of 'supple simulate'")->required();
  command.add_option("REFERENCE", reference, "What it is compared with")->required();
  command.add_option("-o,--output", output, "Folder for errors.csv, errors.png and comparison.png")->type_name("DIR");
  declare_json(command, json);
  declare_plugins(command);
  declare_threads(command, threads);
  command.footer(
      "Frames count at times that both have, up to the end of the shorter one; errors are root mean squares over\n"
      "nodes (by mass) and frames, relative to the reference.\n"
      "\nExample:\nsupple compare run full -o comparison");
  command.callback([this] { run(); });
}

}  // namespace supple

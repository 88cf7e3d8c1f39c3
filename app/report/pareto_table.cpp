#include <app/report/exit_guard.hpp>
#include <app/report/page.hpp>
#include <app/report/pareto_table.hpp>
#include <app/report/terminal.hpp>
#include <core/output_file.hpp>
#include <core/registry.hpp>
#include <io/picture/plot.hpp>
#include <io/table/csv.hpp>
#include <reduction/pipeline/model_choice.hpp>

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

double error_of(const ParetoPoint& point, ParetoError error) {
  return error == ParetoError::Trajectory ? point.trajectory_error : point.full_error.total;
}

bool several_tolerances(const std::vector<ParetoPoint>& points) {
  return std::ranges::any_of(points, [&](const ParetoPoint& p) { return p.tolerance != points.front().tolerance; });
}

/// In percent, "–" for nothing.
std::string percent(double share) {
  return std::isnan(share) ? "–" : shown(100 * share, 3);
}

TextTable table_of(const std::vector<ParetoPoint>& points, ParetoError error) {
  const bool motions = error == ParetoError::Trajectory, tolerances = several_tolerances(points);
  TextTable table{{"model", "d", "s"}, {}};
  if (tolerances) table.heading.push_back("tolerance");
  table.heading.insert(table.heading.end(), {"step [µs]", "iterations", "equilibria [%]", "outside [%]", "inside [%]"});
  if (motions) table.heading.push_back("trajectory [%]");
  table.heading.insert(table.heading.end(), {"reduce [s]", "front"});
  for (const ParetoPoint& p : points) {
    std::vector<std::string>& row =
        table.rows.emplace_back(std::vector{p.model, std::to_string(p.dimension), std::to_string(p.points)});
    if (tolerances) row.push_back(shown(p.tolerance));
    row.insert(row.end(), {shown(1e6 * p.step_seconds, 3), shown(p.mean_iterations, 3), percent(p.full_error.total),
                           percent(p.full_error.outside), percent(p.full_error.inside)});
    if (motions) row.push_back(percent(p.trajectory_error));
    row.insert(row.end(), {shown(p.reduce_seconds, 3), p.front ? "yes" : p.complete ? "" : "stops early"});
  }
  return table;
}

/// Points that a test picks, each with its d and s beside it.
template <typename Picks>
PlotSeries series_of(const std::string& name, const std::vector<ParetoPoint>& points, ParetoError error,
                     const Picks& picks, PlotStyle style) {
  std::vector<ParetoPoint> some;
  std::ranges::copy_if(points, std::back_inserter(some), picks);
  std::ranges::sort(some, {}, &ParetoPoint::step_seconds);
  PlotSeries series{name, Vector(some.size()), Vector(some.size()), style};
  for (std::size_t k = 0; k < some.size(); ++k) {
    series.x[static_cast<Index>(k)] = 1e6 * some[k].step_seconds;
    series.y[static_cast<Index>(k)] = 100 * error_of(some[k], error);
    if (style == PlotStyle::Markers)
      series.labels.push_back(std::to_string(some[k].dimension) + ", " + std::to_string(some[k].points));
  }
  return series;
}

/// An axis that ends a little beyond its values.
Axis around(std::string label, const std::vector<double>& values) {
  return {.label = std::move(label),
          .scale = Scale::Log,
          .low = *std::ranges::min_element(values) / 1.3,
          .high = *std::ranges::max_element(values) * 1.5};
}

}  // namespace

void mark_front(std::vector<ParetoPoint>& points, ParetoError error) {
  std::vector<ModelMeasure> measures;
  for (const ParetoPoint& p : points)
    measures.push_back({p.step_seconds, p.complete ? error_of(p, error) : std::numeric_limits<double>::quiet_NaN()});
  const std::vector<bool> front = pareto_front(measures);
  for (std::size_t k = 0; k < points.size(); ++k) points[k].front = front[k];
}

Json points_json(const std::vector<ParetoPoint>& points) {
  Json json = Json::array();
  for (const ParetoPoint& p : points)
    json.push_back({{"model", p.model},
                    {"subspace", p.subspace},
                    {"modes", p.modes},
                    {"dimension", p.dimension},
                    {"points", p.points},
                    {"tolerance", p.tolerance},
                    {"step_seconds", p.step_seconds},
                    {"mean_iterations", p.mean_iterations},
                    {"missed_steps", p.missed_steps},
                    {"status", p.complete ? "complete" : "stopped"},
                    {"full_error", json_full_error(p.full_error)},
                    {"trajectory_error", p.trajectory_error},
                    {"training_error", p.training_error},
                    {"held_out_error", p.held_out_error},
                    {"reduce_seconds", p.reduce_seconds},
                    {"front", p.front}});
  return json;
}

void write_points(const std::filesystem::path& path, const std::vector<ParetoPoint>& points) {
  CsvTable table{{"model"},
                 {"subspace"},
                 {"modes"},
                 {"dimension"},
                 {"points"},
                 {"tolerance"},
                 {"step", "s"},
                 {"mean_iterations"},
                 {"missed_steps"},
                 {"full_error"},
                 {"outside_subspace"},
                 {"inside_subspace"},
                 {"trajectory_error"},
                 {"training_error"},
                 {"held_out_error"},
                 {"reduce", "s"},
                 {"front"}};
  for (const ParetoPoint& p : points)
    table.add_row(p.model, p.subspace, p.modes, p.dimension, p.points, p.tolerance, p.step_seconds, p.mean_iterations,
                  p.missed_steps, p.full_error.total, p.full_error.outside, p.full_error.inside, p.trajectory_error,
                  p.training_error, p.held_out_error, p.reduce_seconds, p.front ? 1 : 0);
  const ExitGuard guard;
  write_csv(path, table);
}

std::string markdown_table(const std::vector<ParetoPoint>& points, ParetoError error) {
  return markdown(table_of(points, error));
}

std::string pareto_notes(ParetoError error) {
  return "d: dimension; s: components that a step evaluates; step: median time of one. Equilibria: how far those under "
         "fresh "
         "loads are from the full object's, and how much of that is outside of the subspace and inside of it. " +
         std::string(
             error == ParetoError::Trajectory
                 ? "Trajectory: how far positions in the scene are from the full object's. Front: no other model is "
                   "at least as fast and as near in its trajectory."
                 : "Front: no other model is at least as fast and as near in its equilibria.");
}

bool draw_pareto_plot(const std::filesystem::path& path, const std::string& title,
                      const std::vector<ParetoPoint>& points, ParetoError error) {
  std::vector<std::string> kinds;
  std::vector<double> times, errors;
  const auto kind_of = [](const ParetoPoint& p) { return p.subspace.substr(0, p.subspace.find(':')); };
  for (const ParetoPoint& p : points) {
    if (!(p.step_seconds > 0) || !(error_of(p, error) > 0)) continue;
    times.push_back(1e6 * p.step_seconds);
    errors.push_back(100 * error_of(p, error));
    if (std::ranges::find(kinds, kind_of(p)) == kinds.end()) kinds.push_back(kind_of(p));
  }
  if (kinds.empty()) return false;
  Plot plot{
      .title = title,
      .x = around("time of a step [µs]", times),
      .y = around(error == ParetoError::Trajectory ? "error of the trajectory [%]" : "error of equilibria [%]", errors),
      .series = {}};
  for (const std::string& kind : kinds)
    plot.series.push_back(series_of(
        kind + ": d, s", points, error, [&](const ParetoPoint& p) { return kind_of(p) == kind; }, PlotStyle::Markers));
  plot.series.push_back(series_of(
      "front", points, error, [](const ParetoPoint& p) { return p.front; }, PlotStyle::DashedLine));
  const ExitGuard guard;
  draw_plot(path, plot);
  return true;
}

void write_pareto_page(const std::filesystem::path& path, const std::string& title, const std::string& description,
                       const std::vector<ParetoPoint>& points, ParetoError error, const std::filesystem::path& plot) {
  std::string body;
  if (!plot.empty())
    body += figure(embedded_png(read_file(plot), title),
                   "Error against the time of a step; beside each model its d and s.");
  body += html(table_of(points, error)) + "<p>" + escaped(pareto_notes(error)) + "</p>\n";
  const ExitGuard guard;
  write_file(path, page(title, description, body));
}

}  // namespace supple

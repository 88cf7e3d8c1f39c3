#include <app/report/exit_guard.hpp>
#include <app/report/page.hpp>
#include <app/report/selector_table.hpp>
#include <app/report/terminal.hpp>
#include <core/output_file.hpp>
#include <io/picture/plot.hpp>
#include <io/table/csv.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Spread spread(std::vector<double> values) {
  std::erase_if(values, [](double x) { return std::isnan(x); });
  if (values.empty()) return {nan, nan, nan};
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  return {median, values.front(), values.back()};
}

/// Names of the selectors in the order of their first run.
std::vector<std::string> selectors_of(const std::vector<SelectorRun>& runs) {
  std::vector<std::string> names;
  for (const SelectorRun& run : runs)
    if (std::find(names.begin(), names.end(), run.selector) == names.end()) names.push_back(run.selector);
  return names;
}

/// "1.23 (1.20–1.31)" for shares in percent, "–" for nothing.
std::string cell(const Spread& value, Index runs, double unit = 100) {
  if (std::isnan(value.median)) return "–";
  std::string text = shown(unit * value.median, 3);
  if (runs > 1) text += " (" + shown(unit * value.lowest, 3) + "–" + shown(unit * value.highest, 3) + ")";
  return text;
}

std::vector<std::string> heading(const std::vector<SelectorSummary>& summaries, const std::vector<PullScene>& scenes) {
  std::vector<std::string> names{"selector", "s", "training [%]"};
  if (!summaries.empty() && !summaries.front().held_out.empty())
    names.insert(names.end(), {"held-out [%]", "at 0.3 [%]", "at 0.1 [%]"});
  names.push_back("softest eigenvalue [%]");
  for (const PullScene& scene : scenes) names.push_back(scene.name + " [%]");
  names.insert(names.end(), {"selection [s]", "processor [s]", "force [µs]"});
  return names;
}

std::vector<std::string> cells(const SelectorSummary& summary) {
  std::vector<std::string> texts{summary.selector, std::to_string(summary.size), cell(summary.training, summary.runs)};
  for (const Spread& error : summary.held_out) texts.push_back(cell(error, summary.runs));
  texts.push_back(cell(summary.softest, summary.runs));
  for (const Spread& error : summary.trajectories) texts.push_back(cell(error, summary.runs));
  texts.push_back(cell(summary.seconds, summary.runs, 1));
  texts.push_back(cell(summary.processor_seconds, summary.runs, 1));
  texts.push_back(cell(summary.force_seconds, 1, 1e6));
  return texts;
}

/// A line for each selector through its sizes: medians of two quantities.
template <typename X, typename Y>
std::vector<PlotSeries> lines(const std::vector<SelectorRun>& runs, const X& x, const Y& y) {
  const std::vector<SelectorSummary> summaries = summarize(runs);
  std::vector<PlotSeries> series;
  for (const std::string& selector : selectors_of(runs)) {
    std::vector<std::pair<double, double>> points;
    for (const SelectorSummary& summary : summaries)
      if (summary.selector == selector) points.emplace_back(x(summary), y(summary));
    PlotSeries line{selector, Vector(points.size()), Vector(points.size()), PlotStyle::LinePoints};
    for (std::size_t k = 0; k < points.size(); ++k)
      std::tie(line.x[static_cast<Index>(k)], line.y[static_cast<Index>(k)]) = points[k];
    if (!line.y.array().isNaN().all()) series.push_back(std::move(line));
  }
  return series;
}

/// Error by iteration of the first seed at the size in the middle.
std::vector<PlotSeries> convergence(const std::vector<SelectorRun>& runs, Index size) {
  std::vector<PlotSeries> series;
  for (const std::string& selector : selectors_of(runs)) {
    const auto run = std::find_if(runs.begin(), runs.end(),
                                  [&](const SelectorRun& r) { return r.selector == selector && r.size == size; });
    if (run == runs.end() || run->report.history.size() < 2) continue;
    const auto count = static_cast<Index>(run->report.history.size());
    PlotSeries line{selector, Vector(count), Vector(count), PlotStyle::Line};
    for (Index k = 0; k < count; ++k) {
      line.x[k] = static_cast<double>(k + 1);
      line.y[k] = 100 * run->report.history[k].training_error;
    }
    if ((line.y.array() >= 0).count() > 1) series.push_back(std::move(line));
  }
  return series;
}

/// An axis that ends a little beyond the data, instead of at the next power of ten.
template <typename Values>
Axis fitted(Axis axis, const std::vector<PlotSeries>& series, const Values& values) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const PlotSeries& line : series)
    for (const double x : values(line))
      if (x > 0) low = std::min(low, x), high = std::max(high, x);
  if (low <= high) axis.low = low / 1.3, axis.high = high * 1.3;
  return axis;
}

TextTable table_of(const std::vector<SelectorSummary>& summaries, const std::vector<PullScene>& scenes) {
  TextTable table{heading(summaries, scenes), {}};
  for (const SelectorSummary& summary : summaries) table.rows.push_back(cells(summary));
  return table;
}

}  // namespace

std::vector<SelectorSummary> summarize(const std::vector<SelectorRun>& runs) {
  std::vector<SelectorSummary> summaries;
  std::vector<char> seen(runs.size(), 0);
  for (std::size_t first = 0; first < runs.size(); ++first) {
    if (seen[first]) continue;
    std::vector<const SelectorRun*> group;
    for (std::size_t k = first; k < runs.size(); ++k)
      if (runs[k].selector == runs[first].selector && runs[k].size == runs[first].size) {
        seen[k] = 1;
        group.push_back(&runs[k]);
      }
    const auto over = [&](const auto& value) {
      std::vector<double> values;
      for (const SelectorRun* run : group) values.push_back(value(*run));
      return spread(std::move(values));
    };
    SelectorSummary summary;
    summary.selector = runs[first].selector;
    summary.size = runs[first].size;
    summary.runs = static_cast<Index>(group.size());
    summary.training = over([](const SelectorRun& r) { return r.report.training_error; });
    summary.softest = over([](const SelectorRun& r) { return r.measure.softest_eigenvalue; });
    summary.seconds = over([](const SelectorRun& r) { return r.report.seconds; });
    summary.processor_seconds = over([](const SelectorRun& r) { return r.processor_seconds; });
    summary.force_seconds = over([](const SelectorRun& r) { return r.measure.force_seconds; });
    for (std::size_t k = 0; k < runs[first].measure.held_out.size(); ++k)
      summary.held_out.push_back(over([&](const SelectorRun& r) { return r.measure.held_out[k].second; }));
    for (std::size_t k = 0; k < runs[first].measure.trajectory_errors.size(); ++k)
      summary.trajectories.push_back(over([&](const SelectorRun& r) { return r.measure.trajectory_errors[k]; }));
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

Json runs_json(const std::vector<SelectorRun>& runs) {
  Json json = Json::array();
  for (const SelectorRun& run : runs) {
    Json held_out = Json::array();
    for (const auto& [share, error] : run.measure.held_out) held_out.push_back({{"share", share}, {"error", error}});
    json.push_back({{"selector", run.selector},
                    {"size", run.size},
                    {"seed", run.seed},
                    {"points", run.points},
                    {"status", to_string(run.report.status)},
                    {"stop_reason", run.report.stop_reason},
                    {"training_error", run.report.training_error},
                    {"kkt_residual", run.report.kkt_residual},
                    {"held_out", std::move(held_out)},
                    {"softest_eigenvalue", run.measure.softest_eigenvalue},
                    {"trajectory_errors", run.measure.trajectory_errors},
                    {"force_seconds", run.measure.force_seconds},
                    {"iterations", run.report.iterations},
                    {"columns_evaluated", run.report.columns_evaluated},
                    {"seconds", run.report.seconds},
                    {"processor_seconds", run.processor_seconds}});
  }
  return json;
}

void write_runs(const std::filesystem::path& path, const std::vector<SelectorRun>& runs,
                const std::vector<PullScene>& scenes) {
  std::vector<CsvTable::Column> columns{{"selector"}, {"size"}, {"seed"}, {"points"}, {"training_error"}};
  for (const auto& [share, error] : runs.front().measure.held_out)
    columns.push_back({"held_out_error_" + shown(share)});
  columns.push_back({"softest_eigenvalue"});
  for (const PullScene& scene : scenes) columns.push_back({"trajectory_error " + scene.name});
  columns.insert(columns.end(), {{"seconds", "s"},
                                 {"processor_seconds", "s"},
                                 {"force", "s"},
                                 {"iterations"},
                                 {"columns_evaluated"},
                                 {"status"}});
  CsvTable table(columns);
  for (const SelectorRun& run : runs) {
    std::vector<std::string> row{run.selector, std::to_string(run.size), std::to_string(run.seed),
                                 std::to_string(run.points), exact(run.report.training_error)};
    for (const auto& [share, error] : run.measure.held_out) row.push_back(exact(error));
    row.push_back(exact(run.measure.softest_eigenvalue));
    for (const double error : run.measure.trajectory_errors) row.push_back(exact(error));
    row.insert(row.end(), {exact(run.report.seconds), exact(run.processor_seconds), exact(run.measure.force_seconds),
                           std::to_string(run.report.iterations), std::to_string(run.report.columns_evaluated),
                           std::string(to_string(run.report.status))});
    table.add_cells(std::move(row));
  }
  const ExitGuard guard;
  write_csv(path, table);
}

std::string markdown_table(const std::vector<SelectorSummary>& summaries, const std::vector<PullScene>& scenes) {
  return markdown(table_of(summaries, scenes));
}

std::vector<std::pair<std::string, std::string>> draw_selector_plots(const std::filesystem::path& folder,
                                                                     std::vector<SelectorRun> runs,
                                                                     const std::vector<PullScene>& scenes) {
  std::vector<std::pair<std::string, std::string>> drawn;
  std::erase_if(runs, [](const SelectorRun& run) { return run.selector == "all"; });  // whose error is rounding
  if (runs.empty()) return drawn;
  const auto draw = [&](const std::string& name, const std::string& caption, Plot plot) {
    if (plot.series.empty()) return;
    plot.x = fitted(plot.x, plot.series, [](const PlotSeries& line) { return line.x; });
    plot.y = fitted(plot.y, plot.series, [](const PlotSeries& line) { return line.y; });
    const ExitGuard guard;
    draw_plot(folder / name, plot);
    drawn.emplace_back(name, caption);
  };
  const bool held_out = !runs.front().measure.held_out.empty();
  const auto size = [](const SelectorSummary& s) { return static_cast<double>(s.size); };
  const auto error = [&](const SelectorSummary& s) {
    return 100 * (held_out ? s.held_out.front().median : s.training.median);
  };
  const std::string measured = held_out ? "held-out force error [%]" : "training force error [%]";
  Axis sizes{.label = "components s", .scale = Scale::Log};
  for (const SelectorRun& run : runs) sizes.ticks.push_back(static_cast<double>(run.size));
  std::ranges::sort(sizes.ticks);
  sizes.ticks.erase(std::unique(sizes.ticks.begin(), sizes.ticks.end()), sizes.ticks.end());
  const Axis errors{.label = measured, .scale = Scale::Log};
  draw("error-size.svg", "Error against size: medians over seeds.",
       {.x = sizes, .y = errors, .series = lines(runs, size, error)});
  draw("error-time.svg", "Error against the time of selection, a point for each size.",
       {.x = {.label = "selection [s]", .scale = Scale::Log},
        .y = errors,
        .series = lines(
            runs, [](const SelectorSummary& s) { return s.seconds.median; }, error)});
  std::vector<Index> all;
  for (const SelectorRun& run : runs) all.push_back(run.size);
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  const Index middle = all[all.size() / 2];
  draw("convergence.svg",
       "Training error while selecting " + std::to_string(middle) +
           " components, first seed. Selectors without iterations on all rows are not shown.",
       {.x = {.label = "iteration", .scale = Scale::Log},
        .y = {.label = "training force error [%]", .scale = Scale::Log},
        .series = convergence(runs, middle)});
  for (std::size_t k = 0; k < scenes.size(); ++k)
    draw("trajectory-" + std::to_string(k + 1) + ".svg",
         "Deviation of the motion '" + scenes[k].name + "' from the same subspace with all components.",
         {.x = sizes,
          .y = {.label = "trajectory error [%]", .scale = Scale::Log},
          .series = lines(runs, size, [k](const SelectorSummary& s) { return 100 * s.trajectories[k].median; })});
  return drawn;
}

void write_selector_page(const std::filesystem::path& folder, const std::string& title, const std::string& description,
                         const std::vector<SelectorSummary>& summaries, const std::vector<PullScene>& scenes,
                         const std::vector<std::pair<std::string, std::string>>& plots) {
  std::string body;
  for (const auto& [name, caption] : plots) {
    const std::string drawing = read_file(folder / name);
    body += figure(drawing.substr(std::min(drawing.size(), drawing.find("<svg"))), caption);
  }
  body += html(table_of(summaries, scenes)) + "<p>" + escaped(selector_table_notes) + "</p>\n";
  const ExitGuard guard;
  write_file(folder / "index.html", page(title, description, body));
}

}  // namespace supple

#pragma once
/// \file Runs of selectors on one problem as tables, plots and a page.

#include <app/report/json_report.hpp>
#include <reduction/pipeline/selection_study.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

/// One selector, at one size, with one seed.
struct SelectorRun {
  std::string selector;
  Index size = 0;  ///< asked for
  std::uint64_t seed = 0;
  Index points = 0;              ///< used
  double processor_seconds = 0;  ///< of all threads while selecting
  SelectionReport report;
  SelectionMeasure measure;
};

/// Median and range over the seeds; of what is not NaN.
struct Spread {
  double median, lowest, highest;
};

/// The runs of one selector at one size.
struct SelectorSummary {
  std::string selector;
  Index size = 0, runs = 0;
  Spread training, softest, seconds, processor_seconds, force_seconds;
  std::vector<Spread> held_out;      ///< as in SelectionMeasure
  std::vector<Spread> trajectories;  ///< one for each scene
};

/// In the order of the runs.
std::vector<SelectorSummary> summarize(const std::vector<SelectorRun>& runs);

Json runs_json(const std::vector<SelectorRun>& runs);
/// A row for each run.
void write_runs(const std::filesystem::path& path, const std::vector<SelectorRun>& runs,
                const std::vector<PullScene>& scenes);
/// The table of medians, with the range over seeds in brackets, in Markdown.
std::string markdown_table(const std::vector<SelectorSummary>& summaries, const std::vector<PullScene>& scenes);

/// What the columns of the table mean.
inline constexpr std::string_view selector_table_notes =
    "Medians over seeds, the range in brackets. Errors of the force are relative: on the training poses (and "
    "equilibria), on held-out poses as large as the largest of those, and at 0.3 and 0.1 of their amplitude. The "
    "softest eigenvalue is that of the fitted stiffness at rest, relative to the exact one. Processor time is "
    "that of all threads. A dash: not measured, as a model with negative weights cannot be simulated.";

/// error-size.svg, error-time.svg, convergence.svg and, with scenes, trajectory-1.svg and so on in a folder; without
/// the selector "all", whose errors are rounding.
/// \return their names and captions, in order.
std::vector<std::pair<std::string, std::string>> draw_selector_plots(const std::filesystem::path& folder,
                                                                     std::vector<SelectorRun> runs,
                                                                     const std::vector<PullScene>& scenes);

/// One page with the plots, drawn into it, and the table.
void write_selector_page(const std::filesystem::path& folder, const std::string& title, const std::string& description,
                         const std::vector<SelectorSummary>& summaries, const std::vector<PullScene>& scenes,
                         const std::vector<std::pair<std::string, std::string>>& plots);

}  // namespace supple

#pragma once
/// \file Many runs of selectors on one problem, as tables, plots and a page.

#include <app/json_report.hpp>
#include <reduction/selection_study.hpp>

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

/// error-size.svg, error-time.svg, convergence.svg and, with scenes, trajectory-size.svg in a folder.
/// \return their names and captions, in order.
std::vector<std::pair<std::string, std::string>> draw_selector_plots(const std::filesystem::path& folder,
                                                                     const std::vector<SelectorRun>& runs,
                                                                     const std::vector<PullScene>& scenes);

/// One page with the plots, drawn into it, and the table.
void write_selector_page(const std::filesystem::path& folder, const std::string& title, const std::string& description,
                         const std::vector<SelectorSummary>& summaries, const std::vector<PullScene>& scenes,
                         const std::vector<std::pair<std::string, std::string>>& plots);

}  // namespace supple

#include <app/commands/option_checks.hpp>
#include <app/commands/select_command.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <core/check.hpp>
#include <core/parallel.hpp>
#include <core/peak_memory.hpp>
#include <core/stopwatch.hpp>
#include <core/version.hpp>
#include <io/table/matrix_file.hpp>
#include <io/text/index_file.hpp>
#include <io/text/json_fields.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <sparse/selection/selection_run.hpp>
#include <sparse/selection/smallest_selection.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace supple {

namespace {

Vector read_rhs(const std::filesystem::path& path, const Matrix& A, const std::filesystem::path& matrix) {
  if (path.empty()) return A.rowwise().sum();
  Vector b = read_vector(path);
  if (b.size() != A.rows())
    throw InputError(path.string() + ": has " + std::to_string(b.size()) + " numbers, expected " +
                     std::to_string(A.rows()) + ", one for each row of " + matrix.string());
  return b;
}

/// \throws InputError naming the file if squares of its numbers are none.
void require_units(const std::filesystem::path& path, MatrixIn numbers) {
  const double largest = numbers.size() > 0 ? numbers.cwiseAbs().maxCoeff() : 0;
  if (largest != 0) require_square_in_range(path.string() + ": the largest number", largest);
}

/// Rows that no selector sees.
struct HeldOut {
  Matrix A;
  Vector b;

  double error(const std::vector<Index>& indices, VectorIn weights) const {
    Vector r = b;
    for (Index k = 0; k < weights.size(); ++k) r -= weights[k] * A.col(indices[k]);
    return r.norm() / b.norm();
  }
};

std::optional<HeldOut> read_held_out(const SelectCommand& command, Index cols) {
  if (command.validate_matrix.empty()) return std::nullopt;
  if (!command.rhs.empty() && command.validate_rhs.empty())
    throw InputError("--validate-matrix needs --validate-rhs, as --matrix has --rhs");
  HeldOut rows{read_matrix(command.validate_matrix), {}};
  if (rows.A.cols() != cols)
    throw InputError(command.validate_matrix.string() + ": has " + std::to_string(rows.A.cols()) +
                     " columns, expected " + std::to_string(cols) + " as " + command.matrix.string());
  rows.b = read_rhs(command.validate_rhs, rows.A, command.validate_matrix);
  if (rows.b.norm() == 0)
    throw InputError(command.validate_matrix.string() + ": its right-hand side is zero, to which no error is relative");
  return rows;
}

/// Indices and weights of an earlier report.
Selection read_selection(const std::filesystem::path& path, Index cols) {
  const JsonFields report = JsonFields::read(path);
  Selection selection;
  selection.indices = report.integers("indices", between(0, static_cast<double>(cols - 1)));
  selection.weights = report.numbers("weights", selection.size());
  std::vector<Index> sorted = selection.indices;
  std::ranges::sort(sorted);
  if (const auto twice = std::ranges::adjacent_find(sorted); twice != sorted.end())
    report.fail("indices", "holds " + std::to_string(*twice) + " twice");
  return selection;
}

SelectionRequest selection_request(const SelectCommand& command, Index cols) {
  SelectionRequest request(SelectionRequest::unlimited);
  if (!command.candidates.empty()) request.candidates = read_indices(command.candidates, "column", cols);
  if (!command.must_keep.empty()) request.must_keep = read_indices(command.must_keep, "column", cols);
  if (!command.warm_start.empty()) request.warm_start = read_selection(command.warm_start, cols);
  if (command.target_error) request.target_error = *command.target_error;

  std::vector<Index> eligible;
  std::set_union(request.candidates.begin(), request.candidates.end(), request.must_keep.begin(),
                 request.must_keep.end(), std::back_inserter(eligible));
  const Index most = request.candidates.empty() ? cols : static_cast<Index>(eligible.size());
  if (command.points) request.size = std::min(*command.points, most);
  if (static_cast<Index>(request.must_keep.size()) > request.size)
    throw InputError(command.must_keep.string() + ": names " + std::to_string(request.must_keep.size()) +
                     " columns, expected at most --points " + std::to_string(*command.points));
  if (command.selector == "all") {
    if (request.size < most)
      throw InputError("--selector all takes all " + std::to_string(most) + " candidates, more than --points " +
                       std::to_string(*command.points));
    request.size = most;
  } else if (!command.points && !command.target_error) {
    throw InputError("how many columns? expected --points, --target-error or both");
  }
  return request;
}

Selection select(const SelectCommand& command, const AnyProblem& problem, const SelectionRequest& request) {
  const std::string groups =
      command.train_groups ? ":subset_groups=" + std::to_string(*command.train_groups) : std::string();
  const AnySelector select_once(command.selector + groups, command.seed);
  // without a size, each selector knows best how to look for one
  return command.target_error && command.points && command.selector != "all"
             ? smallest_selection(select_once, problem, request)
             : select_once(problem, request);
}

Json options_json(const SelectCommand& command, const SelectionRequest& request) {
  const auto file = [](const std::filesystem::path& path) { return path.empty() ? Json() : Json(path.string()); };
  return {{"points", command.points ? Json(*command.points) : Json()},
          {"target_error", request.target_error},
          {"candidates", file(command.candidates)},
          {"must_keep", file(command.must_keep)},
          {"warm_start", file(command.warm_start)},
          {"validate_matrix", file(command.validate_matrix)},
          {"validate_rhs", file(command.validate_rhs)},
          {"group_size", command.group_size},
          {"train_groups", command.train_groups ? Json(*command.train_groups) : Json()}};
}

Json report_json(const SelectCommand& command, const DenseProblem& problem, const SelectionRequest& request,
                 const Selection& selection, double held_out_error) {
  const SelectionReport& report = selection.report;
  return {{"command", "select"},
          {"version", SUPPLE_VERSION},
          {"matrix", command.matrix.string()},
          {"rhs", command.rhs.empty() ? Json() : Json(command.rhs.string())},
          {"rows", problem.rows()},
          {"columns", problem.cols()},
          {"selector", command.selector},
          {"seed", command.seed},
          {"points", selection.size()},
          {"indices", selection.indices},
          {"weights", json_numbers(selection.weights)},
          {"residual", report.residual},
          {"training_error", report.training_error},
          {"held_out_error", held_out_error},
          {"kkt_residual", report.kkt_residual},
          {"status", to_string(report.status)},
          {"stop_reason", report.stop_reason},
          {"iterations", report.iterations},
          {"columns_evaluated", report.columns_evaluated},
          {"history", json_history(report)},
          {"options", options_json(command, request)},
          {"threads", num_threads()}};
}

void print_summary(const SelectCommand& command, const DenseProblem& problem, const Selection& selection,
                   double held_out_error) {
  const SelectionReport& report = selection.report;
  const Vector& w = selection.weights;
  Rows rows{{"problem", shown_count(problem.rows()) + " rows, " + shown_count(problem.cols()) + " columns" +
                            (command.rhs.empty() ? ", b = A 1" : "")},
            {"selector", command.selector},
            {"selected", shown_count(selection.size()) + " columns"},
            {"training error", shown_percent(report.training_error)}};
  if (w.size() > 0)
    rows.emplace_back("weights", shown(w.minCoeff()) + " to " + shown(w.maxCoeff()) + ", sum " + shown(w.sum()));
  if (!command.validate_matrix.empty()) rows.emplace_back("held-out error", shown_percent(held_out_error));
  rows.insert(rows.end(), {{"residual", shown(report.residual)},
                           {"KKT residual", shown(report.kkt_residual)},
                           {"selection", shown_iterations(report.iterations) + ", " + report.stop_reason},
                           {"columns seen", shown_count(report.columns_evaluated)},
                           {"peak memory", shown_bytes(peak_resident_memory())}});
  print_rows(stdout, "selection from " + command.matrix.string(), rows);
}

}  // namespace

void SelectCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  if (train_groups && Choice::parse(selector).name != "greedy")
    throw InputError("--train-groups is for --selector greedy, not for " + selector);
  const Stopwatch total;
  Matrix A = read_matrix(matrix);
  Vector b = read_rhs(rhs, A, matrix);
  if (A.rows() % group_size != 0)
    throw InputError(matrix.string() + ": has " + std::to_string(A.rows()) +
                     " rows, expected a multiple of --group-size " + std::to_string(group_size));
  require_units(matrix, A);
  require_units(rhs.empty() ? matrix : rhs, b);
  const std::optional<HeldOut> held_out = read_held_out(*this, A.cols());
  SelectionRequest request = selection_request(*this, A.cols());
  const DenseProblem problem(std::move(A), std::move(b), group_size);
  const double read_seconds = total.seconds();

  request.progress = progress_bar();
  if (held_out)
    request.validate = [&](const std::vector<Index>& indices, VectorIn weights) {
      return held_out->error(indices, weights);
    };
  const Selection selection = select(*this, AnyProblem(problem), request);
  clear_progress();
  const SelectionReport& report = selection.report;
  if (!std::isfinite(report.residual) || !selection.weights.allFinite())
    throw SolverError("the selector " + selector + " found no finite weights");
  if (target_error && report.training_error > *target_error)
    warn("the training error is " + shown_percent(report.training_error) + ", not " + shown_percent(*target_error) +
         (points && *points < problem.cols() ? ": allow more --points than " + std::to_string(*points) : ""));

  const double held_out_error =
      held_out ? held_out->error(selection.indices, selection.weights) : std::numeric_limits<double>::quiet_NaN();
  Json json_report = report_json(*this, problem, request, selection, held_out_error);
  json_report["seconds"] = report.seconds;
  json_report["read_seconds"] = read_seconds;
  json_report["total_seconds"] = total.seconds();
  json_report["peak_memory"] = peak_resident_memory();
  if (!is_stdout(json)) {
    print_summary(*this, problem, selection, held_out_error);
    print_stages(stdout, {{"read", read_seconds}, {"selection", report.seconds}}, total.seconds());
  }
  write_json(json, json_report);
}

namespace {

void declare_matrices(CLI::App& command, SelectCommand& c) {
  const auto problem = "Problem";
  command.add_option("--matrix", c.matrix, "A: NumPy .npy or Matrix Market .mtx")
      ->required()
      ->type_name("FILE")
      ->group(problem);
  command.add_option("--rhs", c.rhs, "b, likewise; without: b = A 1, the sum of all columns, as cubature fits it")
      ->type_name("FILE")
      ->group(problem);
  CLI::Option& held_out =
      *command.add_option("--validate-matrix", c.validate_matrix, "Held-out rows of A, to measure the error on")
           ->type_name("FILE")
           ->group(problem);
  command.add_option("--validate-rhs", c.validate_rhs, "Their b; without: their A 1, if there is no --rhs")
      ->needs(&held_out)
      ->type_name("FILE")
      ->group(problem);
  command
      .add_option("--group-size", c.group_size,
                  "Rows of a training pose, for --train-groups: they stand or fall together")
      ->capture_default_str()
      ->type_name("N")
      ->check(whole_number())
      ->group(problem);
}

void declare_choice(CLI::App& command, SelectCommand& c) {
  command.add_option("--points", c.points, "Largest number of columns; may be left out with --target-error")
      ->type_name("S")
      ->check(whole_number())
      ->group(method_group);
  command.add_option("--target-error", c.target_error, "Take as few columns as reach |A w - b| / |b| <= SHARE")
      ->type_name("SHARE")
      ->check(positive_number())
      ->group(method_group);
  c.selector = known_selectors().front();  // the default that the help shows
  command.add_option("--selector", c.selector, "How they are chosen; htp and niht give weights of any sign")
      ->capture_default_str()
      ->type_name("NAME[:OPTION=VALUE...]")
      ->check(known_in(selectors()))
      ->group(method_group);
  command
      .add_option("--candidates", c.candidates,
                  "Columns that may be chosen beside --must-keep, one index a line, from 0 [all]")
      ->type_name("FILE")
      ->group(method_group);
  command.add_option("--must-keep", c.must_keep, "Columns that are in the answer, if need be with weight 0")
      ->type_name("FILE")
      ->group(method_group);
  command.add_option("--warm-start", c.warm_start, "Earlier report to improve: its indices and positive weights")
      ->type_name("FILE.json")
      ->group(method_group);
  command
      .add_option("--train-groups", c.train_groups,
                  "Groups of --group-size rows that 'greedy' compares columns on, anew in each step [all]")
      ->type_name("N")
      ->check(whole_number())
      ->group(method_group);
  declare_seed(command, c.seed);
}

}  // namespace

void SelectCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("select", "Choose few columns of a matrix A, with weights w: A w ~ b");
  declare_matrices(command, *this);
  declare_choice(command, *this);
  declare_json(command, json);
  declare_plugins(command);
  declare_threads(command, threads);
  command.footer([] {
    return "The indices and weights are in the report of --json. Weights are not negative, but for htp and niht.\n\n" +
           selector_help() +
           "\nExamples:\n"
           "supple select --matrix A.npy --rhs b.npy --points 200 --json -\n"
           "supple select --matrix A.mtx --target-error 0.01 --json selection.json";
  });
  command.callback([this] { run(); });
}

}  // namespace supple

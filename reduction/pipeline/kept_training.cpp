#include <reduction/pipeline/kept_training.hpp>

namespace supple {

void store(TensorFileWriter& file, const FullStates& states) {
  file.add("Q", states.Q);
  file.add("forces", states.forces);
  file.add("energies", states.energies);
  file.add("sizes", states.sizes);
  file.add("outside", states.outside);
  file.add("remainders", states.remainders);
  file.add("residuals", states.residuals);
}

void restore(const TensorFile& file, FullStates& states) {
  states = {.Q = file.matrix("Q"),
            .forces = file.matrix("forces"),
            .energies = file.vector("energies"),
            .sizes = file.vector("sizes"),
            .outside = file.vector("outside"),
            .remainders = file.matrix("remainders"),
            .residuals = file.vector("residuals")};
}

void store(TensorFileWriter& file, const SelectedComponents& selected) {
  const Selection& selection = selected.selection;
  const SelectionReport& report = selection.report;
  file.add("indices", std::vector<std::int64_t>(selection.indices.begin(), selection.indices.end()));
  file.add("weights", selection.weights);
  file.add("counts", std::vector<std::int64_t>{selected.too_weak, static_cast<std::int64_t>(report.status),
                                               report.iterations, report.columns_evaluated});
  file.add("numbers", std::vector<double>{report.residual, report.training_error, report.kkt_residual, report.seconds});
  file.metadata["stop_reason"] = report.stop_reason;
  RowMatrix history(static_cast<Index>(report.history.size()), 5);
  for (Index k = 0; k < history.rows(); ++k) {
    const SelectionStep& step = report.history[k];
    history.row(k) << static_cast<double>(step.size), step.training_error, step.held_out_error, step.seconds,
        static_cast<double>(step.columns_evaluated);
  }
  file.add("history", history);
}

void restore(const TensorFile& file, SelectedComponents& selected) {
  const auto counts = file.values<std::int64_t>("counts", {4});
  const auto numbers = file.values<double>("numbers", {4});
  const auto indices = file.integers("indices");
  selected = {};
  selected.too_weak = counts[0];
  selected.selection.indices.assign(indices.begin(), indices.end());
  selected.selection.weights = file.vector("weights", static_cast<Index>(indices.size()));
  SelectionReport& report = selected.selection.report;
  report.status = static_cast<Status>(counts[1]);
  report.iterations = counts[2];
  report.columns_evaluated = counts[3];
  report.residual = numbers[0];
  report.training_error = numbers[1];
  report.kkt_residual = numbers[2];
  report.seconds = numbers[3];
  report.stop_reason = file.metadata("stop_reason");
  const auto history = file.matrix("history", TensorFile::any, 5);
  for (Index k = 0; k < history.rows(); ++k)
    report.history.push_back({.size = static_cast<Index>(history(k, 0)),
                              .training_error = history(k, 1),
                              .held_out_error = history(k, 2),
                              .seconds = history(k, 3),
                              .columns_evaluated = static_cast<Index>(history(k, 4))});
}

}  // namespace supple

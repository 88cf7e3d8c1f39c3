#include <reduction/basis/kept_modes.hpp>

namespace supple {

void store(TensorFileWriter& file, const EigenPairs& pairs) {
  file.add("omega_squared", pairs.omega_squared);
  file.add("vectors", pairs.vectors);
  file.add("residuals", pairs.residuals);
  file.add("counts", std::vector<std::int64_t>{static_cast<std::int64_t>(pairs.report.status), pairs.report.iterations,
                                               pairs.missed, pairs.extra_zero_modes});
  file.add("numbers", std::vector<double>{pairs.report.residual, pairs.rigid_residual, pairs.shift});
}

void restore(const TensorFile& file, EigenPairs& pairs) {
  const auto counts = file.values<std::int64_t>("counts", {4});
  const auto numbers = file.values<double>("numbers", {3});
  pairs = {.omega_squared = file.vector("omega_squared"),
           .vectors = file.matrix("vectors"),
           .residuals = file.vector("residuals"),
           .report = {static_cast<Status>(counts[0]), counts[1], numbers[0]},
           .missed = counts[2],
           .extra_zero_modes = counts[3],
           .rigid_residual = numbers[1],
           .shift = numbers[2]};
}

void store(TensorFileWriter& file, const DenseBasis& basis) {
  const SubspaceReport& report = basis.report;
  file.add("W", basis.W);
  file.add("omega", report.omega);
  file.add("residuals", report.residuals);
  file.add("singular_values", report.singular_values);
  file.add("counts", std::vector<std::int64_t>{report.rigid_modes, report.zero_modes, report.dropped});
  for (std::size_t k = 0; k < report.notes.size(); ++k) file.metadata["note." + std::to_string(k)] = report.notes[k];
}

void restore(const TensorFile& file, DenseBasis& basis) {
  const auto counts = file.values<std::int64_t>("counts", {3});
  basis.W = file.matrix("W");
  basis.report = {.omega = file.vector("omega"),
                  .residuals = file.vector("residuals"),
                  .rigid_modes = counts[0],
                  .zero_modes = counts[1],
                  .dropped = counts[2],
                  .notes = {},
                  .singular_values = file.vector("singular_values")};
  for (std::string key = "note.0"; file.metadata().contains(key);
       key = "note." + std::to_string(basis.report.notes.size()))
    basis.report.notes.push_back(file.metadata(key));
}

}  // namespace supple

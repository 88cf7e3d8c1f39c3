#include <reduction/model/with_reduced_system.hpp>
#include <reduction/system/error_estimator.hpp>

namespace supple {

AnySystem<Matrix> ReducedModel::system(RowPrecision precision) const {
  return visit_reduced_system(
      *this, [](const auto& system) { return AnySystem<Matrix>(system); }, precision);
}

std::optional<ErrorEstimator> error_estimator(const ReducedModel& model) {
  if (!model.indicator) return std::nullopt;
  const ReducedModes modes = reduced_modes(model);
  return with_force_model(model.body,
                          [&](const auto& force) { return ErrorEstimator(force, *model.indicator, modes); });
}

}  // namespace supple

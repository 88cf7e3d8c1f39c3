#include <reduction/pipeline/with_reduced_system.hpp>
#include <reduction/system/reduced_modes.hpp>

namespace supple {

AnySystem<Matrix> ReducedModel::system(RowPrecision precision) const {
  return visit_reduced_system(
      *this, [](const auto& system) { return AnySystem<Matrix>(system); }, precision);
}

ReducedModes reduced_modes(const ReducedModel& model) {
  return std::visit(
      [&](const auto& basis) { return reduced_modes(model.rest_stiffness, basis->report.known_zero_modes()); },
      model.subspace);
}

}  // namespace supple

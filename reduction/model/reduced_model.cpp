#include <reduction/model/reduced_model.hpp>
#include <reduction/system/reduced_modes.hpp>

namespace supple {

RowPrecision default_precision(const ReducedModel& model) {
  return std::holds_alternative<std::shared_ptr<const DenseBasis>>(model.subspace) ? RowPrecision::Single
                                                                                   : RowPrecision::Double;
}

ReducedModes reduced_modes(const ReducedModel& model) {
  return std::visit(
      [&](const auto& basis) { return reduced_modes(model.rest_stiffness, basis->report.known_zero_modes()); },
      model.subspace);
}

}  // namespace supple

#include <reduction/model/with_reduced_system.hpp>

namespace supple {

AnySystem<Matrix> ReducedModel::system(RowPrecision precision) const {
  return visit_reduced_system(
      *this, [](const auto& system) { return AnySystem<Matrix>(system); }, precision);
}

}  // namespace supple

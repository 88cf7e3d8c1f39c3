#pragma once
/// \file Reduced system of a model, of its own type.

#include <physics/body/force_models.hpp>
#include <reduction/model/reduced_model.hpp>
#include <reduction/system/reduced_system.hpp>

namespace supple {

/// Calls visit(system) with a shared pointer to the ReducedSystem of the model, one of six types.
template <typename Visitor>
decltype(auto) visit_reduced_system(const ReducedModel& model, Visitor&& visit,
                                    RowPrecision precision = RowPrecision::Double) {
  return with_force_model(model.body, [&]<typename Model>(const std::shared_ptr<const Model>& force) -> decltype(auto) {
    return std::visit(
        [&]<typename S>(const std::shared_ptr<const S>& subspace) -> decltype(auto) {
          return visit(std::make_shared<const ReducedSystem<Model, S>>(
              force, subspace, model.indices, model.weights, model.rest_stiffness, nodal_mass(model.body), precision));
        },
        model.subspace);
  });
}

/// Calls visit(system) with the ReducedSystem of the model; the system lives during the call.
template <typename Visitor>
decltype(auto) with_reduced_system(const ReducedModel& model, Visitor&& visit,
                                   RowPrecision precision = RowPrecision::Double) {
  return visit_reduced_system(
      model, [&](const auto& system) -> decltype(auto) { return visit(*system); }, precision);
}

}  // namespace supple

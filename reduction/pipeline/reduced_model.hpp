#pragma once
/// \file A reduced model as data: what `reduce` makes, files keep, and simulations load.

#include <physics/body/body.hpp>
#include <physics/body/force_models.hpp>
#include <reduction/system/reduced_system.hpp>

#include <filesystem>
#include <map>
#include <memory>
#include <variant>

namespace supple {

struct ReducedModel {
  Body body;
  std::variant<std::shared_ptr<const NodalBasis>, std::shared_ptr<const DenseBasis>> subspace;
  std::string subspace_name = "extended";  ///< see SubspaceChoice
  std::vector<Index> indices;              ///< selected components of its force model, ascending
  Vector weights;                          ///< of the selected components, > 0
  Matrix rest_stiffness;                   ///< UᵀK(0)U, exact, d × d
  /// How it was made: options, seed, version, errors. Free text; the file keeps it.
  std::map<std::string, std::string> provenance;

  Index dim() const {
    return std::visit([](const auto& basis) { return basis->dim(); }, subspace);
  }
  const Vector& omega() const {  ///< of the modes it was made from [rad/s]
    return std::visit([](const auto& basis) -> const Vector& { return basis->report.omega; }, subspace);
  }
};

/// Vibration modes of a model, of its exact stiffness at rest.
ReducedModes reduced_modes(const ReducedModel& model);

/// Calls visit(system) with the ReducedSystem of the model; the system lives during the call.
template <typename Visitor>
decltype(auto) with_reduced_system(const ReducedModel& model, Visitor&& visit,
                                   RowPrecision precision = RowPrecision::Double) {
  return with_force_model(model.body, [&]<typename Model>(const std::shared_ptr<const Model>& force) -> decltype(auto) {
    return std::visit(
        [&]<typename S>(const std::shared_ptr<const S>& subspace) -> decltype(auto) {
          const ReducedSystem<Model, S> system(force, subspace, model.indices, model.weights, model.rest_stiffness,
                                               nodal_mass(model.body), precision);
          return visit(system);
        },
        model.subspace);
  });
}

/// Writes one file in the safetensors layout (see core/tensor_file.hpp), in one step; docs/model-file.md
/// lists its arrays.
void save_model(const std::filesystem::path& path, const ReducedModel& model);

/// \throws InputError naming the file and what is wrong with it: not a model, another version, damaged,
/// inconsistent.
ReducedModel load_model(const std::filesystem::path& path);

}  // namespace supple

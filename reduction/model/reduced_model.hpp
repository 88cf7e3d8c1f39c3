#pragma once
/// \file Reduced model as data: what `reduce` makes, files keep, and simulations load.

#include <physics/body/body.hpp>
#include <physics/system/any_system.hpp>
#include <reduction/model/reduced_forces.hpp>
#include <reduction/subspace/subspace.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/system/row_precision.hpp>

#include <filesystem>
#include <map>
#include <string>

namespace supple {

/// An object and the selection that stands for it.
struct ReducedModel : ReducedForces<AnyBasis> {
  Body body;
  std::string subspace_name = "extended";  ///< see SubspaceChoice
  /// How it was made: options, seed, version, errors. Free text; the file keeps it.
  std::map<std::string, std::string> provenance;

  Index dim() const {
    return std::visit([](const auto& basis) { return basis->dim(); }, subspace);
  }
  const Vector& omega() const {  ///< of the modes it was made from [rad/s]
    return std::visit([](const auto& basis) -> const Vector& { return basis->report.omega; }, subspace);
  }

  /// What integrators and static solvers run: a value, which shares the basis with the model and no longer needs it. For
  /// the system's own type, see with_reduced_system.
  AnySystem<Matrix> system(RowPrecision precision = RowPrecision::Double) const;
};

/// How simulations of a model keep rows: in single precision where the basis is dense, whose rows are too many for the
/// caches near a core.
RowPrecision default_precision(const ReducedModel& model);

/// Vibration modes of a model, of its exact stiffness at rest.
ReducedModes reduced_modes(const ReducedModel& model);

class ErrorEstimator;
/// What estimates the error of its states, by its indicator; none if it has none. Include
/// reduction/system/error_estimator.hpp to use it.
std::optional<ErrorEstimator> error_estimator(const ReducedModel& model);

/// Writes one file in the safetensors layout (see core/tensor_file.hpp), in one step; docs/model-file.md
/// lists its arrays.
void save_model(const std::filesystem::path& path, const ReducedModel& model);

/// \throws InputError naming the file and what is wrong with it: not a model, another version, damaged,
/// inconsistent.
ReducedModel load_model(const std::filesystem::path& path);

}  // namespace supple

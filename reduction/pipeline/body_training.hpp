#pragma once
/// \file Types of a body's force model and of a subspace by name, for what is generic in both.

#include <physics/body/force_models.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/training.hpp>

#include <memory>

namespace supple {

/// Calls visit(system, subspace) with the full system of the body and the subspace that the options name.
template <typename Visitor>
void with_object(const Body& body, const ReduceOptions& options, StageClock& stage, Visitor&& visit) {
  with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    const auto system = stage("full system", [&](auto) {
      return std::make_shared<const FullSystem<Model>>(model, nodal_mass(body), fixed_nodes(body), held_axes(body));
    });
    const SubspaceRun run{
        stage.progress(),
        [&](const std::string& name, const SubspaceRun::Work& work) { stage(name, [&](auto) { work(); }); },
        options.checkpoint};
    std::visit([&](const auto& subspace) { visit(system, subspace); },
               build_subspace(system->rest_state(), options.subspace_choice(), run));
  });
}

}  // namespace supple

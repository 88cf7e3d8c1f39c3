#include <physics/body/body_system.hpp>
#include <physics/body/force_models.hpp>
#include <physics/system/full_system.hpp>

namespace supple {

AnySystem<SparseMatrix> full_system(const Body& body) {
  return with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    return AnySystem<SparseMatrix>(
        std::make_shared<const FullSystem<Model>>(model, nodal_mass(body), fixed_nodes(body), held_axes(body)));
  });
}

}  // namespace supple

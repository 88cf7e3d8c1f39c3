#pragma once
/// \file Force model on some of the nodes of a larger object.

#include <core/check.hpp>
#include <physics/model/term_pack.hpp>

#include <array>
#include <vector>

namespace supple {

/// A model whose node k is node nodes[k] of an object with more nodes: the skin of a solid, the spring between two
/// bodies. Its terms are the model's own, at their speed. To be summed with others in a CompositeModel.
template <ForceModel Model>
class EmbeddedModel {
 public:
  static constexpr int stencil_size = Model::stencil_size;
  static constexpr int node_dim = Model::node_dim;
  static constexpr int local_dofs = Model::local_dofs;
  static constexpr bool translation_invariant = is_translation_invariant<Model>();
  static constexpr bool symmetric_tangent = has_symmetric_tangent<Model>();

  /// \throws std::invalid_argument unless there is a node of the object for each of the model, each once.
  EmbeddedModel(Model model, const std::vector<Index>& nodes, Index num_nodes)
      : model_(std::move(model)), num_nodes_(num_nodes), stencils_(model_.num_components()) {
    require_size("nodes", static_cast<Index>(nodes.size()), model_.num_nodes());
    std::vector<char> taken(num_nodes, false);
    for (const Index v : nodes) {
      require(v >= 0 && v < num_nodes && !taken[v],
              "node " + std::to_string(v) + " is named twice or is not in 0 to " + std::to_string(num_nodes - 1));
      taken[v] = true;
    }
    for (Index i = 0; i < model_.num_components(); ++i)
      for (int a = 0; a < stencil_size; ++a) stencils_[i][a] = nodes[model_.stencil(i)[a]];
  }

  const Model& model() const { return model_; }
  Index num_nodes() const { return num_nodes_; }
  Index num_components() const { return model_.num_components(); }
  std::span<const Index, stencil_size> stencil(Index i) const { return stencils_[i]; }
  double energy(Index i, const Local<local_dofs>& u_i) const requires PotentialModel<Model> {
    return model_.energy(i, u_i);
  }
  Local<local_dofs> force(Index i, const Local<local_dofs>& u_i) const { return model_.force(i, u_i); }
  LocalMatrix<local_dofs> stiffness(Index i, const Local<local_dofs>& u_i) const { return model_.stiffness(i, u_i); }

 private:
  Model model_;
  Index num_nodes_;
  std::vector<std::array<Index, stencil_size>> stencils_;
};

/// The pack of the model itself.
template <typename Model>
class TermPack<EmbeddedModel<Model>> : public TermPack<Model> {
 public:
  template <typename Components>
  TermPack(const std::shared_ptr<const EmbeddedModel<Model>>& embedded, const Components& components)
      : TermPack<Model>(std::shared_ptr<const Model>(embedded, &embedded->model()), components) {}
};

}  // namespace supple

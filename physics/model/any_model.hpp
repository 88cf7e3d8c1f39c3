#pragma once
/// \file Force models whose type is known only at run time.

#include <core/check.hpp>
#include <physics/model/term_pack.hpp>

#include <concepts>
#include <memory>
#include <span>
#include <utility>

namespace supple {

/// Any translation invariant force model, with a potential, of terms on `nodes` nodes, behind one type: what commands, files and plug-ins
/// hand around, so that what is built on it is compiled once. Evaluation costs a call through a pointer for eight
/// components. Copies share the model.
template <int nodes, int dim = 3>
class AnyModel {
 public:
  static constexpr int stencil_size = nodes;
  static constexpr int node_dim = dim;
  static constexpr int local_dofs = nodes * dim;
  static constexpr bool translation_invariant = true;
  using Displacements = Local<local_dofs, Pack>;
  using Tangent = LocalMatrix<local_dofs, Pack>;

  /// Eight components, or one in eight states. Packs go by reference: as arguments they would be passed differently by
  /// code compiled for other instruction sets.
  class Terms {
   public:
    virtual ~Terms() = default;
    virtual void energy(const Displacements& u, Pack& e) const = 0;
    virtual void force(const Displacements& u, Displacements& f) const = 0;
    virtual void stiffness(const Displacements& u, Tangent& K) const = 0;
    virtual void jacobian(const Displacements& u, Pack& J) const = 0;
  };
  /// What a model of a certain type answers.
  class Interface {
   public:
    virtual ~Interface() = default;
    virtual Index num_nodes() const = 0;
    virtual Index num_components() const = 0;
    virtual const Index* stencil(Index i) const = 0;
    virtual const Points* rest_positions() const = 0;  ///< none: null
    virtual bool has_jacobian() const = 0;
    virtual double energy(Index i, const Local<local_dofs>& u) const = 0;
    virtual void force(Index i, const Local<local_dofs>& u, Local<local_dofs>& f) const = 0;
    virtual void stiffness(Index i, const Local<local_dofs>& u, LocalMatrix<local_dofs>& K) const = 0;
    virtual std::unique_ptr<const Terms> pack(const PackIndices& components) const = 0;
    /// visit(terms) with component i in every lane, without memory of its own.
    virtual void with_terms(Index i, void (*visit)(const Terms&, void*), void* state) const = 0;
  };

  template <PotentialModel Model>
  requires(Model::stencil_size == nodes && Model::node_dim == dim &&
           is_translation_invariant<Model>()) explicit AnyModel(std::shared_ptr<const Model> model)
      : model_(std::make_shared<const Of<Model>>(std::move(model))) {}

  Index num_nodes() const { return model_->num_nodes(); }
  Index num_components() const { return model_->num_components(); }
  std::span<const Index, nodes> stencil(Index i) const {
    return std::span<const Index, nodes>(model_->stencil(i), nodes);
  }
  /// n × 3 [m]. \throws std::invalid_argument if the model does not know them.
  const Points& rest_positions() const {
    require(model_->rest_positions(), "the force model has no rest positions");
    return *model_->rest_positions();
  }
  /// Whether its terms can be inverted, that is have a volume.
  bool has_jacobian() const { return model_->has_jacobian(); }

  double energy(Index i, const Local<local_dofs>& u_i) const { return model_->energy(i, u_i); }
  Local<local_dofs> force(Index i, const Local<local_dofs>& u_i) const {
    Local<local_dofs> f;
    model_->force(i, u_i, f);
    return f;
  }
  LocalMatrix<local_dofs> stiffness(Index i, const Local<local_dofs>& u_i) const {
    LocalMatrix<local_dofs> K;
    model_->stiffness(i, u_i, K);
    return K;
  }

  const Interface& interface() const { return *model_; }

 private:
  template <typename Model>
  class Of;
  template <typename Model>
  class TermsOf;

  std::shared_ptr<const Interface> model_;
};

template <int nodes, int dim>
template <typename Model>
class AnyModel<nodes, dim>::TermsOf final : public Terms {
 public:
  template <typename Components>
  TermsOf(const std::shared_ptr<const Model>& model, const Components& components) : terms_(model, components) {}

  void energy(const Displacements& u, Pack& e) const override { e = terms_.energy(u); }
  void force(const Displacements& u, Displacements& f) const override { f = terms_.force(u); }
  void stiffness(const Displacements& u, Tangent& K) const override { K = terms_.stiffness(u); }
  void jacobian(const Displacements& u, Pack& J) const override {
    if constexpr (requires { terms_.jacobian(u); })
      J = terms_.jacobian(u);
    else
      J = Pack(1.0);
  }

 private:
  TermPack<Model> terms_;
};

template <int nodes, int dim>
template <typename Model>
class AnyModel<nodes, dim>::Of final : public Interface {
 public:
  explicit Of(std::shared_ptr<const Model> model) : model_(std::move(model)) {}

  Index num_nodes() const override { return model_->num_nodes(); }
  Index num_components() const override { return model_->num_components(); }
  const Index* stencil(Index i) const override { return std::span<const Index, nodes>(model_->stencil(i)).data(); }
  const Points* rest_positions() const override {
    if constexpr (requires {
                    { model_->rest_positions() } -> std::same_as<const Points&>;
                  })
      return &model_->rest_positions();
    else
      return nullptr;
  }
  bool has_jacobian() const override {
    return requires(const TermPack<Model>& terms, const Displacements& u) {
      terms.jacobian(u);
    };
  }

  double energy(Index i, const Local<local_dofs>& u) const override { return model_->energy(i, u); }
  void force(Index i, const Local<local_dofs>& u, Local<local_dofs>& f) const override { f = model_->force(i, u); }
  void stiffness(Index i, const Local<local_dofs>& u, LocalMatrix<local_dofs>& K) const override {
    K = model_->stiffness(i, u);
  }
  std::unique_ptr<const Terms> pack(const PackIndices& components) const override {
    return std::make_unique<const TermsOf<Model>>(model_, components);
  }
  void with_terms(Index i, void (*visit)(const Terms&, void*), void* state) const override {
    visit(TermsOf<Model>(model_, i), state);
  }

 private:
  std::shared_ptr<const Model> model_;
};

/// Eight components of a model of any type, or one component in eight states. The latter refers to the model.
template <int nodes, int dim>
class TermPack<AnyModel<nodes, dim>> {
  using Model = AnyModel<nodes, dim>;
  using Terms = typename Model::Terms;

 public:
  using Displacements = typename Model::Displacements;

  TermPack(const std::shared_ptr<const Model>& model, const PackIndices& components)
      : terms_(model->interface().pack(components)) {}
  TermPack(const std::shared_ptr<const Model>& model, Index component)
      : model_(&model->interface()), component_(component) {}

  Pack energy(const Displacements& u) const {
    Pack e;
    visit([&](const Terms& terms) { terms.energy(u, e); });
    return e;
  }
  Displacements force(const Displacements& u) const {
    Displacements f;
    visit([&](const Terms& terms) { terms.force(u, f); });
    return f;
  }
  LocalMatrix<Model::local_dofs, Pack> stiffness(const Displacements& u) const {
    typename Model::Tangent K;
    visit([&](const Terms& terms) { terms.stiffness(u, K); });
    return K;
  }
  Pack jacobian(const Displacements& u) const {
    Pack J;
    visit([&](const Terms& terms) { terms.jacobian(u, J); });
    return J;
  }

 private:
  template <typename Visitor>
  void visit(Visitor visitor) const {
    if (terms_)
      visitor(*terms_);
    else
      model_->with_terms(
          component_, [](const Terms& terms, void* state) { (*static_cast<Visitor*>(state))(terms); }, &visitor);
  }

  std::shared_ptr<const Terms> terms_;
  const typename Model::Interface* model_ = nullptr;  // where there is one component
  Index component_ = 0;
};

}  // namespace supple

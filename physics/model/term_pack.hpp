#pragma once
/// \file Pack of eight terms of a force model, evaluated lane by lane.

#include <core/pack.hpp>
#include <physics/model/force_model.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <type_traits>

namespace supple {

/// A force model whose terms are small aggregates of numbers, `Term<Real>`, with formulas written over Real.
/// It is evaluated in packs: across components at run time, across poses when training. Models without Term
/// work, too, one component at a time.
template <typename F>
concept PackableForceModel = ForceModel<F> &&
    requires(const F& model, Index i, const typename F::template Term<Pack>& term,
             const Local<F::local_dofs, Pack>& u_i) {
  { model.term(i) } -> std::convertible_to<typename F::template Term<double>>;
  { term.force(u_i) } -> std::convertible_to<Local<F::local_dofs, Pack>>;
  { term.stiffness(u_i) } -> std::convertible_to<LocalMatrix<F::local_dofs, Pack>>;
  requires !PotentialModel<F> || requires {
    { term.energy(u_i) } -> std::convertible_to<Pack>;
  };
};

using PackIndices = std::array<Index, Pack::size>;

/// The components first … first + 7 of `count`; lanes past the end repeat the last one.
inline PackIndices consecutive_components(Index first, Index count) {
  PackIndices lanes;
  for (int k = 0; k < Pack::size; ++k) lanes[k] = std::min(first + k, count - 1);
  return lanes;
}

/// One component, for eight states of it.
inline PackIndices one_component(Index component) {
  PackIndices lanes;
  lanes.fill(component);
  return lanes;
}

/// Eight components of a model, ready to be evaluated together; or one component in eight states.
template <ForceModel F>
class TermPack {
 public:
  using Displacements = Local<F::local_dofs, Pack>;

  /// The same component in every lane.
  TermPack(std::shared_ptr<const F> model, Index component) : TermPack(std::move(model), one_component(component)) {}

  TermPack(std::shared_ptr<const F> model, const PackIndices& components)
      : model_(std::move(model)), components_(components) {}

  Pack energy(const Displacements& u) const requires PotentialModel<F> {
    Pack result;
    for (int k = 0; k < Pack::size; ++k) result.set(k, model_->energy(components_[k], lane(u, k)));
    return result;
  }
  Displacements force(const Displacements& u) const {
    Displacements result;
    for (int k = 0; k < Pack::size; ++k) {
      const Local<F::local_dofs> f = model_->force(components_[k], lane(u, k));
      for (int i = 0; i < F::local_dofs; ++i) result[i].set(k, f[i]);
    }
    return result;
  }
  LocalMatrix<F::local_dofs, Pack> stiffness(const Displacements& u) const {
    LocalMatrix<F::local_dofs, Pack> result;
    for (int k = 0; k < Pack::size; ++k) {
      const LocalMatrix<F::local_dofs> K = model_->stiffness(components_[k], lane(u, k));
      for (Index e = 0; e < K.size(); ++e) result.data()[e].set(k, K.data()[e]);
    }
    return result;
  }

 private:
  static Local<F::local_dofs> lane(const Displacements& u, int k) {
    Local<F::local_dofs> result;
    for (int i = 0; i < F::local_dofs; ++i) result[i] = u[i][k];
    return result;
  }

  std::shared_ptr<const F> model_;
  PackIndices components_;
};

template <PackableForceModel F>
class TermPack<F> {
 public:
  using Displacements = Local<F::local_dofs, Pack>;

  TermPack(const std::shared_ptr<const F>& model, const PackIndices& components) {
    std::array<Pack, num_parameters> gathered;
    for (int k = 0; k < Pack::size; ++k) {
      const auto parameters = std::bit_cast<std::array<double, num_parameters>>(Scalar(model->term(components[k])));
      for (std::size_t p = 0; p < num_parameters; ++p) gathered[p].set(k, parameters[p]);
    }
    term_ = std::bit_cast<Packed>(gathered);
  }

  TermPack(const std::shared_ptr<const F>& model, Index component) {
    const auto parameters = std::bit_cast<std::array<double, num_parameters>>(Scalar(model->term(component)));
    std::array<Pack, num_parameters> broadcast;
    for (std::size_t p = 0; p < num_parameters; ++p) broadcast[p] = parameters[p];
    term_ = std::bit_cast<Packed>(broadcast);
  }

  Pack energy(const Displacements& u) const requires PotentialModel<F> { return term_.energy(u); }
  Displacements force(const Displacements& u) const { return term_.force(u); }
  LocalMatrix<F::local_dofs, Pack> stiffness(const Displacements& u) const { return term_.stiffness(u); }
  /// Current over rest volume, where the terms have such a thing.
  Pack jacobian(const Displacements& u) const requires requires(const typename F::template Term<Pack>& term) {
    term.jacobian(u);
  }
  { return term_.jacobian(u); }

 private:
  using Scalar = typename F::template Term<double>;
  using Packed = typename F::template Term<Pack>;
  static constexpr std::size_t num_parameters = sizeof(Scalar) / sizeof(double);
  static_assert(std::is_trivially_copyable_v<Scalar> && std::is_trivially_copyable_v<Packed> &&
                    sizeof(Packed) == num_parameters * sizeof(Pack),
                "Term<Real> must be an aggregate of members of type Real (or arrays of them) and nothing else");

  Packed term_;
};

}  // namespace supple

#pragma once
/// \file Check that says in words, as the compiler's first error, what a force model lacks.

#include <physics/model/force_model.hpp>

#include <type_traits>

namespace supple {

/// True; or compilation ends at the first requirement of ForceModel that F does not meet, with a sentence that names
/// it. FullSystem asks; ask yourself beside your model: `static_assert(explain_force_model<MyModel>());`.
template <typename F>
consteval bool explain_force_model() {
  static_assert(
      requires { typename std::integral_constant<int, F::stencil_size>; },
      "ForceModel: `static constexpr int stencil_size` is missing: the number of nodes of a component");
  static_assert(
      requires { typename std::integral_constant<int, F::node_dim>; },
      "ForceModel: `static constexpr int node_dim` is missing: the unknowns of a node, 3 for displacements");
  static_assert(
      requires { typename std::integral_constant<int, F::local_dofs>; },
      "ForceModel: `static constexpr int local_dofs = stencil_size * node_dim` is missing");
  static_assert(
      requires { requires F::local_dofs == F::stencil_size* F::node_dim; },
      "ForceModel: `local_dofs` must be stencil_size * node_dim");

  static_assert(
      requires(F & model) { model.num_nodes(); }, "ForceModel: `Index num_nodes() const` is missing");
  static_assert(
      requires(const F& model) {
        { model.num_nodes() } -> std::convertible_to<Index>;
      },
      "ForceModel: `Index num_nodes() const` must be const and return a number");
  static_assert(
      requires(F & model) { model.num_components(); }, "ForceModel: `Index num_components() const` is missing");
  static_assert(
      requires(const F& model) {
        { model.num_components() } -> std::convertible_to<Index>;
      },
      "ForceModel: `Index num_components() const` must be const and return a number");
  static_assert(
      requires(F & model, Index i) { model.stencil(i); },
      "ForceModel: `std::span<const Index, stencil_size> stencil(Index i) const` is missing");
  static_assert(
      requires(const F& model, Index i) {
        { model.stencil(i) } -> std::convertible_to<std::span<const Index, F::stencil_size>>;
      },
      "ForceModel: `stencil(i)` must be const and return std::span<const Index, stencil_size>");

  static_assert(
      requires(F & model, Index i, const Local<F::local_dofs>& u_i) { model.force(i, u_i); },
      "ForceModel: `Local<local_dofs> force(Index i, const Local<local_dofs>& u_i) const` is missing");
  static_assert(
      requires(const F& model, Index i, const Local<F::local_dofs>& u_i) {
        { model.force(i, u_i) } -> std::convertible_to<Local<F::local_dofs>>;
      },
      "ForceModel: `force(i, u_i)` must be const and return Local<local_dofs>");
  static_assert(
      requires(F & model, Index i, const Local<F::local_dofs>& u_i) { model.stiffness(i, u_i); },
      "ForceModel: `LocalMatrix<local_dofs> stiffness(Index i, const Local<local_dofs>& u_i) const` is "
      "missing");
  static_assert(
      requires(const F& model, Index i, const Local<F::local_dofs>& u_i) {
        { model.stiffness(i, u_i) } -> std::convertible_to<LocalMatrix<F::local_dofs>>;
      },
      "ForceModel: `stiffness(i, u_i)` must be const and return LocalMatrix<local_dofs>");
  static_assert(
      !requires { &F::energy; } ||
          requires(const F& model, Index i, const Local<F::local_dofs>& u_i) {
            { model.energy(i, u_i) } -> std::convertible_to<double>;
          },
      "ForceModel: there is an `energy`, but not `double energy(Index i, const Local<local_dofs>& u_i) "
      "const`");
  return true;
}

}  // namespace supple

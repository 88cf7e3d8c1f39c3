#pragma once
/// \file Check that says in words, as the compiler's first error, what a material lacks.

#include <physics/material/material_response.hpp>

#include <type_traits>

namespace supple {

namespace detail {
/// Converts to a Matrix3<Real> and to nothing else: Eigen's own matrices seem to convert to those of other scalars.
template <typename Real>
struct Gradient {
  operator const Matrix3<Real>&() const;
};
template <typename Material, typename Real>
concept HasEnergyOver = requires(const Material& material, const Gradient<Real>& F) {
  { material.energy(F) } -> std::convertible_to<Real>;
};
template <typename Material, typename Real>
concept HasStressOver = requires(const Material& material, const Gradient<Real>& F) {
  { material.stress(F) } -> std::convertible_to<Matrix3<Real>>;
};
template <typename Material, typename Real>
concept HasTangentOver = requires(const Material& material, const Gradient<Real>& F) {
  { material.tangent(F) } -> std::convertible_to<Matrix9<Real>>;
};
}  // namespace detail

/// True; or compilation ends at the first requirement of a material that it does not meet, with a sentence that names
/// it. SolidElasticity asks; ask yourself beside your material: `static_assert(explain_material<MyMaterial>());`.
template <template <typename> class Material>
consteval bool explain_material() {
  using Scalar = Material<double>;
  using Packed = Material<Pack>;
  static_assert(
      requires(Scalar & material, const Matrix3<double>& F) { material.energy(F); },
      "Material: `Real energy(const Matrix3<Real>& F) const` is missing");
  static_assert(
      requires(const Scalar& material, const Matrix3<double>& F) {
        { material.energy(F) } -> std::convertible_to<double>;
      },
      "Material: `Real energy(const Matrix3<Real>& F) const` must be const and return Real");
  static_assert(
      !requires { &Packed::energy; } || detail::HasEnergyOver<Packed, Pack>,
      "Material: `energy` must be written over the scalar type Real: it does not take packs");
  static_assert(
      !requires { &Scalar::stress; } || detail::HasStressOver<Scalar, double>,
      "Material: there is a `stress`, but not `Matrix3<Real> stress(const Matrix3<Real>& F) const`");
  static_assert(
      !requires { &Packed::stress; } || detail::HasStressOver<Packed, Pack>,
      "Material: `stress` must be written over the scalar type Real: it does not take packs");
  static_assert(
      !requires { &Scalar::tangent; } || detail::HasTangentOver<Scalar, double>,
      "Material: there is a `tangent`, but not `Matrix9<Real> tangent(const Matrix3<Real>& F) const`");
  static_assert(
      !requires { &Packed::tangent; } || detail::HasTangentOver<Packed, Pack>,
      "Material: `tangent` must be written over the scalar type Real: it does not take packs");
  static_assert(std::is_trivially_copyable_v<Scalar> && sizeof(Scalar) % sizeof(double) == 0 &&
                    sizeof(Packed) == sizeof(Scalar) / sizeof(double) * sizeof(Pack),
                "Material: its members must be of type Real (or arrays of them) and nothing else");
  return true;
}

}  // namespace supple

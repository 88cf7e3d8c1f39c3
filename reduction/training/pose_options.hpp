#pragma once
/// \file Options of training: which poses, and in which norm forces are fitted.

#include <core/registry.hpp>
#include <core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace supple {

/// What to do with a pose in which a component is inverted (its volume is ≤ 0).
enum class InvertedPoses {
  Keep,    ///< as it is; for materials defined everywhere, such as St. Venant–Kirchhoff
  Shrink,  ///< scale the pose by ¾ until nothing is inverted; keeps the direction, lowers the amplitude
  Redraw,  ///< draw another pose, up to 20 times, then shrink
};

template <>
inline constexpr std::array names_of<InvertedPoses>{
    Named{InvertedPoses::Keep, "keep"}, Named{InvertedPoses::Shrink, "shrink"}, Named{InvertedPoses::Redraw, "redraw"}};

/// Normal random numbers in the coordinates of the reduced vibration modes, with standard deviation ∝ ω̄⁻ᵉ
/// (Sec. 4.1). Rigid modes of free objects stay at rest: their forces turn with the object in a subspace W ⊗
/// I₃.
struct PoseOptions {
  Index count = 300;          ///< T
  double omega_exponent = 2;  ///< 1 in the paper; 2 draws less energy into stiff modes
  /// Expected rms displacement of a pose (mass-weighted mean over the object) as a share of the bounding
  /// box's diagonal; pose t uses entry t modulo their number. Mixed sizes keep small motions, which the rest
  /// stiffness rules, from drowning in large ones.
  std::vector<double> amplitudes = {0.05, 0.017, 0.005};
  std::optional<InvertedPoses> inverted = {};  ///< none: Keep, or Shrink for laws without energy there
  std::uint64_t seed = 1;

  double largest_amplitude() const { return *std::max_element(amplitudes.begin(), amplitudes.end()); }
};

/// The inner product in which Eq. 5 measures forces. Indices and weights are comparable, errors are not.
enum class ForceNorm {
  Mass,       ///< ‖F̄‖ for an M-orthonormal basis, as the paper may mean it; stiff directions dominate
  Stiffness,  ///< F̄ᵀ K̄⁻¹ F̄: forces count by the displacement they would cause, which is what an integrator
              ///< sees
};

template <>
inline constexpr std::array names_of<ForceNorm>{Named{ForceNorm::Mass, "mass"},
                                                Named{ForceNorm::Stiffness, "stiffness"}};

}  // namespace supple

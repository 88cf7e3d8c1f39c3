#pragma once
/// \file Rotations of the blocks of three unknowns that a vector consists of.

#include <core/check.hpp>
#include <core/types.hpp>

#include <utility>
#include <vector>

namespace supple {

/// T = diag(R₀, R₁, …), a rotation Rᵢ ∈ ℝ^{3×3} of the entries 3i … 3i + 2 each; the identity, of any size, if there are
/// none.
class BlockRotations {
 public:
  BlockRotations() = default;
  explicit BlockRotations(std::vector<Matrix3<double>> R) : R_(std::move(R)) {}

  bool is_identity() const { return R_.empty(); }

  void turn(VectorOut x) const {  ///< x ← T x
    check(x);
    for (std::size_t i = 0; i < R_.size(); ++i) x.segment<3>(3 * i) = Point(R_[i] * x.segment<3>(3 * i));
  }
  void turn_back(VectorOut x) const {  ///< x ← Tᵀ x
    check(x);
    for (std::size_t i = 0; i < R_.size(); ++i) x.segment<3>(3 * i) = Point(R_[i].transpose() * x.segment<3>(3 * i));
  }

 private:
  void check(VectorIn x) const {
    if (!is_identity()) require_size("x", x.size(), 3 * static_cast<Index>(R_.size()));
  }

  std::vector<Matrix3<double>> R_;
};

}  // namespace supple

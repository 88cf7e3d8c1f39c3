#pragma once
/// \file Norm of vectors whose squares may be too large or too small for numbers.

#include <core/types.hpp>

namespace supple {

/// ‖x‖, in units of its largest entry. Eigen 3.4's own stableNorm() of a Vector asserts, in builds with assertions, an
/// alignment that it does not need; through a reference it asks for none, and gives the same bits.
inline double stable_norm(VectorIn x) {
  return x.stableNorm();
}

}  // namespace supple

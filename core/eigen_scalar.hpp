#pragma once
/// \file Traits that Eigen needs of a scalar type that stands for a double.

#include <core/intrinsics.hpp>

#include <Eigen/Core>

namespace supple {

/// Base of Eigen::NumTraits<Scalar>.
template <typename Scalar>
struct RealScalarTraits : Eigen::NumTraits<double> {
  using Real = Scalar;
  using NonInteger = Scalar;
  using Nested = Scalar;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

}  // namespace supple

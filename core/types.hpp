#pragma once
/// \file Index, vector and matrix types shared by every floor of the library.

#include <core/intrinsics.hpp>

#include <Eigen/Core>
#include <Eigen/SparseCore>

// What holds fixed-size matrices would be laid out by -march, one way in the library and another in a program.
static_assert(EIGEN_MAX_STATIC_ALIGN_BYTES == 64, "compile with the definitions that supple::core brings");

namespace supple {

using Index = Eigen::Index;

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;  ///< dense, column-major
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;  ///< both triangles stored, also if symmetric

using VectorIn = const Eigen::Ref<const Vector>&;
using VectorOut = Eigen::Ref<Vector>;
using MatrixIn = const Eigen::Ref<const Matrix>&;
using MatrixOut = Eigen::Ref<Matrix>;

template <typename Real>
using Vector3 = Eigen::Matrix<Real, 3, 1>;
template <typename Real>
using Matrix3 = Eigen::Matrix<Real, 3, 3>;
template <typename Real>
using Matrix9 = Eigen::Matrix<Real, 9, 9>;
using Point = Vector3<double>;
/// n × 3, one position or vector a row; row-major, so it is also the interleaved x₀ y₀ z₀ x₁ … vector.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// The unknowns of one local term, node after node.
template <int dofs, typename Real = double>
using Local = Eigen::Matrix<Real, dofs, 1>;
template <int dofs, typename Real = double>
using LocalMatrix = Eigen::Matrix<Real, dofs, dofs>;

}  // namespace supple

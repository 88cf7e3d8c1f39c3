#pragma once
/// \file QR factorisation of matrices with many more rows than columns.

#include <core/types.hpp>

namespace supple {

/// A = Q R with k = min(rows, cols): QᵀQ = I, rows × k; R upper triangular, k × cols.
struct ThinQr {
  Matrix Q, R;
};

/// Householder factorisations of fixed ranges of rows, then one of their R's (Demmel, Grigori, Hoemmen,
/// Langou 2012): in parallel, with the same bits for any num_threads(). Q is orthonormal to rounding however
/// dependent the columns of A are. \note 4 rows · cols² operations
ThinQr tall_qr(MatrixIn A);

}  // namespace supple

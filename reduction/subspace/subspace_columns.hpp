#pragma once
/// \file Products of a subspace with many vectors at once, for which its fields are read once.

#include <core/check.hpp>
#include <core/parallel.hpp>
#include <reduction/subspace/subspace.hpp>

#include <vector>

namespace supple {

/// U Q. \param Q  d × k. \return full_dim × k
template <Subspace S>
Matrix reconstruct_columns(const S& subspace, MatrixIn Q) {
  constexpr int block = S::block;
  require_size("Q.rows()", Q.rows(), subspace.dim());
  const RowMatrix& W = subspace.W;
  RowMatrix fields(W.cols(), block * Q.cols());
  for (Index c = 0; c < Q.cols(); ++c)
    for (Index a = 0; a < Q.rows(); ++a) fields(a / block, c * block + a % block) = Q(a, c);
  Matrix result(W.rows() * block, Q.cols());
  parallel_ranges(W.rows(), 1024, [&](Index begin, Index end) {
    const RowMatrix part = W.middleRows(begin, end - begin) * fields;
    for (Index c = 0; c < Q.cols(); ++c)
      for (Index r = 0; r < part.rows(); ++r)
        for (int x = 0; x < block; ++x) result((begin + r) * block + x, c) = part(r, c * block + x);
  });
  return result;
}

/// Uᵀ F. \param F  full_dim × k. \return d × k, the same bits for any num_threads()
template <Subspace S>
Matrix project_columns(const S& subspace, MatrixIn F) {
  constexpr int block = S::block;
  require_size("F.rows()", F.rows(), subspace.full_dim());
  const RowMatrix& W = subspace.W;
  constexpr Index at_once = 1024;
  constexpr Index pieces = 16;  // sums that are kept apart
  std::vector<Matrix> sums(pieces, Matrix::Zero(W.cols(), block * F.cols()));
  parallel_for(pieces, [&](Index piece) {
    const Index end = W.rows() * (piece + 1) / pieces;
    for (Index begin = W.rows() * piece / pieces; begin < end; begin += at_once) {
      RowMatrix part(std::min(at_once, end - begin), block * F.cols());
      for (Index c = 0; c < F.cols(); ++c)
        for (Index r = 0; r < part.rows(); ++r)
          for (int x = 0; x < block; ++x) part(r, c * block + x) = F((begin + r) * block + x, c);
      sums[piece].noalias() += W.middleRows(begin, part.rows()).transpose() * part;
    }
  });
  for (Index piece = 1; piece < pieces; ++piece) sums[0] += sums[piece];
  Matrix result(subspace.dim(), F.cols());
  for (Index c = 0; c < F.cols(); ++c)
    for (Index a = 0; a < result.rows(); ++a) result(a, c) = sums[0](a / block, c * block + a % block);
  return result;
}

}  // namespace supple

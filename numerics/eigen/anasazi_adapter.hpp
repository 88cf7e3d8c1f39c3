#pragma once
/// \file Vectors and operators of Eigen as Anasazi asks for them. Private: heavy headers.

#include <core/parallel.hpp>
#include <core/random.hpp>
#include <core/types.hpp>
#include <numerics/linear/cholmod_solver.hpp>

#include <AnasaziMultiVecTraits.hpp>
#include <AnasaziOperatorTraits.hpp>

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <ostream>
#include <vector>

namespace supple {

/// Columns of length n, owned together with other multivectors that view some of them.
class Multivector {
 public:
  using View = Eigen::Map<Matrix>;

  Multivector(Matrix values, std::shared_ptr<Random> random)
      : storage_(std::make_shared<Matrix>(std::move(values))), columns_(storage_->cols()), random_(std::move(random)) {
    std::iota(columns_.begin(), columns_.end(), 0);
  }

  Index rows() const { return storage_->rows(); }
  Index cols() const { return static_cast<Index>(columns_.size()); }
  Random& random() const { return *random_; }

  Eigen::Map<Vector> col(Index j) const { return {storage_->col(columns_[j]).data(), rows()}; }
  /// The columns lie one after the other in memory.
  bool contiguous() const {
    for (Index j = 1; j < cols(); ++j)
      if (columns_[j] != columns_[0] + j) return false;
    return true;
  }
  /// All columns as one matrix; requires contiguous().
  View matrix() const { return {storage_->col(columns_[0]).data(), rows(), cols()}; }
  Matrix copy() const {
    Matrix values(rows(), cols());
    for (Index j = 0; j < cols(); ++j) values.col(j) = col(j);
    return values;
  }

  Multivector like(Index cols) const { return {Matrix(rows(), cols), random_}; }
  Multivector clone() const { return {copy(), random_}; }
  template <typename Indices>
  Multivector view(const Indices& indices) const {
    Multivector part = *this;
    part.columns_.clear();
    for (const int j : indices) part.columns_.push_back(columns_.at(static_cast<std::size_t>(j)));
    return part;
  }

 private:
  std::shared_ptr<Matrix> storage_;
  std::vector<Index> columns_;
  std::shared_ptr<Random> random_;
};

/// y = Op x on blocks of vectors.
struct BlockOperator {
  std::function<void(MatrixIn x, MatrixOut y)> apply;
};

namespace tall {

/// Rows in one piece of a tall product: sums are formed piece by piece, in order, whatever the number of
/// threads.
constexpr Index rows_in_piece = 2048;

/// Aᵀ B.
inline Matrix inner_products(MatrixIn A, MatrixIn B) {
  const Index pieces = (A.rows() + rows_in_piece - 1) / rows_in_piece;
  std::vector<Matrix> partial(pieces);
  parallel_ranges(A.rows(), rows_in_piece, [&](Index begin, Index end) {
    partial[begin / rows_in_piece].noalias() =
        A.middleRows(begin, end - begin).transpose() * B.middleRows(begin, end - begin);
  });
  Matrix sum = Matrix::Zero(A.cols(), B.cols());
  for (const Matrix& part : partial) sum += part;
  return sum;
}

/// Y = alpha A B + beta Y; Y is not read if beta = 0.
inline void add_product(double alpha, MatrixIn A, const Matrix& B, double beta, MatrixOut Y) {
  const Matrix scaled = alpha * B;
  parallel_ranges(A.rows(), rows_in_piece, [&](Index begin, Index end) {
    const Matrix product = A.middleRows(begin, end - begin) * scaled;  // Y may share columns with A
    auto out = Y.middleRows(begin, end - begin);
    if (beta == 0)
      out = product;
    else if (beta == 1)
      out += product;
    else
      out = beta * out + product;
  });
}

}  // namespace tall
}  // namespace supple

namespace Anasazi {

template <>
class MultiVecTraits<double, supple::Multivector> {
  using MV = supple::Multivector;
  using Dense = Teuchos::SerialDenseMatrix<int, double>;

  static std::vector<int> indices(const Teuchos::Range1D& range) {
    std::vector<int> all(static_cast<std::size_t>(range.size()));
    std::iota(all.begin(), all.end(), static_cast<int>(range.lbound()));
    return all;
  }
  static supple::Matrix to_eigen(const Dense& B) {
    return Eigen::Map<const supple::Matrix, 0, Eigen::OuterStride<>>(B.values(), B.numRows(), B.numCols(),
                                                                     Eigen::OuterStride<>(B.stride()));
  }
  /// Calls use(matrix) with the columns of A side by side, which are copied only if they are not so already.
  template <typename Use>
  static void with_matrix(const MV& A, const Use& use) {
    if (A.contiguous())
      use(A.matrix());
    else
      use(A.copy());
  }

 public:
  static Teuchos::RCP<MV> Clone(const MV& mv, int cols) { return Teuchos::rcp(new MV(mv.like(cols))); }
  static Teuchos::RCP<MV> CloneCopy(const MV& mv) { return Teuchos::rcp(new MV(mv.clone())); }
  static Teuchos::RCP<MV> CloneCopy(const MV& mv, const std::vector<int>& index) {
    return Teuchos::rcp(new MV(mv.view(index).clone()));
  }
  static Teuchos::RCP<MV> CloneCopy(const MV& mv, const Teuchos::Range1D& range) {
    return CloneCopy(mv, indices(range));
  }
  static Teuchos::RCP<MV> CloneViewNonConst(MV& mv, const std::vector<int>& index) {
    return Teuchos::rcp(new MV(mv.view(index)));
  }
  static Teuchos::RCP<MV> CloneViewNonConst(MV& mv, const Teuchos::Range1D& range) {
    return CloneViewNonConst(mv, indices(range));
  }
  static Teuchos::RCP<const MV> CloneView(const MV& mv, const std::vector<int>& index) {
    return Teuchos::rcp(new MV(mv.view(index)));
  }
  static Teuchos::RCP<const MV> CloneView(const MV& mv, const Teuchos::Range1D& range) {
    return CloneView(mv, indices(range));
  }

  static std::ptrdiff_t GetGlobalLength(const MV& mv) { return mv.rows(); }
  static int GetNumberVecs(const MV& mv) { return static_cast<int>(mv.cols()); }
  static bool HasConstantStride(const MV& mv) { return mv.contiguous(); }

  static void MvTimesMatAddMv(double alpha, const MV& A, const Dense& B, double beta, MV& mv) {
    with_matrix(A, [&](supple::MatrixIn left) {
      if (mv.contiguous()) {
        supple::tall::add_product(alpha, left, to_eigen(B), beta, mv.matrix());
        return;
      }
      supple::Matrix result = mv.copy();
      supple::tall::add_product(alpha, left, to_eigen(B), beta, result);
      for (supple::Index j = 0; j < mv.cols(); ++j) mv.col(j) = result.col(j);
    });
  }
  static void MvAddMv(double alpha, const MV& A, double beta, const MV& B, MV& mv) {
    for (supple::Index j = 0; j < mv.cols(); ++j) {
      if (alpha == 0)
        mv.col(j) = beta * B.col(j);  // exactly, and not reading A
      else if (beta == 0)
        mv.col(j) = alpha * A.col(j);
      else
        mv.col(j) = alpha * A.col(j) + beta * B.col(j);
    }
  }
  static void MvTransMv(double alpha, const MV& A, const MV& B, Dense& C) {
    Eigen::Map<supple::Matrix, 0, Eigen::OuterStride<>> result(C.values(), C.numRows(), C.numCols(),
                                                               Eigen::OuterStride<>(C.stride()));
    with_matrix(A, [&](supple::MatrixIn left) {
      with_matrix(B, [&](supple::MatrixIn right) {
        result.topLeftCorner(left.cols(), right.cols()) = alpha * supple::tall::inner_products(left, right);
      });
    });
  }
  static void MvDot(const MV& A, const MV& B, std::vector<double>& dots) {
    for (supple::Index j = 0; j < A.cols(); ++j) dots[j] = A.col(j).dot(B.col(j));
  }
  static void MvNorm(const MV& A, std::vector<double>& norms) {
    for (supple::Index j = 0; j < A.cols(); ++j) norms[j] = A.col(j).norm();
  }

  static void SetBlock(const MV& A, const std::vector<int>& index, MV& mv) {
    MV target = mv.view(index);
    for (supple::Index j = 0; j < target.cols(); ++j) target.col(j) = A.col(j);
  }
  static void SetBlock(const MV& A, const Teuchos::Range1D& range, MV& mv) { SetBlock(A, indices(range), mv); }
  static void Assign(const MV& A, MV& mv) {
    for (supple::Index j = 0; j < A.cols(); ++j) mv.col(j) = A.col(j);
  }
  static void MvScale(MV& mv, double alpha) {
    for (supple::Index j = 0; j < mv.cols(); ++j) mv.col(j) *= alpha;
  }
  static void MvScale(MV& mv, const std::vector<double>& alpha) {
    for (supple::Index j = 0; j < mv.cols(); ++j) mv.col(j) *= alpha[j];
  }
  static void MvInit(MV& mv, double alpha = 0) {
    for (supple::Index j = 0; j < mv.cols(); ++j) mv.col(j).setConstant(alpha);
  }
  /// Standard normal entries from the generator that came with the first vectors.
  static void MvRandom(MV& mv) {
    for (supple::Index j = 0; j < mv.cols(); ++j)
      for (double& value : mv.col(j)) value = mv.random().normal();
  }
  static void MvPrint(const MV& mv, std::ostream& out) { out << mv.copy() << '\n'; }

#ifdef HAVE_ANASAZI_TSQR
  using tsqr_adaptor_type = Anasazi::details::StubTsqrAdapter<MV>;
#endif
};

template <>
class OperatorTraits<double, supple::Multivector, supple::BlockOperator> {
 public:
  static void Apply(const supple::BlockOperator& op, const supple::Multivector& x, supple::Multivector& y) {
    if (x.contiguous() && y.contiguous()) {
      op.apply(x.matrix(), y.matrix());
      return;
    }
    supple::Matrix result(y.rows(), y.cols());
    op.apply(x.copy(), result);
    for (supple::Index j = 0; j < y.cols(); ++j) y.col(j) = result.col(j);
  }
};

}  // namespace Anasazi

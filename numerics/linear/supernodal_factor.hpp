#pragma once
/// \file Numbers of a sparse Cholesky factor, computed and applied along the elimination tree. Private.

#include <core/types.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace supple {

/// Pattern of L in P A Pᵀ = L Lᵀ. Supernode s is a dense block of the columns from first_column[s] on that
/// share the rows from rows[row_start[s]] on: its own columns first, then those below, ascending.
/// Supernodes are in postorder: a subtree is a range of them, its root last.
struct SupernodalPattern {
  std::vector<int> order;         ///< row i of P A Pᵀ is row order[i] of A
  std::vector<int> first_column;  ///< one more than there are supernodes
  std::vector<std::size_t> row_start;
  std::vector<int> rows;

  Index dim() const { return static_cast<Index>(order.size()); }
  int num_supernodes() const { return static_cast<int>(first_column.size()) - 1; }
  int width(int s) const { return first_column[s + 1] - first_column[s]; }
  int height(int s) const { return static_cast<int>(row_start[s + 1] - row_start[s]); }
  /// Rows below the own columns: these meet ancestors only.
  const int* rows_below(int s) const { return rows.data() + row_start[s] + width(s); }
  int num_below(int s) const { return height(s) - width(s); }
};

/// Multifrontal factorisation and solves (Duff & Reid 1983). Independent subtrees run in parallel, blocks
/// above them are cut into fixed tiles, and sums are formed in an order given by the pattern: bits do not
/// depend on the number of threads.
class SupernodalFactor {
 public:
  /// \param A  symmetric with the pattern that was analysed; only its pattern is read.
  SupernodalFactor(SupernodalPattern pattern, const SparseMatrix& A);

  /// False if a pivot is not positive, and then the values are of no use.
  /// \throws SolverError if memory runs out.
  bool factorize(const SparseMatrix& A);
  /// X = A⁻¹ B; X may be B.
  void solve(MatrixIn B, MatrixOut X) const;

  Index dim() const { return pattern_.dim(); }
  std::size_t num_values() const { return value_start_.back(); }
  double flops() const { return flops_; }

 private:
  /// Disjoint subtrees and what is left above them.
  struct Partition {
    struct Subtree {
      int first, root;  // supernodes first … root
    };
    std::vector<Subtree> subtrees;  // most work first
    std::vector<int> top;           // ascending
  };
  Partition partition(const std::vector<double>& work, double share) const;

  using Front = std::unique_ptr<double[]>;
  bool eliminate(int s, const double* A_values, std::vector<Front>& updates, bool in_tiles);
  template <int lanes>
  void solve_panel(MatrixIn B, MatrixOut X) const;

  SupernodalPattern pattern_;
  std::vector<std::size_t> value_start_;  // of each supernode's height × width block, column-major
  std::vector<int> parent_;
  std::vector<std::vector<int>> children_;
  std::vector<int> place_in_parent_;  // of every row below, within the parent's rows
  std::vector<std::size_t> place_start_;
  std::vector<int> source_;               // entries of A, supernode by supernode
  std::vector<std::size_t> destination_;  // where they go
  std::vector<std::size_t> source_start_;
  Partition for_factor_, for_solve_;
  std::vector<int> target_;  // of every row below: a row of X, or −1 − its place below the root of its subtree
  double flops_ = 0;
  std::unique_ptr<double[]> values_;
};

}  // namespace supple

#include <core/check.hpp>
#include <core/parallel.hpp>
#include <numerics/linear/supernodal_factor.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>
#include <numeric>
#include <string>
#include <utility>

extern "C" {
void dpotrf_(const char* uplo, const int* n, double* A, const int* lda, int* info);
void dtrsm_(const char* side, const char* uplo, const char* trans, const char* diag, const int* m, const int* n,
            const double* alpha, const double* A, const int* lda, double* B, const int* ldb);
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha, const double* A,
            const int* lda, const double* beta, double* C, const int* ldc);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k, const double* alpha,
            const double* A, const int* lda, const double* B, const int* ldb, const double* beta, double* C,
            const int* ldc);
}

namespace supple {

namespace {

constexpr double one = 1, minus_one = -1;
constexpr int tile = 192;              // rows and columns of a tile in a large front
constexpr double tiled_flops = 3e7;    // fronts with more work than this are cut into tiles
constexpr double tiled_entries = 6e5;  // and blocks of L with more entries than this, in solves
constexpr int solve_columns = 256;     // columns solved before the rows below them are updated
constexpr int solve_rows_in_tile = 1024;

/// L L₁₁ᵀ = B for `rows` rows of B below a factored diagonal block.
void solve_right(int rows, int cols, const double* L, int ldl, double* B, int ldb) {
  if (rows > 0) dtrsm_("R", "L", "T", "N", &rows, &cols, &one, L, &ldl, B, &ldb);
}

/// Lower triangle of C = beta C − A Aᵀ.
void subtract_square(int n, int k, const double* A, int lda, double beta, double* C, int ldc) {
  if (n > 0) dsyrk_("L", "N", &n, &k, &minus_one, A, &lda, &beta, C, &ldc);
}

bool factor_diagonal(int n, double* A, int lda) {
  int info = 0;
  dpotrf_("L", &n, A, &lda, &info);
  return info == 0 && std::isfinite(A[(n - 1) * (static_cast<std::size_t>(lda) + 1)]);  // NaN reaches the last pivot
}

/// Lower trapezoid of C = beta C − A Bᵀ in tiles, where B is the first `cols` of the rows of A.
void subtract_square_in_tiles(int rows, int cols, int k, const double* A, int lda, double beta, double* C, int ldc) {
  std::vector<std::pair<int, int>> tiles;
  for (int j = 0; j < cols; j += tile)
    for (int i = j; i < rows; i += tile) tiles.emplace_back(i, j);
  parallel_for(static_cast<Index>(tiles.size()), [&](Index t) {
    const auto [i, j] = tiles[t];
    const int m = std::min(tile, rows - i), n = std::min(tile, cols - j);
    double* out = C + i + static_cast<std::size_t>(j) * ldc;
    const int square = i == j ? n : 0, rest = m - square;
    subtract_square(square, k, A + i, lda, beta, out, ldc);
    if (rest > 0)
      dgemm_("N", "T", &rest, &n, &k, &minus_one, A + i + square, &lda, A + j, &lda, &beta, out + square, &ldc);
  });
}

}  // namespace

SupernodalFactor::SupernodalFactor(SupernodalPattern pattern, const SparseMatrix& A) : pattern_(std::move(pattern)) {
  const int count = pattern_.num_supernodes();
  const Index n = dim();
  std::vector<int> supernode_of(n);
  for (int s = 0; s < count; ++s)
    std::fill(supernode_of.begin() + pattern_.first_column[s], supernode_of.begin() + pattern_.first_column[s + 1], s);

  value_start_.assign(1, 0);
  parent_.resize(count);
  children_.resize(count);
  place_start_.assign(1, 0);
  std::vector<double> factor_work(count), solve_work(count);
  for (int s = 0; s < count; ++s) {
    const double w = pattern_.width(s), h = pattern_.height(s), below = h - w;
    value_start_.push_back(value_start_.back() + static_cast<std::size_t>(pattern_.width(s)) * pattern_.height(s));
    place_start_.push_back(place_start_.back() + pattern_.num_below(s));
    parent_[s] = below > 0 ? supernode_of[*pattern_.rows_below(s)] : -1;
    if (parent_[s] >= 0) children_[parent_[s]].push_back(s);
    factor_work[s] = w * (w * w / 3 + below * w + below * below);
    solve_work[s] = w * h;
  }
  flops_ = std::accumulate(factor_work.begin(), factor_work.end(), 0.0);

  std::vector<int> place(n);
  const auto number_rows = [&](int s) {
    for (std::size_t k = pattern_.row_start[s]; k < pattern_.row_start[s + 1]; ++k)
      place[pattern_.rows[k]] = static_cast<int>(k - pattern_.row_start[s]);
  };
  place_in_parent_.resize(place_start_.back());
  for (int s = 0; s < count; ++s) {
    if (children_[s].empty()) continue;
    number_rows(s);
    for (const int child : children_[s])
      for (int k = 0; k < pattern_.num_below(child); ++k)
        place_in_parent_[place_start_[child] + k] = place[pattern_.rows_below(child)[k]];
  }

  // Entries of A's lower triangle by the supernode that receives them, in A's order within each.
  std::vector<int> position(n);
  for (Index i = 0; i < n; ++i) position[pattern_.order[i]] = static_cast<int>(i);
  source_start_.assign(count + 1, 0);
  const auto for_each_entry = [&](const auto& use) {
    for (int j = 0; j < n; ++j)
      for (int k = A.outerIndexPtr()[j]; k < A.outerIndexPtr()[j + 1]; ++k) {
        const int i = A.innerIndexPtr()[k];
        if (i >= j) use(k, std::max(position[i], position[j]), std::min(position[i], position[j]));
      }
  };
  for_each_entry([&](int, int, int column) { ++source_start_[supernode_of[column] + 1]; });
  std::partial_sum(source_start_.begin(), source_start_.end(), source_start_.begin());
  source_.resize(source_start_.back());
  destination_.resize(source_start_.back());
  std::vector<std::size_t> next(source_start_.begin(), source_start_.end() - 1);
  std::vector<std::pair<int, int>> entry(source_.size());
  for_each_entry([&](int k, int row, int column) {
    const std::size_t slot = next[supernode_of[column]]++;
    source_[slot] = k;
    entry[slot] = {row, column};
  });
  for (int s = 0; s < count; ++s) {
    number_rows(s);
    for (std::size_t slot = source_start_[s]; slot < source_start_[s + 1]; ++slot)
      destination_[slot] = value_start_[s] + place[entry[slot].first] +
                           static_cast<std::size_t>(entry[slot].second - pattern_.first_column[s]) * pattern_.height(s);
  }

  for_factor_ = partition(factor_work, 1.0 / 64);
  for_solve_ = partition(solve_work, 1.0 / 16);
  target_.resize(place_start_.back());
  for (int s = 0; s < count; ++s)
    std::copy_n(pattern_.rows_below(s), pattern_.num_below(s), target_.begin() + place_start_[s]);
  for (const auto [first, root] : for_solve_.subtrees) {
    for (int k = 0; k < pattern_.num_below(root); ++k) place[pattern_.rows_below(root)[k]] = k;
    for (int s = first; s <= root; ++s)
      for (int k = 0; k < pattern_.num_below(s); ++k) {
        int& target = target_[place_start_[s] + k];
        if (target >= pattern_.first_column[root + 1]) target = -1 - place[target];
      }
  }
}

SupernodalFactor::Partition SupernodalFactor::partition(const std::vector<double>& work, double share) const {
  const int count = pattern_.num_supernodes();
  std::vector<double> below = work;  // of the whole subtree
  std::vector<int> first(count);
  for (int s = 0; s < count; ++s) {
    first[s] = children_[s].empty() ? s : first[children_[s].front()];
    if (parent_[s] >= 0) below[parent_[s]] += below[s];
  }
  const double largest = share * std::accumulate(work.begin(), work.end(), 0.0);
  Partition result;
  for (int s = 0; s < count; ++s) {
    if (below[s] > largest)
      result.top.push_back(s);
    else if (parent_[s] < 0 || below[parent_[s]] > largest)
      result.subtrees.push_back({first[s], s});
  }
  std::stable_sort(result.subtrees.begin(), result.subtrees.end(),
                   [&](const auto& a, const auto& b) { return below[a.root] > below[b.root]; });
  return result;
}

bool SupernodalFactor::eliminate(int s, const double* A_values, std::vector<Front>& updates, bool in_tiles) {
  const int width = pattern_.width(s), height = pattern_.height(s), below = height - width;
  double* const block = values_.get() + value_start_[s];
  std::fill_n(block, static_cast<std::size_t>(width) * height, 0.0);
  for (std::size_t slot = source_start_[s]; slot < source_start_[s + 1]; ++slot)
    values_[destination_[slot]] += A_values[source_[slot]];

  Front update(below > 0 ? new double[static_cast<std::size_t>(below) * below] : nullptr);
  if (!children_[s].empty())
    for (int j = 0; j < below; ++j) std::fill_n(update.get() + j + static_cast<std::size_t>(j) * below, below - j, 0.0);
  for (const int child : children_[s]) {
    const int size = pattern_.num_below(child);
    const int* const place = place_in_parent_.data() + place_start_[child];
    const double* const values = updates[child].get();
    const auto add_columns = [&](Index begin, Index end) {
      for (Index j = begin; j < end; ++j) {
        const double* const from = values + j * size;
        const bool own = place[j] < width;
        const int skipped = own ? 0 : width;
        double* const to = own ? block + static_cast<std::size_t>(place[j]) * height
                               : update.get() + static_cast<std::size_t>(place[j] - width) * below;
        for (int i = static_cast<int>(j); i < size; ++i) to[place[i] - skipped] += from[i];
      }
    };
    if (in_tiles && size > 2 * tile)
      parallel_ranges(size, 64, add_columns);
    else
      add_columns(0, size);
    updates[child].reset();
  }

  const double beta = children_[s].empty() ? 0 : 1;
  if (!in_tiles) {
    if (!factor_diagonal(width, block, height)) return false;
    solve_right(below, width, block, height, block + width, height);
    subtract_square(below, width, block + width, height, beta, update.get(), below);
  } else {
    for (int j = 0; j < width; j += tile) {
      const int cols = std::min(tile, width - j), next = j + cols;
      double* const diagonal = block + j + static_cast<std::size_t>(j) * height;
      if (!factor_diagonal(cols, diagonal, height)) return false;
      parallel_ranges(height - next, tile, [&](Index begin, Index end) {
        solve_right(static_cast<int>(end - begin), cols, diagonal, height, diagonal + cols + begin, height);
      });
      subtract_square_in_tiles(height - next, width - next, cols, diagonal + cols, height, 1,
                               block + next + static_cast<std::size_t>(next) * height, height);
    }
    subtract_square_in_tiles(below, below, width, block + width, height, beta, update.get(), below);
  }
  updates[s] = std::move(update);
  return true;
}

bool SupernodalFactor::factorize(const SparseMatrix& A) try {
  if (!values_) values_.reset(new double[num_values()]);
  std::vector<Front> updates(pattern_.num_supernodes());
  std::atomic<bool> positive{true};
  parallel_for(static_cast<Index>(for_factor_.subtrees.size()), [&](Index k) {
    const auto [first, root] = for_factor_.subtrees[k];
    for (int s = first; s <= root && positive; ++s)
      if (!eliminate(s, A.valuePtr(), updates, false)) positive = false;
  });
  for (const int s : for_factor_.top) {
    if (!positive) break;
    const double w = pattern_.width(s), below = pattern_.num_below(s);
    if (!eliminate(s, A.valuePtr(), updates, w * (w * w / 3 + below * w + below * below) > tiled_flops))
      positive = false;
  }
  return positive;
} catch (const std::bad_alloc&) {
  throw SolverError("factorize: out of memory, L has " + std::to_string(num_values()) + " entries");
}

namespace {

/// One row of as many right-hand sides as there are lanes.
template <int lanes>
struct Row;
template <>
struct Row<1> {
  using type = double;
};
template <>
struct Row<4> {
  using type = double __attribute__((vector_size(32), aligned(8), may_alias));
};
template <>
struct Row<8> {
  using type = double __attribute__((vector_size(64), aligned(8), may_alias));
};
template <int lanes>
using RowOf = typename Row<lanes>::type;

template <int lanes>
RowOf<lanes>* row(double* X, Index i) {
  return reinterpret_cast<RowOf<lanes>*>(X + i * lanes);
}
template <int lanes>
const RowOf<lanes>* row(const double* X, Index i) {
  return reinterpret_cast<const RowOf<lanes>*>(X + i * lanes);
}

using Eight = RowOf<8>;
inline const Eight* eight(const double* p) {
  return reinterpret_cast<const Eight*>(p);
}

// Rows or columns whose sums are kept in registers.
#ifdef __AVX512F__
constexpr Index unroll = 16;
#else
constexpr Index unroll = 4;
#endif

/// out(i) −= Σ_j L(i, j) x_j for rows begin … end − 1 and `cols` columns of L; out(i) names a row.
template <int lanes, typename Out>
void subtract_rows(const double* L, Index ldl, Index begin, Index end, Index cols, const double* x, const Out& out) {
  Index i = begin;
  if constexpr (lanes == 1) {
    for (; i + 32 <= end; i += 32) {
      Eight sum[4] = {};
      for (Index j = 0; j < cols; ++j)
#pragma GCC unroll 4
        for (Index k = 0; k < 4; ++k) sum[k] += *eight(L + i + 8 * k + j * ldl) * x[j];
      for (Index k = 0; k < 32; ++k) *out(i + k) -= sum[k / 8][k % 8];
    }
  } else {
    for (; i + unroll <= end; i += unroll) {
      RowOf<lanes> sum[unroll] = {};
      for (Index j = 0; j < cols; ++j) {
        const double* const column = L + i + j * ldl;
        const RowOf<lanes> x_j = *row<lanes>(x, j);
#pragma GCC unroll 16
        for (Index k = 0; k < unroll; ++k) sum[k] += column[k] * x_j;
      }
      for (Index k = 0; k < unroll; ++k) *out(i + k) -= sum[k];
    }
  }
  for (; i < end; ++i) {
    RowOf<lanes> sum = {};
    for (Index j = 0; j < cols; ++j) sum += L[i + j * ldl] * *row<lanes>(x, j);
    *out(i) -= sum;
  }
}

/// x_j −= Σ_i L(i, j) y_i for columns begin … end − 1, over `rows` rows.
template <int lanes>
void subtract_columns(const double* L, Index ldl, Index rows, Index begin, Index end, const double* y, double* x) {
  Index j = begin;
  for (; j + unroll <= end; j += unroll) {
    const double* const column = L + j * ldl;
    if constexpr (lanes == 1) {
      Eight sum[unroll] = {};
      Index i = 0;
      for (; i + 8 <= rows; i += 8) {
        const Eight y_i = *eight(y + i);
#pragma GCC unroll 16
        for (Index k = 0; k < unroll; ++k) sum[k] += *eight(column + i + k * ldl) * y_i;
      }
      for (Index k = 0; k < unroll; ++k) {
        double rest = 0;
        for (Index r = i; r < rows; ++r) rest += column[r + k * ldl] * y[r];
        for (int lane = 0; lane < 8; ++lane) rest += sum[k][lane];
        x[j + k] -= rest;
      }
    } else {
      RowOf<lanes> sum[unroll] = {};
      for (Index i = 0; i < rows; ++i) {
        const RowOf<lanes> y_i = *row<lanes>(y, i);
#pragma GCC unroll 16
        for (Index k = 0; k < unroll; ++k) sum[k] += column[i + k * ldl] * y_i;
      }
      for (Index k = 0; k < unroll; ++k) *row<lanes>(x, j + k) -= sum[k];
    }
  }
  for (; j < end; ++j) {
    RowOf<lanes> sum = {};
    for (Index i = 0; i < rows; ++i) sum += L[i + j * ldl] * *row<lanes>(y, i);
    *row<lanes>(x, j) -= sum;
  }
}

/// Runs body over 0 … count − 1, in tiles or at once.
template <typename Body>
void ranges(bool in_tiles, Index count, Index grain, const Body& body) {
  if (in_tiles)
    parallel_ranges(count, grain, body);
  else if (count > 0)
    body(0, count);
}

/// x = L⁻¹ x for a lower triangular n × n block, in steps of `step` columns.
template <int lanes>
void solve_lower(const double* L, Index ldl, Index n, Index step, bool in_tiles, double* x) {
  for (Index j = 0; j < n; j += step) {
    const Index next = std::min(n, j + step);
    const double* const diagonal = L + j + j * ldl;
    if (step > 16) {
      solve_lower<lanes>(diagonal, ldl, next - j, 16, false, x + j * lanes);
    } else {
      for (Index k = 0; k < next - j; ++k) {
        const RowOf<lanes> x_k = *row<lanes>(x, j + k) / diagonal[k + k * ldl];
        *row<lanes>(x, j + k) = x_k;
        for (Index i = k + 1; i < next - j; ++i) *row<lanes>(x, j + i) -= diagonal[i + k * ldl] * x_k;
      }
    }
    ranges(in_tiles, n - next, solve_rows_in_tile, [&](Index begin, Index end) {
      subtract_rows<lanes>(L + j * ldl, ldl, next + begin, next + end, next - j, x + j * lanes,
                           [&](Index i) { return row<lanes>(x, i); });
    });
  }
}

/// x = L⁻ᵀ x, likewise.
template <int lanes>
void solve_lower_transposed(const double* L, Index ldl, Index n, Index step, bool in_tiles, double* x) {
  for (Index next = n; next > 0;) {
    const Index j = (next - 1) / step * step;
    ranges(in_tiles, next - j, 32, [&](Index begin, Index end) {
      subtract_columns<lanes>(L + next + j * ldl, ldl, n - next, begin, end, x + next * lanes, x + j * lanes);
    });
    const double* const diagonal = L + j + j * ldl;
    if (step > 16) {
      solve_lower_transposed<lanes>(diagonal, ldl, next - j, 16, false, x + j * lanes);
    } else {
      for (Index k = next - j - 1; k >= 0; --k) {
        RowOf<lanes> sum = *row<lanes>(x, j + k);
        for (Index i = k + 1; i < next - j; ++i) sum -= diagonal[i + k * ldl] * *row<lanes>(x, j + i);
        *row<lanes>(x, j + k) = sum / diagonal[k + k * ldl];
      }
    }
    next = j;
  }
}

}  // namespace

template <int lanes>
void SupernodalFactor::solve_panel(MatrixIn B, MatrixOut X) const {
  const Index n = dim(), cols = B.cols();
  const std::unique_ptr<double[]> panel(new double[n * lanes]);
  double* const x = panel.get();
  parallel_ranges(n, 8192, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      for (Index c = 0; c < cols; ++c) x[i * lanes + c] = B(pattern_.order[i], c);
      for (Index c = cols; c < lanes; ++c) x[i * lanes + c] = 0;
    }
  });

  const auto forward = [&](int s, bool in_tiles, double* above) {
    const Index width = pattern_.width(s), height = pattern_.height(s);
    const double* const block = values_.get() + value_start_[s];
    const int* const target = target_.data() + place_start_[s];
    double* const own = x + static_cast<Index>(pattern_.first_column[s]) * lanes;
    solve_lower<lanes>(block, height, width, solve_columns, in_tiles, own);
    ranges(in_tiles, height - width, solve_rows_in_tile, [&](Index begin, Index end) {
      subtract_rows<lanes>(block + width, height, begin, end, width, own, [&](Index i) {
        return target[i] >= 0 ? row<lanes>(x, target[i]) : row<lanes>(above, -1 - target[i]);
      });
    });
  };
  const auto backward = [&](int s, bool in_tiles, std::vector<double>& gathered) {
    const Index width = pattern_.width(s), height = pattern_.height(s), below = height - width;
    const double* const block = values_.get() + value_start_[s];
    double* const own = x + static_cast<Index>(pattern_.first_column[s]) * lanes;
    gathered.resize(std::max(gathered.size(), static_cast<std::size_t>(below * lanes)));
    for (Index k = 0; k < below; ++k) *row<lanes>(gathered.data(), k) = *row<lanes>(x, pattern_.rows_below(s)[k]);
    ranges(in_tiles, width, 32, [&](Index begin, Index end) {
      subtract_columns<lanes>(block + width, height, below, begin, end, gathered.data(), own);
    });
    solve_lower_transposed<lanes>(block, height, width, solve_columns, in_tiles, own);
  };
  const auto is_large = [&](int s) {
    return static_cast<double>(pattern_.width(s)) * pattern_.height(s) > tiled_entries;
  };

  const Index num_subtrees = static_cast<Index>(for_solve_.subtrees.size());
  std::vector<std::vector<double>> above(num_subtrees);
  parallel_for(num_subtrees, [&](Index k) {
    const auto [first, root] = for_solve_.subtrees[k];
    above[k].assign(static_cast<std::size_t>(pattern_.num_below(root)) * lanes, 0.0);
    for (int s = first; s <= root; ++s) forward(s, false, above[k].data());
  });
  for (Index k = 0; k < num_subtrees; ++k) {
    const int root = for_solve_.subtrees[k].root;
    for (Index i = 0; i < pattern_.num_below(root); ++i)
      *row<lanes>(x, pattern_.rows_below(root)[i]) += *row<lanes>(above[k].data(), i);
  }
  for (const int s : for_solve_.top) forward(s, is_large(s), nullptr);

  std::vector<double> gathered;
  for (auto s = for_solve_.top.rbegin(); s != for_solve_.top.rend(); ++s) backward(*s, is_large(*s), gathered);
  parallel_for(num_subtrees, [&](Index k) {
    const auto [first, root] = for_solve_.subtrees[k];
    std::vector<double> own_gathered;
    for (int s = root; s >= first; --s) backward(s, false, own_gathered);
  });

  parallel_ranges(n, 8192, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i)
      for (Index c = 0; c < cols; ++c) X(pattern_.order[i], c) = x[i * lanes + c];
  });
}

void SupernodalFactor::solve(MatrixIn B, MatrixOut X) const {
  for (Index begin = 0; begin < B.cols();) {
    const Index cols = std::min<Index>(8, B.cols() - begin);
    const auto from = B.middleCols(begin, cols);
    auto to = X.middleCols(begin, cols);
    if (cols == 1)
      solve_panel<1>(from, to);
    else if (cols <= 4)
      solve_panel<4>(from, to);
    else
      solve_panel<8>(from, to);
    begin += cols;
  }
}

}  // namespace supple

#pragma once
/// \file Weighted components of a force model, with the rows of a basis behind them: forces that touch nothing else.

#include <core/check.hpp>
#include <core/single_pack.hpp>
#include <physics/model/term_pack.hpp>
#include <physics/system/mean_force.hpp>
#include <reduction/system/row_precision.hpp>

#include <array>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace supple {

/// Σ wᵢ Dᵢᵀ fᵢ(Dᵢ q) over few components, where Dᵢ are rows of a basis U = W ⊗ I_block. Energy (where the model has one),
/// force and tangent come from the same components and weights, so they agree by differentiation.
///
/// Components run in packs of eight: the rows of W behind a pack (3 × p for each tet) are stored so that one
/// sweep from the cache yields the local displacements and takes the local forces back.
template <ForceModel Model, int block>
class WeightedComponents {
  static constexpr int local = num_active_dofs<Model>;
  static constexpr int first_dof = Model::local_dofs - local;

 public:
  static constexpr int rows = local / block;  ///< of W (differences) that a component reads
  static constexpr bool symmetric_tangent = has_symmetric_tangent<Model>();

  /// \param indices, weights  the components; weights > 0.
  /// \param num_fields  p, columns of W.
  /// \param rows_of  position in `indices` → the rows of W behind that component, rows × p, see component_rows().
  template <typename RowsOf>
  WeightedComponents(std::shared_ptr<const Model> model, std::span<const Index> indices, VectorIn weights,
                     Index num_fields, const RowsOf& rows_of, RowPrecision precision = RowPrecision::Double)
      : num_fields_(num_fields) {
    const Index s = static_cast<Index>(indices.size());
    require_size("weights", weights.size(), s);
    require(s > 0, "no component is selected");
    require((weights.array() > 0).all(), "a weight of the selection is not positive");
    for (const Index i : indices)
      require(i >= 0 && i < model->num_components(), "component " + std::to_string(i) +
                                                         " does not exist, expected 0 to " +
                                                         std::to_string(model->num_components() - 1));
    const Index p = num_fields_;
    if (precision == RowPrecision::Single) E_ = std::vector<SinglePack>();
    for (Index first = 0; first < s; first += Pack::size) {
      const PackIndices lanes = consecutive_components(first, s);
      PackIndices components;
      const Index repeats = std::max<Index>(0, first + Pack::size - s) + 1;  // they share the last weight
      Pack weight;
      for (int k = 0; k < Pack::size; ++k) {
        components[k] = indices[lanes[k]];
        weight.set(k, weights[lanes[k]] / (lanes[k] == s - 1 ? repeats : 1));
      }
      terms_.emplace_back(model, components);
      weights_.push_back(weight);
      const auto keep_rows = [&](auto& E) {
        const std::size_t offset = E.size();
        E.resize(offset + p * rows);
        for (int k = 0; k < Pack::size; ++k) {
          const RowMatrix E_k = rows_of(lanes[k]);
          for (Index a = 0; a < p; ++a)
            for (int r = 0; r < rows; ++r) E[offset + a * rows + r].set(k, E_k(r, a));
        }
      };
      std::visit(keep_rows, E_);
    }
  }

  Index dim() const { return num_fields_ * block; }                                        ///< d
  Index num_components() const { return static_cast<Index>(terms_.size()) * Pack::size; }  ///< rounded up to packs

  double energy(VectorIn q) const requires PotentialModel<Model> {
    require_size("q", q.size(), dim());
    Pack sum(0.0);
    with_rows([&](const auto& rows_of) {
      for (std::size_t c = 0; c < terms_.size(); ++c)
        sum += weights_[c] * terms_[c].energy(gather(rows_of(c), q.data()));
    });
    return sum.sum();
  }

  void force(VectorIn q, VectorOut f) const {
    require_size("q", q.size(), dim());
    sum_forces(f, [&](std::size_t c, const auto* E) { return terms_[c].force(gather(E, q.data())); });
  }
  Vector force(VectorIn q) const {
    Vector f(dim());
    force(q, f);
    return f;
  }

  /// \see supple::mean_force. The rows of W are read as often as for one force.
  void mean_force(VectorIn q_0, VectorIn q_1, VectorOut f) const {
    require_size("q_0", q_0.size(), dim());
    require_size("q_1", q_1.size(), dim());
    sum_forces(f, [&](std::size_t c, const auto* E) {
      const auto [u, du] = gather_way(E, q_0.data(), q_1.data());
      return mean_force_of(terms_[c], u, du);
    });
  }

  /// K̃ = Σ wᵢ Dᵢᵀ Kᵢ Dᵢ.
  void stiffness(VectorIn q, Matrix& K) const {
    require_size("q", q.size(), dim());
    project_tangents(K, [&](std::size_t c, const auto* E) { return terms_[c].stiffness(gather(E, q.data())); });
  }
  Matrix stiffness(VectorIn q) const {
    Matrix K;
    stiffness(q, K);
    return K;
  }

  /// \see supple::mean_stiffness
  void mean_stiffness(VectorIn q_0, VectorIn q_1, Matrix& K) const {
    require_size("q_0", q_0.size(), dim());
    require_size("q_1", q_1.size(), dim());
    project_tangents(K, [&](std::size_t c, const auto* E) {
      const auto [u, du] = gather_way(E, q_0.data(), q_1.data());
      return mean_stiffness_of(terms_[c], u, du);
    });
  }

 private:
  using LocalField = Local<Model::local_dofs, Pack>;

  /// f = Σ wᵢ Dᵢᵀ fᵢ. \param force_of  (pack of components, the rows of W behind it) → their forces.
  template <typename ForceOf>
  void sum_forces(VectorOut f, const ForceOf& force_of) const {
    require_size("f", f.size(), dim());
    const Index p = num_fields_;
    std::vector<Pack> sums(dim(), Pack(0.0));
    with_rows([&](const auto& rows_of) {
      for (std::size_t c = 0; c < terms_.size(); ++c) {
        const auto* E = rows_of(c);
        LocalField f_c = force_of(c, E);
        for (int i = first_dof; i < Model::local_dofs; ++i) f_c[i] *= weights_[c];
        Pack* sum = sums.data();
        for (Index a = 0; a < p; ++a, E += rows, sum += block)
          for (int x = 0; x < block; ++x) {
            Pack at = sum[x];
            for (int r = 0; r < rows; ++r) at += Pack(E[r]) * f_c[first_dof + r * block + x];
            sum[x] = at;
          }
      }
    });
    for (Index k = 0; k < dim(); ++k) f[k] = sums[k].sum();
  }

  /// Σ wᵢ Dᵢᵀ Kᵢ Dᵢ by products of all rows of W at once, one for each pair of axes (x ≤ y if it is symmetric).
  /// \param tangent_of  (pack of components, the rows of W behind it) → their Kᵢ.
  template <typename TangentOf>
  void project_tangents(Matrix& K, const TangentOf& tangent_of) const {
    const Index p = num_fields_;
    constexpr int pairs = symmetric_tangent ? block * (block + 1) / 2 : block * block;
    constexpr Index packs_at_once = 8;  // their rows and products stay in the cache
    constexpr Index lanes = rows * Pack::size;
    Matrix sums = Matrix::Zero(p, pairs * p);
    Matrix left(packs_at_once * lanes, p), right(packs_at_once * lanes, pairs * p);
    with_rows([&](const auto& rows_of) {
      for (Index first = 0; first < static_cast<Index>(terms_.size()); first += packs_at_once) {
        const Index count = std::min<Index>(packs_at_once, static_cast<Index>(terms_.size()) - first);
        for (Index c = 0; c < count; ++c) {
          const auto* E = rows_of(first + c);
          const LocalMatrix<Model::local_dofs, Pack> K_c = tangent_of(first + c, E);
          const Pack weight = weights_[first + c];
          LocalMatrix<local, Pack> weighted;
          for (int j = 0; j < local; ++j)
            for (int i = 0; i < local; ++i) weighted(i, j) = weight * K_c(first_dof + i, first_dof + j);
          for (Index b = 0; b < p; ++b, E += rows) {
            Local<rows, Pack> W_b;
            for (int r = 0; r < rows; ++r) {
              W_b[r] = E[r];
              W_b[r].store_unaligned(&left((c * rows + r) * Pack::size, b));
            }
            int pair = 0;
            for (int x = 0; x < block; ++x)
              for (int y = symmetric_tangent ? x : 0; y < block; ++y, ++pair)
                for (int r = 0; r < rows; ++r) {
                  Pack sum(0.0);
                  for (int k = 0; k < rows; ++k) sum += weighted(r * block + x, k * block + y) * W_b[k];
                  sum.store_unaligned(&right((c * rows + r) * Pack::size, pair * p + b));
                }
          }
        }
        sums.noalias() += left.topRows(count * lanes).transpose() * right.topRows(count * lanes);
      }
    });
    K.resize(dim(), dim());
    int pair = 0;
    for (int x = 0; x < block; ++x)
      for (int y = symmetric_tangent ? x : 0; y < block; ++y, ++pair)
        for (Index b = 0; b < p; ++b)
          for (Index a = 0; a < p; ++a) {
            K(a * block + x, b * block + y) = sums(a, pair * p + b);
            if constexpr (symmetric_tangent) K(b * block + y, a * block + x) = sums(a, pair * p + b);
          }
  }

  /// Calls loop(rows_of), where rows_of(c) points to the rows of W behind pack c, in the precision they are kept in.
  template <typename Loop>
  void with_rows(const Loop& loop) const {
    std::visit([&](const auto& E) { loop([&](std::size_t c) { return E.data() + c * num_fields_ * rows; }); }, E_);
  }

  /// Local displacements of a pack of components: its rows of W, E, times q.
  template <typename Rows>
  Local<Model::local_dofs, Pack> gather(const Rows* E, const double* q) const {
    Local<local, Pack> active = Local<local, Pack>::Constant(Pack(0.0));
    const Index p = num_fields_;
    for (Index a = 0; a < p; ++a, E += rows, q += block)
      for (int r = 0; r < rows; ++r)
        for (int x = 0; x < block; ++x) active[r * block + x] += Pack(E[r]) * Pack(q[x]);
    Local<Model::local_dofs, Pack> u;
    for (int i = 0; i < first_dof; ++i) u[i] = Pack(0.0);
    for (int i = 0; i < local; ++i) u[first_dof + i] = active[i];
    return u;
  }
  /// The same of the start of a straight way, and of the way itself.
  template <typename Rows>
  std::array<LocalField, 2> gather_way(const Rows* E, const double* q_0, const double* q_1) const {
    std::array<LocalField, 2> way;
    for (LocalField& u : way) u.setConstant(Pack(0.0));
    const Index p = num_fields_;
    for (Index a = 0; a < p; ++a, E += rows, q_0 += block, q_1 += block)
      for (int r = 0; r < rows; ++r)
        for (int x = 0; x < block; ++x) {
          way[0][first_dof + r * block + x] += Pack(E[r]) * Pack(q_0[x]);
          way[1][first_dof + r * block + x] += Pack(E[r]) * Pack(q_1[x] - q_0[x]);
        }
    return way;
  }

  Index num_fields_;
  std::vector<TermPack<Model>> terms_;
  std::vector<Pack> weights_;
  // for each pack of components, field and row: eight entries of W
  std::variant<std::vector<Pack>, std::vector<SinglePack>> E_;
};

}  // namespace supple

#pragma once
/// \file Fitting problem of the reduced force by few components: A w ≈ b of Eqs. 5 and 6 without ever forming A.

#include <reduction/system/pose_sweep.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/training/pose_options.hpp>
#include <sparse/problem/fitting_problem.hpp>

#include <cmath>
#include <limits>
#include <mutex>

namespace supple {

/// Rows of A and b are L F̄: L = I for ForceNorm::Mass, Ω̄⁻¹ Φ̄ᵀ for ForceNorm::Stiffness (energy-free modes
/// take the lowest positive frequency).
Matrix force_metric(ForceNorm norm, const ReducedModes& modes);

/// The least-squares problem of choosing components: row block t of column i is L f̄ᵢ(q_t) / ‖L F̄(q_t)‖ and of
/// b is L F̄(q_t) / ‖L F̄(q_t)‖, so ‖A w − b‖ / ‖b‖ = ε(w), Eq. 5. A ∈ ℝ^{dT × m} is never formed. A component
/// is known by its local forces, L = num_active_dofs numbers a pose (9 for a tet) instead of d: with Dᵢ its L
/// rows of U,
///   Aᵀr over any columns costs one product with those rows and local dots,
///   ⟨aᵢ, aⱼ⟩ = Σ (Dᵢ N Dⱼᵀ) ∘ (Hᵢ Hⱼᵀ) with N = LᵀL and Hᵢ ∈ ℝ^{L × T} the local forces over ‖L F̄(q_t)‖.
/// Models SubsetSelector's BlockFittingProblem, FullGradientProblem and GroupedFittingProblem (groups are
/// poses).
template <ForceModel Model, Subspace S>
class ForceFitting {
  static constexpr int block = S::block;
  static_assert(block == 1 || block == Model::node_dim);
  static constexpr int rows_per_component =
      num_active_dofs<Model> / block;  // rows of W (differences) a component reads
  static constexpr int local = num_active_dofs<Model>;
  static constexpr int first_dof = Model::local_dofs - local;  // of the active ones

 public:
  class Columns;

  /// \param metric  L, d × d.  \param Q  d × T poses, none of which may be free of force.
  /// The model and the subspace are shared, not copied.
  ForceFitting(std::shared_ptr<const Model> model, std::shared_ptr<const S> subspace, Matrix metric, const Matrix& Q,
               const std::function<void(double)>& tell_share = {})
      : ForceFitting(model, subspace, std::make_shared<const Matrix>(std::move(metric)), Q,
                     reduced_forces(model, *subspace, Q, tell_share)) {}

  Index rows() const { return b_.size(); }                 ///< d T
  Index cols() const { return model_->num_components(); }  ///< m
  const Vector& rhs() const { return b_; }
  Index num_poses() const { return scale_.size(); }
  const Matrix& poses() const { return Q_; }   ///< d × T
  const Matrix& forces() const { return F_; }  ///< F̄(q_t), d × T
  const Model& model() const { return *model_; }
  const S& subspace() const { return *subspace_; }

  /// L Dⱼᵀ Hⱼ: the metric meets the few rows of U that component j reads, not its forces at all poses.
  void column(Index j, VectorOut out) const {
    require_size("out", out.size(), rows());
    const Columns one = columns(std::span<const Index>(&j, 1));
    const Index d = metric_->rows();
    Matrix LD(d, local);
    for (int x = 0; x < block; ++x) {  // every block-th column of L, from x on
      const Eigen::Map<const Matrix, 0, Eigen::OuterStride<>> L_x(metric_->data() + x * d, d, subspace_->num_fields(),
                                                                  Eigen::OuterStride<>(block * d));
      for (int row = 0; row < rows_per_component; ++row)
        LD.col(row * block + x).noalias() = L_x * one.E_.row(row).transpose();
    }
    Eigen::Map<Matrix>(out.data(), LD.rows(), num_poses()).noalias() = LD * one.H_.leftCols(num_poses());
  }

  Columns columns(std::span<const Index> js) const { return Columns(*this, js); }
  /// Its local forces, and its rows of U.
  Index numbers_per_column() const { return local * padded_poses() + rows_per_component * subspace_->num_fields(); }

  /// ε of a selection on these poses, Eq. 5.
  double error(std::span<const Index> indices, VectorIn weights) const {
    return (columns(indices).times(weights) - b_).norm() / b_.norm();
  }

  /// Aᵀ r over all components: one sweep over components and poses.
  Vector transpose_times(VectorIn r) const {
    return sweep_components<1>(pack_poses<block>(pull_back(r)), [](const auto&, const auto& f, const auto& y) {
      Pack sum(0.0);
      for (int k = 0; k < Model::local_dofs; ++k) sum += f[k] * y[k];
      return Local<1, Pack>(sum);
    });
  }

  /// ‖A e_j‖² for all components, computed once; 0 where it cannot be told from rounding, as that of a sliver, whose large
  /// local forces cancel.
  Vector squared_norms() const {
    const auto compute = [&]() -> Vector {
      Matrix sums = sweep_components<2>(RowMatrix(), [&](const LocalMatrix<local>& DND, const auto& f, const auto&) {
        Local<2, Pack> sum = Local<2, Pack>::Constant(Pack(0.0));
        for (int a = 0; a < local; ++a) {
          Pack row(0.0);
          for (int c = 0; c < local; ++c) row += Pack(DND(c, a)) * f[first_dof + c];
          sum[0] += f[first_dof + a] * row;
          sum[1] += Pack(DND(a, a)) * f[first_dof + a] * f[first_dof + a];
        }
        return sum;
      });
      for (Index i = 0; i < sums.rows(); ++i) sums(i, 0) = told_from_rounding(sums(i, 0), sums(i, 1));
      return sums.col(0);
    };
    std::call_once(norms_->once, [&] { norms_->values = compute(); });
    return norms_->values;
  }

  Index num_groups() const { return num_poses(); }
  /// The same problem on some of the poses.
  ForceFitting restricted_to(std::span<const Index> poses) const {
    Matrix Q(Q_.rows(), poses.size()), F(Q_.rows(), poses.size());
    for (std::size_t k = 0; k < poses.size(); ++k) {
      Q.col(k) = Q_.col(poses[k]);
      F.col(k) = F_.col(poses[k]);
    }
    return ForceFitting(model_, subspace_, metric_, Q, F);
  }

  /// Evaluated columns: local forces, not d-vectors. A ColumnBlock.
  class Columns {
   public:
    Columns(const ForceFitting& fitting, std::span<const Index> js)
        : fitting_(&fitting), indices_(js.begin(), js.end()) {
      H_.resize(size() * local, fitting.padded_poses());
      E_.resize(size() * rows_per_component, fitting.subspace_->num_fields());
      parallel_ranges(size(), 32, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k)
          E_.middleRows(k * rows_per_component, rows_per_component) =
              component_rows(*fitting.model_, *fitting.subspace_, indices_[k]);
        const RowMatrix u =
            E_.middleRows(begin * rows_per_component, (end - begin) * rows_per_component) * fitting.packed_Q_;
        for (Index k = begin; k < end; ++k)
          evaluate(k, u.data() + (k - begin) * rows_per_component * u.cols(), u.cols());
      });
      if (!std::isfinite(H_.sum())) fitting.refuse_not_finite(*this);
    }

    Index size() const { return static_cast<Index>(indices_.size()); }
    Index index(Index k) const { return indices_[k]; }

    /// Of column k: f̄(q_t) / ‖L F̄(q_t)‖ in the subspace, at as many poses from `first` on as `out` has columns (d rows,
    /// ordered by axes, see rows_by_axis()). A has L times that.
    void forces_by_axis(Index k, Index first, MatrixOut out) const {
      const auto E = E_.middleRows(k * rows_per_component, rows_per_component);
      for (int x = 0; x < block; ++x) {
        const Eigen::Map<const RowMatrix, 0, Eigen::OuterStride<>> h(
            &H_(k * local + x, first), rows_per_component, out.cols(), Eigen::OuterStride<>(block * H_.cols()));
        out.middleRows(x * E.cols(), E.cols()) = E.transpose().lazyProduct(h);
      }
    }

    Vector times(VectorIn w) const {
      require_size("w", w.size(), size());
      // Σ_k w_k D_kᵀ h_k: p × (block · T), the x-th part reads rows (row, x) of H
      Matrix force(fitting_->subspace_->dim(), fitting_->num_poses());
      parallel_for(block, [&](Index x) {
        RowMatrix h(size() * rows_per_component, fitting_->num_poses());
        for (Index row = 0; row < h.rows(); ++row)
          h.row(row) = w[row / rows_per_component] * H_.row(row * block + x).head(h.cols());
        const Matrix part = E_.transpose() * h;
        for (Index a = 0; a < part.rows(); ++a) force.row(a * block + x) = part.row(a);
      });
      Vector result(fitting_->rows());
      Eigen::Map<Matrix>(result.data(), force.rows(), force.cols()).noalias() = *fitting_->metric_ * force;
      return result;
    }

    Vector transpose_times(VectorIn r) const {
      const RowMatrix packed = pack_poses<block>(fitting_->pull_back_unscaled(r));
      Vector result(size());
      parallel_ranges(size(), 32, [&](Index begin, Index end) {
        const RowMatrix y = E_.middleRows(begin * rows_per_component, (end - begin) * rows_per_component) * packed;
        for (Index k = begin; k < end; ++k) {
          Pack sum(0.0);
          for (int row = 0; row < rows_per_component; ++row) {
            const double* y_row = y.data() + ((k - begin) * rows_per_component + row) * y.cols();
            for (Index pack = 0; pack < H_.cols() / Pack::size; ++pack)
              for (int x = 0; x < block; ++x)
                sum += Pack::load_unaligned(y_row + (pack * block + x) * Pack::size) *
                       Pack::load_unaligned(&H_((k * local + row * block + x), pack * Pack::size));
          }
          result[k] = sum.sum();
        }
      });
      return result;
    }

    Matrix gram(const Columns& other) const {
      const bool symmetric = this == &other;
      Matrix G(size(), other.size());
      const RowMatrix NE = fitting_->apply_metric(other.E_);  // rows (component row, x) of D N, d columns
      constexpr Index tile = 24;
      const Index tiles_i = (size() + tile - 1) / tile, tiles_j = (other.size() + tile - 1) / tile;
      parallel_for(tiles_i * tiles_j, [&](Index t) {
        const Index i0 = t / tiles_j * tile, j0 = t % tiles_j * tile;
        if (symmetric && j0 < i0) return;
        const Index ni = std::min(tile, size() - i0), nj = std::min(tile, other.size() - j0);
        const RowMatrix HH =
            H_.middleRows(i0 * local, ni * local) * other.H_.middleRows(j0 * local, nj * local).transpose();
        const RowMatrix DND = row_products(E_.middleRows(i0 * rows_per_component, ni * rows_per_component),
                                           NE.middleRows(j0 * local, nj * local));
        for (Index j = 0; j < nj; ++j)
          for (Index i = 0; i < ni; ++i) {
            const auto products = HH.template block<local, local>(i * local, j * local)
                                      .cwiseProduct(DND.template block<local, local>(i * local, j * local));
            const bool own = index(i0 + i) == other.index(j0 + j);
            G(i0 + i, j0 + j) = own ? told_from_rounding(products.sum(), products.diagonal().sum()) : products.sum();
          }
      });
      if (symmetric)
        for (Index j = 0; j < size(); ++j)
          for (Index i = j + 1; i < size(); ++i) G(i, j) = G(j, i);
      return G;
    }

    Vector squared_norms() const {
      Vector result(size());
      parallel_ranges(size(), 32, [&](Index begin, Index end) {
        const RowMatrix NE =
            fitting_->apply_metric(E_.middleRows(begin * rows_per_component, (end - begin) * rows_per_component));
        for (Index k = begin; k < end; ++k) {
          const LocalMatrix<local> DND = own_products(E_.middleRows(k * rows_per_component, rows_per_component),
                                                      NE.middleRows((k - begin) * local, local));
          const auto H = H_.middleRows(k * local, local);
          double sum = 0, size = 0;
          for (int a = 0; a < local; ++a) {
            const double own = DND(a, a) * H.row(a).squaredNorm();
            sum += own;
            size += own;
            for (int c = 0; c < a; ++c) sum += 2 * DND(c, a) * H.row(a).dot(H.row(c));
          }
          result[k] = told_from_rounding(sum, size);
        }
      });
      return result;
    }

    Columns subset(std::span<const Index> positions) const {
      Columns result(*fitting_);
      result.H_.resize(static_cast<Index>(positions.size()) * local, H_.cols());
      result.E_.resize(static_cast<Index>(positions.size()) * rows_per_component, E_.cols());
      for (std::size_t k = 0; k < positions.size(); ++k) {
        result.indices_.push_back(indices_[positions[k]]);
        result.H_.middleRows(k * local, local) = H_.middleRows(positions[k] * local, local);
        result.E_.middleRows(k * rows_per_component, rows_per_component) =
            E_.middleRows(positions[k] * rows_per_component, rows_per_component);
      }
      return result;
    }

    void append(const Columns& other) {
      const Index before = size();
      indices_.insert(indices_.end(), other.indices_.begin(), other.indices_.end());
      H_.conservativeResize(size() * local, Eigen::NoChange);
      E_.conservativeResize(size() * rows_per_component, Eigen::NoChange);
      H_.bottomRows((size() - before) * local) = other.H_;
      E_.bottomRows((size() - before) * rows_per_component) = other.E_;
    }

   private:
    friend class ForceFitting;

    explicit Columns(const ForceFitting& fitting) : fitting_(&fitting) {}

    void evaluate(Index k, const double* u, Index stride) {
      // as eight components, which an AnyModel keeps, while of one it makes the terms at each call
      const TermPack<Model> terms(fitting_->model_, one_component(indices_[k]));
      for (Index pack = 0; pack < H_.cols() / Pack::size; ++pack) {
        Local<Model::local_dofs, Pack> u_k;
        for (int c = 0; c < first_dof; ++c) u_k[c] = Pack(0.0);
        for (int row = 0; row < rows_per_component; ++row)
          for (int x = 0; x < block; ++x)
            u_k[first_dof + row * block + x] = Pack::load_unaligned(u + row * stride + (pack * block + x) * Pack::size);
        const auto f = terms.force(u_k);
        const Pack scale = Pack::load_unaligned(fitting_->padded_scale_.data() + pack * Pack::size);
        for (int c = 0; c < local; ++c)
          (scale * f[first_dof + c]).store_unaligned(&H_(k * local + c, pack * Pack::size));
      }
    }

    const ForceFitting* fitting_;
    std::vector<Index> indices_;
    RowMatrix H_;  // (|C| · local) × padded T: local forces over ‖L F̄(q_t)‖
    RowMatrix E_;  // (|C| · rows_per_component) × p: the rows of W that a component reads
  };

 private:
  friend class Columns;
  using Rows = Eigen::Ref<const RowMatrix>;

  ForceFitting(std::shared_ptr<const Model> model, std::shared_ptr<const S> subspace,
               std::shared_ptr<const Matrix> metric, const Matrix& Q, Matrix F)
      : model_(std::move(model)), subspace_(std::move(subspace)), metric_(std::move(metric)), Q_(Q), F_(std::move(F)) {
    require_size("metric.rows()", metric_->rows(), subspace_->dim());
    require_size("metric.cols()", metric_->cols(), subspace_->dim());
    require(Q.cols() > 0, "there are no training poses");
    const Matrix LF = *metric_ * F_;
    const Vector norms = LF.colwise().norm();
    const double largest = norms.maxCoeff();
    scale_.resize(Q.cols());
    for (Index t = 0; t < Q.cols(); ++t) {
      const double norm = norms[t];
      if (!std::isfinite(norm))
        throw InputError("pose " + std::to_string(t) +
                         ": the force is not finite (an inverted element of a material that is "
                         "undefined there?); choose smaller amplitudes, or shrink or redraw such poses");
      if (norm <= 1e-10 * largest)  // only rounding is left of a force that a rigid motion does not have
        throw InputError("pose " + std::to_string(t) + ": there is no force, expected a pose that deforms the object");
      scale_[t] = 1 / norm;
    }
    b_.resize(LF.size());
    Eigen::Map<Matrix>(b_.data(), LF.rows(), LF.cols()) = LF * scale_.asDiagonal();
    packed_Q_ = pack_poses<block>(Q_);
    padded_scale_ = Vector::Zero(packed_Q_.cols() / block);
    padded_scale_.head(num_poses()) = scale_;
    const Matrix N = metric_->transpose() * *metric_;
    N_by_axis_ = rows_by_axis<block>(rows_by_axis<block>(N).transpose());
  }

  Index padded_poses() const { return padded_scale_.size(); }

  /// Lᵀ r_t, d × T.
  Matrix pull_back_unscaled(VectorIn r) const {
    require_size("r", r.size(), rows());
    return metric_->transpose() * Eigen::Map<const Matrix>(r.data(), metric_->rows(), num_poses());
  }
  Matrix pull_back(VectorIn r) const { return pull_back_unscaled(r) * scale_.asDiagonal(); }

  /// D N: one row for each (row of E, x), d columns, ordered by axes.
  RowMatrix apply_metric(const Rows& E) const {
    RowMatrix result(E.rows() * block, N_by_axis_.cols());
    for (int x = 0; x < block; ++x)
      every_block_row(result, x).noalias() = E * N_by_axis_.middleRows(x * E.cols(), E.cols());
    return result;
  }
  /// D (D' N)ᵀ for rows E of D and NE = D' N.
  static RowMatrix row_products(const Rows& E, const Rows& NE) {
    RowMatrix result(E.rows() * block, NE.rows());
    for (int x = 0; x < block; ++x)
      every_block_row(result, x).noalias() = E * NE.middleCols(x * E.cols(), E.cols()).transpose();
    return result;
  }
  /// The same for a component and itself.
  static LocalMatrix<local> own_products(const Rows& E, const Rows& NE) {
    LocalMatrix<local> result;
    for (int x = 0; x < block; ++x)
      result(Eigen::seqN(x, Eigen::fix<rows_per_component>, Eigen::fix<block>), Eigen::all) =
          E.lazyProduct(NE.middleCols(x * E.cols(), E.cols()).transpose());
    return result;
  }
  /// ‖aᵢ‖², a sum of products of rows of U and local forces, or 0 if that is all rounding of such products. \param size  those
  /// of single rows with themselves.
  static double told_from_rounding(double sum, double size) {
    return sum > 256 * std::numeric_limits<double>::epsilon() * size || !std::isfinite(sum) ? sum : 0;
  }
  /// Rows x, block + x, …
  static auto every_block_row(RowMatrix& M, int x) {
    return Eigen::Map<RowMatrix, 0, Eigen::OuterStride<>>(M.row(x).data(), M.rows() / block, M.cols(),
                                                          Eigen::OuterStride<>(block * M.cols()));
  }

  /// Σ over poses of body(D N Dᵀ, scaled or plain f, y), `count` numbers, for each component, m × count; y are fields of
  /// `packed`, if there are any.
  template <int count, typename Body>
  Matrix sweep_components(const RowMatrix& packed, const Body& body) const {
    const bool norms = packed.size() == 0;
    const Index m = cols(), num_rows = subspace_->W.rows();
    std::vector<Local<count, Pack>> sums(m, Local<count, Pack>::Constant(Pack(0.0)));
    std::vector<LocalMatrix<local>> DND;
    if (norms) {
      DND.resize(m);
      parallel_ranges(m, 64, [&](Index begin, Index end) {
        RowMatrix E((end - begin) * rows_per_component, subspace_->num_fields());
        for (Index i = begin; i < end; ++i)
          E.middleRows((i - begin) * rows_per_component, rows_per_component) = component_rows(*model_, *subspace_, i);
        const RowMatrix NE = apply_metric(E);
        for (Index i = begin; i < end; ++i)
          DND[i] = own_products(E.middleRows((i - begin) * rows_per_component, rows_per_component),
                                NE.middleRows((i - begin) * local, local));
      });
    }
    AlignedBuffer u(subspace_->full_dim() * Pack::size), y(norms ? 0 : u.size());
    for (Index pack = 0; pack < padded_poses() / Pack::size; ++pack) {
      parallel_ranges(num_rows, 4096, [&](Index begin, Index end) {
        reconstruct_poses(*subspace_, packed_Q_, pack, begin, end, u.data());
        if (!norms) reconstruct_poses(*subspace_, packed, pack, begin, end, y.data());
      });
      const Pack scale = Pack::load_unaligned(padded_scale_.data() + pack * Pack::size);
      parallel_ranges(m, 2048, [&](Index begin, Index end) {
        static const LocalMatrix<local> none = LocalMatrix<local>::Zero();
        for (Index i = begin; i < end; ++i) {
          Local<Model::local_dofs, Pack> f = TermPack<Model>(model_, i).force(gather_poses(*model_, i, u.data()));
          if (norms) {
            f *= scale;
            sums[i] += body(DND[i], f, f);
          } else {
            sums[i] += body(none, f, gather_poses(*model_, i, y.data()));
          }
        }
      });
    }
    Matrix result(m, count);
    for (Index i = 0; i < m; ++i)
      for (int k = 0; k < count; ++k) result(i, k) = sums[i][k].sum();
    return result;
  }

  [[noreturn]] void refuse_not_finite(const Columns& columns) const {
    for (Index k = 0; k < columns.size(); ++k)
      if (!columns.subset(std::vector<Index>{k}).times(Vector::Ones(1)).allFinite())
        throw InputError("component " + std::to_string(columns.index(k)) +
                         ": its force is not finite at a training pose");
    throw InputError("the force of a component is not finite at a training pose");
  }

  struct Norms {
    std::once_flag once;
    Vector values;
  };

  std::shared_ptr<const Model> model_;
  std::shared_ptr<const S> subspace_;
  std::shared_ptr<const Matrix> metric_;  // L
  Matrix Q_, F_;
  Vector scale_, b_;
  RowMatrix packed_Q_;
  Vector padded_scale_;
  RowMatrix N_by_axis_;  // LᵀL, rows and columns ordered by axes
  std::shared_ptr<Norms> norms_ = std::make_shared<Norms>();
};

}  // namespace supple

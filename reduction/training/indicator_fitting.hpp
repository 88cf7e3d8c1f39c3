#pragma once
/// \file Training of an ErrorIndicator: the second selection, and what to look at outside of the subspace.

#include <core/random.hpp>
#include <reduction/system/error_estimator.hpp>
#include <reduction/training/equilibrium_fitting.hpp>
#include <reduction/training/relaxation.hpp>
#include <sparse/problem/any_problem.hpp>
#include <sparse/selectors/nn_sp.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <numeric>
#include <optional>

namespace supple {

/// What the displacements that a subspace lacks have in common.
struct OutsideModes {
  Matrix V;            ///< dim × k, VᵀMV = I, VᵀKV diagonal, over the free unknowns
  Vector stiffness;    ///< k, the diagonal of VᵀKV [1/s²]
  Matrix coordinates;  ///< k × T, Vᵀ M of the remainders over the sizes
};
/// Principal components of what remains of relaxed states, u − U q.
/// \param remainders  dim × T. \param sizes  T, what each is a share of. \param count  at most so many.
OutsideModes outside_modes(const Matrix& remainders, const Vector& sizes, const SparseMatrix& K, const Vector& mass,
                           Index count);
/// What nine in ten do not exceed: a pose or two that have collapsed do not tell what was trained.
double ninth_decile(Vector sizes);

/// Vᵀ fᵢ(U q_t) of some components: entry (t k + j, i) along column j of V at pose t.
/// \param V  of all nodes, W. \param Q  d × T.
template <ForceModel Model, Subspace S>
Matrix forces_along(const std::shared_ptr<const Model>& model, const DenseBasis& V, const S& subspace, const Matrix& Q,
                    std::span<const Index> components) {
  constexpr Index local = num_active_dofs<Model>, first_dof = Model::local_dofs - local;
  const Index k = V.dim(), T = Q.cols();
  const RowMatrix packed = pack_poses<S::block>(Q);
  Matrix result(k * T, static_cast<Index>(components.size()));
  AlignedBuffer fields(subspace.full_dim() * Pack::size);
  for (Index first = 0; first < T; first += Pack::size) {
    const Index count = std::min<Index>(Pack::size, T - first);
    parallel_ranges(subspace.W.rows(), 4096, [&](Index begin, Index end) {
      reconstruct_poses(subspace, packed, first / Pack::size, begin, end, fields.data());
    });
    parallel_for(result.cols(), [&](Index c) {
      const Index i = components[c];
      const RowMatrix E = component_rows(*model, V, i);
      const Local<Model::local_dofs, Pack> f = TermPack<Model>(model, i).force(gather_poses(*model, i, fields.data()));
      for (Index j = 0; j < k; ++j) {
        Pack sum(0.0);
        for (Index a = 0; a < local; ++a) sum += Pack(E(a, j)) * f[first_dof + a];
        for (Index t = 0; t < count; ++t) result((first + t) * k + j, c) = sum[t];
      }
    });
  }
  return result;
}

/// The indicator of a model, not yet calibrated; none where too few components are left for it.
/// \param equilibria  poses, targets and rows that the model was fitted to. \param at_rest  poses near rest, for a few of
/// which forces are to be right, too. \param relaxed  the states that the targets were taken from.
/// \param taken  components of the model, ascending. \param size  s₂.
template <PotentialModel Model, Subspace S>
std::optional<ErrorIndicator> fit_indicator(const FullSystem<Model>& system, const S& subspace,
                                            const EquilibriumFitting<Model, S>& equilibria,
                                            const ForceFitting<Model, S>& at_rest, const FullStates& relaxed,
                                            std::span<const Index> taken, Index size, std::uint64_t seed) {
  constexpr Index most_candidates = 2000, most_outside = 8, poses_at_rest = 24;
  const auto& model = system.shared_model();
  std::vector<Index> candidates(model->num_components());
  std::iota(candidates.begin(), candidates.end(), Index{0});
  std::erase_if(candidates, [&](Index i) { return std::binary_search(taken.begin(), taken.end(), i); });
  if (static_cast<Index>(candidates.size()) < size) return std::nullopt;
  candidates = Random(seed).sample(std::move(candidates), most_candidates);
  std::sort(candidates.begin(), candidates.end());

  const Matrix& Q = equilibria.poses();
  const Vector sizes = Q.colwise().norm().transpose();
  const OutsideModes outside =
      outside_modes(relaxed.remainders, sizes, system.rest_stiffness(), system.mass(), most_outside);
  const Index k = outside.stiffness.size(), T = Q.cols();
  DenseBasis V;
  V.W = system.rest_state().expand(outside.V);

  std::vector<Index> few(std::min(poses_at_rest, at_rest.num_poses()));
  std::iota(few.begin(), few.end(), Index{0});
  const auto rest = at_rest.restricted_to(few);
  const Index own = equilibria.rows(), along = k * T;
  Matrix A(own + along + rest.rows(), static_cast<Index>(candidates.size()));
  Vector b(A.rows());
  A.topRows(own) = equilibria.columns(candidates).values();
  const Vector per_row =
      -equilibria.scale() * (outside.stiffness.cwiseInverse() * sizes.cwiseInverse().transpose()).reshaped();
  A.middleRows(own, along) = per_row.asDiagonal() * forces_along(model, V, subspace, Q, candidates);
  parallel_for(A.cols(), [&](Index c) { rest.column(candidates[c], A.col(c).tail(rest.rows())); });
  b << equilibria.rhs(), equilibria.scale() * outside.coordinates.reshaped(), rest.rhs();

  const DenseProblem problem(std::move(A), std::move(b));
  const Selection selection = NnSp{.max_iterations = 12, .seed = seed}(AnyProblem(problem), size);
  ErrorIndicator indicator;
  std::vector<double> weights;
  for (Index c = 0; c < selection.size(); ++c)
    if (selection.weights[c] > 0) {
      indicator.indices.push_back(candidates[selection.indices[c]]);
      weights.push_back(selection.weights[c]);
    }
  if (indicator.indices.empty()) return std::nullopt;
  indicator.weights = Eigen::Map<const Vector>(weights.data(), static_cast<Index>(weights.size()));
  constexpr Index local = num_active_dofs<Model>;
  indicator.rows.resize(indicator.weights.size() * local, subspace.dim() + k);
  for (Index c = 0; c < indicator.weights.size(); ++c)
    indicator.rows.middleRows(c * local, local) << dense_component_rows(*model, subspace, indicator.indices[c]),
        component_rows(*model, V, indicator.indices[c]);
  indicator.outside_stiffness = outside.stiffness;
  indicator.trained_size = ninth_decile(sizes);
  return indicator;
}

}  // namespace supple

#pragma once
/// \file What single components do at rest, along given displacements.

#include <core/parallel.hpp>
#include <physics/model/term_pack.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/system/pose_sweep.hpp>

#include <span>

namespace supple {

/// xᵀ Kᵢ(0) x of some components at rest. \param X  d × k, displacements x in its columns. \return k × components [1/s²]
template <ForceModel Model, Subspace S>
Matrix rest_energies(const FullSystem<Model>& system, const S& subspace, std::span<const Index> components,
                     const Matrix& X) {
  constexpr int local = num_active_dofs<Model>, first_dof = Model::local_dofs - local;
  const std::shared_ptr<const Model>& model = system.shared_model();
  Local<Model::local_dofs, Pack> rest;
  for (int i = 0; i < Model::local_dofs; ++i) rest[i] = Pack(0.0);
  Matrix result(X.cols(), static_cast<Index>(components.size()));
  parallel_for(result.cols(), [&](Index c) {
    const auto packed = TermPack<Model>(model, one_component(components[c])).stiffness(rest);
    LocalMatrix<local> K;
    for (int i = 0; i < local; ++i)
      for (int j = 0; j < local; ++j) K(i, j) = packed(first_dof + i, first_dof + j)[0];
    const Matrix u = dense_component_rows(*model, subspace, components[c]) * X;
    result.col(c) = u.cwiseProduct(K * u).colwise().sum().transpose();
  });
  return result;
}

}  // namespace supple

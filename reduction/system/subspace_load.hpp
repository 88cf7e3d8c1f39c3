#pragma once
/// \file Loads in the unknowns of a subspace, read from the rows of the basis that they touch.

#include <physics/load/loads.hpp>
#include <physics/load/system_load.hpp>
#include <reduction/subspace/subspace.hpp>

#include <memory>
#include <vector>

namespace supple {

/// Each force as a term in q, evaluated on the rows of the basis U = W ⊗ I_block at its nodes. \param block  1 or 3.
std::vector<std::shared_ptr<const OutsideTerm<Matrix>>> outside_terms(const std::vector<AnyOutsideForce>& forces,
                                                                      const RowMatrix& W, int block);

/// Uᵀ M times a unit acceleration along each axis, d × 3. \param nodal_mass  n [kg].
template <Subspace S>
Matrix project_gravity(const S& subspace, const Vector& nodal_mass) {
  Matrix gravity(subspace.dim(), 3);
  for (int x = 0; x < 3; ++x) {
    Vector f = Vector::Zero(subspace.full_dim());
    for (Index v = 0; v < nodal_mass.size(); ++v) f[3 * v + x] = nodal_mass[v];
    gravity.col(x) = subspace.project(f);
  }
  return gravity;
}

/// Springs in q, which read the rows of U at their nodes.
template <Subspace S>
SystemSprings<Matrix> subspace_springs(const S& subspace, const std::vector<PointSpring>& springs) {
  const Index count = 3 * static_cast<Index>(springs.size());
  SystemSprings<Matrix> result{Matrix(count, subspace.dim()), Vector(count), Vector(count)};
  for (Index row = 0; const PointSpring& spring : springs)
    for (int x = 0; x < 3; ++x, ++row) {
      Vector of_unknowns = Vector::Zero(subspace.dim());
      subspace.add_row(3 * spring.node + x, 1, of_unknowns);
      result.rows.row(row) = of_unknowns.transpose();
      result.stiffness[row] = spring.stiffness;
      result.targets[row] = spring.displacement[x];
    }
  return result;
}

/// Uᵀ of loads on nodes. \param gravity  see project_gravity.
template <Subspace S>
SystemLoad<Matrix> project_loads(const S& subspace, const Matrix& gravity, const Loads& loads) {
  check_loads(loads, subspace.full_dim() / 3);
  SystemLoad<Matrix> result{gravity * loads.gravity, {}};
  for (const NodalForce& load : loads.forces)
    for (int x = 0; x < 3; ++x) subspace.add_row(3 * load.node + x, load.force[x], result.force);
  if (!loads.springs.empty()) {
    result.springs = subspace_springs(subspace, loads.springs);
    const auto& [rows, stiffness, targets] = result.springs;
    result.stiffness = rows.transpose() * stiffness.asDiagonal() * rows;
    result.force += result.springs.pull_of_targets();
  }
  result.others = outside_terms(loads.others, subspace.W, S::block);
  return result;
}

}  // namespace supple

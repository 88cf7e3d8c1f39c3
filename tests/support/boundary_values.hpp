#pragma once
/// \file Equilibrium under displacements that are given on the boundary.

#include <physics/system/node_numbering.hpp>

namespace supple::test {

/// φ(w) = E(g + w) over the interior nodes: g is given on the boundary.
template <typename System>
struct BoundaryValueProblem {
  using MatrixType = Matrix;
  const System& system;  // without fixed nodes
  NodeNumbering interior;
  Vector g, mass = interior.restrict(system.mass(), 3);

  Vector at(VectorIn w) const { return g + interior.expand(w, 3); }
  double value(VectorIn w) const { return system.energy(at(w)); }
  void gradient(VectorIn w, VectorOut out) const { out = interior.restrict(system.force(at(w)), 3); }
  void hessian(VectorIn w, Matrix& H) const {
    const Matrix K = system.stiffness(at(w));
    H.resize(w.size(), w.size());
    for (Index j = 0; j < w.size(); ++j) {
      Vector unit = Vector::Unit(w.size(), j);
      H.col(j) = interior.restrict(K * interior.expand(unit, 3), 3);
    }
  }
  double scale(VectorIn w) const { return system.force(at(w)).norm(); }
  const Vector& metric() const { return mass; }
};

}  // namespace supple::test

#pragma once
// A subspace of one's own: polynomials of the rest positions, which vanish where the object is held.

#include <reduction/subspace/subspace_builder.hpp>

#include <algorithm>

/// The scalar fields x^i y^j z^k with i + j + k <= degree, times the distance to the nearest held node, times I₃: so
/// displacements of all nodes are W Q, and every stage takes the short way through the few columns of W.
struct PolynomialBasis {
  supple::Index degree = 3;

  supple::NodalBasis operator()(const supple::RestState& object) const {
    object.require_space();
    const supple::Points& X = object.positions;
    const Eigen::RowVector3d lower = X.colwise().minCoeff(), extent = X.colwise().maxCoeff() - lower;
    supple::RowMatrix W(X.rows(), (degree + 1) * (degree + 2) * (degree + 3) / 6);
    for (supple::Index v = 0; v < X.rows(); ++v) {
      double away = object.numbering.fixed_nodes().empty() ? 1 : extent.norm();
      for (const supple::Index held : object.numbering.fixed_nodes())
        away = std::min(away, (X.row(v) - X.row(held)).norm());
      const Eigen::RowVector3d x = (X.row(v) - lower) / extent.maxCoeff();
      supple::Index column = 0;
      for (int i = 0; i <= degree; ++i)
        for (int j = 0; i + j <= degree; ++j)
          for (int k = 0; i + j + k <= degree; ++k)
            W(v, column++) = away * std::pow(x[0], i) * std::pow(x[1], j) * std::pow(x[2], k);
    }
    return {supple::mass_orthonormalize(W, object.nodal_mass).W, {}};
  }
};
static_assert(supple::SubspaceBuilder<PolynomialBasis>);

#include <core/check.hpp>
#include <numerics/eigen/eigensolver.hpp>
#include <reduction/basis/kept_modes.hpp>
#include <reduction/basis/skinning_modes.hpp>
#include <reduction/subspace/rigid_modes.hpp>

#include <cmath>
#include <vector>

namespace supple {

namespace {

/// L_ab = tr K_ab over the free nodes.
SparseMatrix traces_of_blocks(const SparseMatrix& K) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(K.nonZeros() / 3);
  for (Index j = 0; j < K.cols(); ++j)
    for (SparseMatrix::InnerIterator it(K, j); it; ++it)
      if (it.row() % 3 == j % 3) entries.emplace_back(it.row() / 3, j / 3, it.value());
  SparseMatrix L(K.rows() / 3, K.cols() / 3);
  L.setFromTriplets(entries.begin(), entries.end());
  return L;
}

/// On each free part a constant of unit mass norm, over the free nodes.
Matrix constants(const FreeComponents& components, const NodeNumbering& numbering, const Vector& mass) {
  Matrix fields = Matrix::Zero(numbering.num_free(), static_cast<Index>(components.free.size()));
  for (Index k = 0; k < fields.cols(); ++k) {
    for (Index v = 0; v < fields.rows(); ++v)
      if (components.components.of_node[numbering.free_nodes()[v]] == components.free[k]) fields(v, k) = 1;
    fields.col(k) /= std::sqrt(fields.col(k).dot(mass));
  }
  return fields;
}

}  // namespace

SkinningWeights SkinningModes::weights(const RestState& object) const {
  const NodeNumbering& numbering = object.numbering;
  const FreeComponents components = find_free_components(object.stencils, object.stencil_size, numbering);
  const Index num_constant = static_cast<Index>(components.free.size());
  require(num_weights >= std::max<Index>(1, num_constant),
          "number of weights is " + std::to_string(num_weights) + ", expected at least " +
              std::to_string(std::max<Index>(1, num_constant)) + ": one for each part that nothing holds");
  require(num_weights <= numbering.num_free(), "number of weights is " + std::to_string(num_weights) + ", but only " +
                                                   std::to_string(numbering.num_free()) + " nodes are free");
  const Vector mass = object.mass(Eigen::seqN(0, numbering.num_free(), 3));
  Matrix W(numbering.num_free(), num_weights);
  SkinningWeights result{{}, Vector::Zero(num_weights), Vector::Zero(num_weights)};
  W.leftCols(num_constant) = constants(components, numbering, mass);
  if (const Index more = num_weights - num_constant; more > 0) {
    const auto inputs = [&](Digest& digest) {
      digest.add(object.K).add(mass).add(Matrix(W.leftCols(num_constant))).add(more).add(tolerance).add(seed);
    };
    const EigenPairs pairs = checkpoint.keep("skinning-weights", inputs, [&] {
      EigenPairs found =
          smallest_eigenpairs(traces_of_blocks(object.K), mass, W.leftCols(num_constant),
                              {.num_modes = more, .tolerance = tolerance, .seed = seed, .progress = progress});
      if (found.report.status != Status::Converged)
        throw SolverError("skinning modes: only " + std::to_string(found.omega_squared.size()) + " of " +
                          std::to_string(more) + " weights found");
      return found;
    });
    W.rightCols(more) = pairs.vectors;
    result.lambda.tail(more) = pairs.omega_squared.cwiseMax(0);
    result.residuals.tail(more) = pairs.residuals;
  }
  result.W = Matrix::Zero(numbering.num_nodes(), num_weights);
  for (Index v = 0; v < W.rows(); ++v) result.W.row(numbering.free_nodes()[v]) = W.row(v);
  return result;
}

NodalBasis SkinningModes::operator()(const RestState& object) const {
  object.require_space();
  const SkinningWeights blend = weights(object);
  // affine functions of order one, so that dependence shows
  const Eigen::RowVector3d centre = object.positions.colwise().mean();
  const Points centred = object.positions.rowwise() - centre;
  const Points X = centred / centred.rowwise().norm().maxCoeff();
  RowMatrix fields(X.rows(), 4 * num_weights);
  for (Index k = 0; k < num_weights; ++k) {
    fields.col(4 * k) = blend.W.col(k);
    for (int x = 0; x < 3; ++x) fields.col(4 * k + 1 + x) = blend.W.col(k).cwiseProduct(X.col(x));
  }
  Orthonormalized orthonormal = mass_orthonormalize(fields, object.nodal_mass);
  SubspaceReport report;
  report.dropped = 3 * orthonormal.dropped;
  return {std::move(orthonormal.W), std::move(report)};
}

}  // namespace supple

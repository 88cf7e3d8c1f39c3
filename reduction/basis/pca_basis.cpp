#include <core/check.hpp>
#include <numerics/linear/tall_qr.hpp>
#include <reduction/basis/pca_basis.hpp>

#include <Eigen/SVD>

#include <cmath>

namespace supple {

DenseBasis PcaBasis::operator()(const RestState& object) const {
  const Index node_dim = object.node_dim;
  require_size("snapshots.rows()", snapshots.rows(), node_dim * object.numbering.num_nodes());
  require(snapshots.cols() > 0, "there are no snapshots");
  require(snapshots.allFinite(), "a snapshot has an entry that is not finite");
  require(dimension >= 0, "the dimension is " + std::to_string(dimension) + ", expected at least 0");
  require(energy > 0 && energy <= 1, "the share of energy is " + std::to_string(energy) + ", expected (0, 1]");
  const double largest = snapshots.cwiseAbs().maxCoeff();
  require(largest > 0, "all snapshots are zero");
  constexpr double rounding = 1e-6;  // of the largest displacement, in single precision
  for (const Index v : object.numbering.fixed_nodes())
    require(snapshots.middleRows(node_dim * v, node_dim).cwiseAbs().maxCoeff() <= rounding * largest,
            "a snapshot moves node " + std::to_string(v) + ", which is fixed");
  for (const Index i : object.numbering.held_unknowns()) {
    const Index v = object.numbering.free_nodes()[i / 3];
    require(snapshots.row(3 * v + i % 3).cwiseAbs().maxCoeff() <= rounding * largest,
            "a snapshot moves node " + std::to_string(v) + " along " + "xyz"[i % 3] + ", where it is held");
  }

  const double unit = std::ldexp(1.0, std::ilogb(largest));  // so that squares are numbers
  const Vector root = object.mass.cwiseSqrt();
  const Matrix weighted = root.asDiagonal() * object.restrict(snapshots / unit);
  const ThinQr qr = tall_qr(weighted);
  const Eigen::BDCSVD<Matrix> svd(qr.R, Eigen::ComputeThinU);
  const Vector& sigma = svd.singularValues();
  SubspaceReport report;
  report.singular_values = unit * sigma;
  constexpr double smallest = 1e-12;  // of the largest singular value
  Index rank = 0;
  while (rank < sigma.size() && sigma[rank] > smallest * sigma[0]) ++rank;
  report.dropped = snapshots.cols() - rank;
  Index too_small = 0;
  for (Index t = 0; t < weighted.cols(); ++t)
    if (!snapshots.col(t).isZero(0) && weighted.col(t).norm() <= smallest * sigma[0]) ++too_small;
  if (too_small > 0)
    report.notes.push_back(std::to_string(too_small) + " of " + std::to_string(snapshots.cols()) +
                           " snapshots are left out: they are smaller than 1e-12 of the largest");
  Index d = dimension > 0 ? std::min(dimension, rank) : rank;
  if (energy < 1) {
    double left_out = sigma.tail(sigma.size() - d).squaredNorm();
    const double allowed = (1 - energy) * sigma.squaredNorm();
    while (d > 1 && left_out + sigma[d - 1] * sigma[d - 1] <= allowed) {
      left_out += sigma[d - 1] * sigma[d - 1];
      --d;
    }
  }
  if (dimension > rank)
    report.notes.push_back("the snapshots span " + std::to_string(rank) + " dimensions, fewer than the " +
                           std::to_string(dimension) + " asked for");
  const Matrix U = root.cwiseInverse().asDiagonal() * (qr.Q * svd.matrixU().leftCols(d));
  return {object.expand(U), std::move(report)};
}

}  // namespace supple

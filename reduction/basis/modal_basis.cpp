#include <core/check.hpp>
#include <reduction/basis/kept_modes.hpp>
#include <reduction/basis/modal_basis.hpp>

#include <cmath>

namespace supple {

VibrationModes vibration_modes(const RestState& object, const ModeOptions& options) {
  const NodeNumbering& numbering = object.numbering;
  const Vector& mass = object.mass;
  const Index node_dim = object.node_dim;
  VibrationModes result;
  result.components = find_free_components(object.stencils, object.stencil_size, numbering);
  const Index n = numbering.num_nodes();
  if (object.positions.rows() != n || node_dim != 3) result.components.free.clear();
  Matrix rigid(mass.size(), 0);
  if (result.components.num_rigid_modes() > 0) {
    const Matrix all = rigid_modes(object.positions, result.components);
    Matrix over_unknowns(mass.size(), all.cols());
    for (Index j = 0; j < all.cols(); ++j) over_unknowns.col(j) = numbering.restrict(all.col(j), node_dim);
    rigid = mass_orthonormalize(over_unknowns, mass).W;  // a part on a line turns about it without moving
  }
  result.num_rigid = rigid.cols();
  const Index num_flexible = options.num_modes - result.num_rigid;
  require(options.num_modes >= 1, "number of modes is " + std::to_string(options.num_modes) + ", expected at least 1");
  require(num_flexible >= 1, "the object has " + std::to_string(result.num_rigid) + " rigid motions (" +
                                 std::to_string(result.components.free.size()) +
                                 " parts that nothing holds), so at least " + std::to_string(result.num_rigid + 1) +
                                 " modes are needed, not " + std::to_string(options.num_modes));
  const Index free_unknowns = mass.size() - static_cast<Index>(numbering.held_unknowns().size());
  require(options.num_modes <= free_unknowns, "number of modes is " + std::to_string(options.num_modes) +
                                                  ", but the system has only " + std::to_string(free_unknowns) +
                                                  " unknowns");

  const auto inputs = [&](Digest& digest) {
    digest.add(object.K).add(mass).add(rigid).add(num_flexible).add(options.tolerance).add(options.seed);
  };
  const EigenPairs pairs = options.checkpoint.keep("modes", inputs, [&] {
    EigenPairs found = smallest_eigenpairs(object.K, mass, rigid,
                                           {.num_modes = num_flexible,
                                            .tolerance = options.tolerance,
                                            .seed = options.seed,
                                            .progress = options.progress});
    if (found.report.status != Status::Converged)
      throw SolverError("vibration modes: only " + std::to_string(found.omega_squared.size()) + " of " +
                        std::to_string(num_flexible) + " pairs found, largest residual " +
                        std::to_string(found.report.residual));
    return found;
  });

  result.vectors.resize(n * node_dim, rigid.cols() + num_flexible);
  for (Index j = 0; j < rigid.cols(); ++j) result.vectors.col(j) = numbering.expand(rigid.col(j), node_dim);
  for (Index j = 0; j < num_flexible; ++j)
    result.vectors.col(rigid.cols() + j) = numbering.expand(pairs.vectors.col(j), node_dim);
  result.omega = Vector::Zero(result.vectors.cols());
  result.omega.tail(num_flexible) = pairs.omega_squared.cwiseMax(0).cwiseSqrt();
  result.residuals = Vector::Constant(result.vectors.cols(), pairs.rigid_residual);
  result.residuals.tail(num_flexible) = pairs.residuals;
  result.num_zero = rigid.cols() + pairs.extra_zero_modes;
  if (pairs.extra_zero_modes > 0)
    result.notes.push_back(
        std::to_string(result.num_zero) + " motions cost no energy where " + std::to_string(result.num_rigid) +
        " rigid ones were expected: the object has hinges (parts that share only a node or an edge), or "
        "its fixed nodes do not hold it");
  if (pairs.missed > 0)
    result.notes.push_back(std::to_string(pairs.missed) +
                           " modes of repeated frequency were found by the completeness check");
  return result;
}

NodalBasis extend_modes(const VibrationModes& modes, const Points& rest_positions, const Vector& nodal_mass) {
  const Index n = nodal_mass.size();
  require_size("modes.vectors", modes.vectors.rows(), 3 * n);
  const RowMatrix affine = affine_fields(rest_positions, modes.components);
  const Index num_flexible = modes.vectors.cols() - modes.num_rigid;
  RowMatrix fields(n, affine.cols() + 3 * num_flexible);
  fields.leftCols(affine.cols()) = affine;
  for (Index i = 0; i < num_flexible; ++i) {
    const Eigen::Map<const Points> mode(modes.vectors.col(modes.num_rigid + i).data(), n, 3);
    fields.middleCols(affine.cols() + 3 * i, 3) = mode;
  }
  Orthonormalized orthonormal = mass_orthonormalize(fields, nodal_mass);
  SubspaceReport report = modes.report();
  report.dropped = 3 * orthonormal.dropped;
  return {std::move(orthonormal.W), std::move(report)};
}

}  // namespace supple

#include <app/report/terminal.hpp>
#include <app/scene/coloured_picture.hpp>
#include <app/scene/scene.hpp>
#include <core/check.hpp>

#include <Eigen/Cholesky>

#include <numbers>

namespace supple {

namespace {

constexpr double reach = 0.1;  // of the diagonal

/// Accelerations of the nodes, n × 3, and where they lead at rest by linear theory.
struct Pull {
  Points acceleration, displacement;
};

template <Subspace S>
Pull sideways(const ReducedModel& model, const S& subspace, const Vector& mass, int& axis) {
  const Eigen::LDLT<Matrix> stiffness(model.rest_stiffness);
  Pull pull;
  double most = 0;
  for (int x = 0; x < 3; ++x) {
    Points force = Points::Zero(mass.size(), 3);
    force.col(x) = mass;
    const Vector f = subspace.project(force.template reshaped<Eigen::RowMajor>());
    const Vector q = stiffness.solve(f);
    if (!(f.dot(q) > most)) continue;
    most = f.dot(q);
    axis = x;
    pull.displacement = as_points(subspace.reconstruct(q));
    pull.acceleration = Points::Zero(mass.size(), 3);
    pull.acceleration.col(x).setOnes();
  }
  if (!(most > 0)) throw SolverError("the model does not give way to gravity");
  return pull;
}

template <Subspace S>
Pull along_mode(const S& subspace, const Vector& phi, double omega) {
  const Points mode = as_points(subspace.reconstruct(phi));
  return {mode, mode / (omega * omega)};
}

}  // namespace

Scene pluck_scene(const ReducedModel& model) {
  const ReducedModes modes = reduced_modes(model);
  if (modes.num_zero == modes.omega.size()) throw SolverError("the model has no flexible mode to pluck");
  const double omega = modes.omega[modes.num_zero], period = 2 * std::numbers::pi / omega;
  const Vector mass = nodal_mass(model.body);
  int axis = -1;
  Pull pull = std::visit(
      [&](const auto& subspace) {
        return modes.num_zero == 0 ? sideways(model, *subspace, mass, axis)
                                   : along_mode(*subspace, modes.Phi.col(modes.num_zero), omega);
      },
      model.subspace);
  Index farthest = 0;
  const double length = std::sqrt(pull.displacement.rowwise().squaredNorm().maxCoeff(&farthest));
  // a constant pull that ends after half a period moves a linear object by twice the static displacement
  const double scale = reach * bounding_box(node_positions(model.body)).diagonal() / (2 * length);

  Scene scene;
  scene.duration = 3 * period;
  scene.step = period / 60;
  scene.track = {farthest};
  TimedLoads timed{{}, {.from = 0, .until = period / 2}};
  if (axis >= 0) {
    timed.loads.gravity = scale * Point::Unit(axis);
    scene.description = "pulled along " + std::string(1, "xyz"[axis]) + " with " + shown(scale, 3) + " m/s^2";
  } else {
    for (Index v = 0; v < mass.size(); ++v)
      timed.loads.forces.push_back({v, scale * mass[v] * pull.acceleration.row(v).transpose()});
    scene.description = "bent along its softest mode";
  }
  scene.description += " for " + shown(period / 2, 3) + " s, then released";
  scene.loads.push_back(std::move(timed));
  return scene;
}

}  // namespace supple

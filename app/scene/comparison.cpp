#include <app/scene/coloured_picture.hpp>
#include <app/scene/comparison.hpp>

#include <cmath>
#include <limits>

namespace supple {

double Deviation::ratio(double error, double size) {
  return size > 0 ? error / size : error > 0 ? std::numeric_limits<double>::quiet_NaN() : 0;
}

Vector Deviation::share() const {
  return difference.unaryExpr([size = reference.maxCoeff()](double error) { return ratio(error, size); });
}

Comparison compare(const Motion& motion, const Motion& reference, std::span<const std::pair<Index, Index>> frames,
                   const Progress& progress) {
  const auto& [a, model_a] = motion;
  const auto& [b, model_b] = reference;
  const Vector mass = nodal_mass(model_b.body);
  const auto norm = [&](const Vector& field) { return std::sqrt(as_points(field).rowwise().squaredNorm().dot(mass)); };
  Comparison result(static_cast<Index>(frames.size()));
  for (Index k = 0; k < result.time.size(); ++k) {
    const auto [f, g] = frames[static_cast<std::size_t>(k)];
    result.time[k] = b.time[g];
    const Vector u = frame_displacement(b, model_b, g), du = frame_displacement(a, model_a, f) - u;
    const Vector v = frame_velocity(b, model_b, g), dv = frame_velocity(a, model_a, f) - v;
    result.position.difference[k] = norm(du);
    result.position.reference[k] = norm(u);
    result.velocity.difference[k] = norm(dv);
    result.velocity.reference[k] = norm(v);
    const double energy = b.kinetic[g] + b.elastic[g];
    result.energy.difference[k] = std::abs(a.kinetic[f] + a.elastic[f] - energy);
    result.energy.reference[k] = std::abs(energy);
    result.largest_distance[k] = std::sqrt(as_points(du).rowwise().squaredNorm().maxCoeff());
    tell(progress, "frames", static_cast<double>(k + 1) / static_cast<double>(result.time.size()));
  }
  return result;
}

}  // namespace supple

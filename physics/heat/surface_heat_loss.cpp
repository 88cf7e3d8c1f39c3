#include <core/check.hpp>
#include <physics/heat/surface_heat_loss.hpp>

#include <Eigen/Geometry>

#include <cmath>

namespace supple {

SurfaceHeatLoss::SurfaceHeatLoss(const Points& positions, std::vector<Triangle> triangles,
                                 const SurfaceExchange& exchange)
    : num_nodes_(positions.rows()), triangles_(std::move(triangles)) {
  constexpr double stefan_boltzmann = 5.670374419e-8;  // [W/(m² K⁴)]
  require(std::isfinite(exchange.film) && exchange.film >= 0,
          "film coefficient is " + std::to_string(exchange.film) + " W/(m^2 K), expected at least 0");
  require(exchange.emissivity >= 0 && exchange.emissivity <= 1,
          "emissivity is " + std::to_string(exchange.emissivity) + ", expected 0 to 1");
  require(exchange.film > 0 || exchange.emissivity > 0, "the surface exchanges no heat");
  require(std::isfinite(exchange.ambient) && exchange.ambient > 0,
          "absolute temperature is " + std::to_string(exchange.ambient) + " K, expected > 0");
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (const Index v : triangles_[t])
      require(v >= 0 && v < num_nodes_, "triangle " + std::to_string(t) + " names node " + std::to_string(v) +
                                            ", expected 0 to " + std::to_string(num_nodes_ - 1));
    const Point a = positions.row(triangles_[t][0]), b = positions.row(triangles_[t][1]),
                c = positions.row(triangles_[t][2]);
    const double area = (b - a).cross(c - a).norm() / 2;
    require(area > 0, "triangle " + std::to_string(t) + " has no area");
    terms_.push_back({area, exchange.film, exchange.emissivity * stefan_boltzmann, exchange.ambient});
  }
}

}  // namespace supple

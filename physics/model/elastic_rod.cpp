#include <physics/model/elastic_rod.hpp>

#include <cmath>
#include <numbers>
#include <string>

namespace supple {

namespace {

/// Turns below this [rad] are those of rounded coordinates: the rod counts as straight. κ ≈ φ.
constexpr double straight = 1e-6;

}  // namespace

RodMaterial RodMaterial::from(double young, double radius) {
  require(young > 0, "Young's modulus is " + std::to_string(young) + " Pa, expected > 0");
  require(radius > 0, "radius of the rod is " + std::to_string(radius) + " m, expected > 0");
  const double area = std::numbers::pi * radius * radius;
  return {.stretch = young * area, .bending = young * area * radius * radius / 4};
}

void RodMaterial::check() const {
  const bool fits = stretch >= 0 && bending >= 0 && stretch + bending > 0 && std::isfinite(stretch + bending);
  require(fits, "rod with E A = " + std::to_string(stretch) + " N and E I = " + std::to_string(bending) +
                    " N m^2, expected finite values >= 0, one of them > 0");
}

ElasticRod::ElasticRod(const Points& nodes, const std::vector<std::vector<Index>>& polylines,
                       const std::vector<RodMaterial>& materials)
    : rest_positions_(nodes) {
  require(materials.size() == 1 || materials.size() == polylines.size(),
          std::to_string(materials.size()) + " materials for " + std::to_string(polylines.size()) +
              " rods, expected one for all or one each");
  for (const RodMaterial& material : materials) material.check();
  for (std::size_t k = 0; k < polylines.size(); ++k)
    add_polyline(polylines[k], materials[materials.size() == 1 ? 0 : k], "rod " + std::to_string(k));
}

void ElasticRod::add_polyline(const std::vector<Index>& polyline, const RodMaterial& material,
                              const std::string& name) {
  for (const Index v : polyline)
    require(v >= 0 && v < num_nodes(),
            name + " names node " + std::to_string(v) + ", expected 0 to " + std::to_string(num_nodes() - 1));
  const Index n = static_cast<Index>(polyline.size());
  const bool closed = n > 1 && polyline.front() == polyline.back();
  require(n >= (closed ? 4 : 3), name + " has no inner node: it cannot bend; a spring is what it could be");
  for (Index k = 1; k < n - 1; ++k) {
    const bool first = !closed && k == 1, last = !closed && k == n - 2;
    add_bend({polyline[k - 1], polyline[k], polyline[k + 1]}, material, {first ? 1.0 : 0.5, last ? 1.0 : 0.5}, name);
  }
  if (closed) add_bend({polyline[n - 2], polyline[0], polyline[1]}, material, {0.5, 0.5}, name);
}

void ElasticRod::add_bend(const std::array<Index, 3>& nodes, const RodMaterial& material,
                          const std::array<double, 2>& shares, const std::string& name) {
  const auto [a, b, c] = nodes;
  Point e = (rest_positions_.row(b) - rest_positions_.row(a)).transpose();
  Point f = (rest_positions_.row(c) - rest_positions_.row(b)).transpose();
  const double l_e = e.norm(), l_f = f.norm();
  const std::string at = name + " at node " + std::to_string(b);
  require(l_e > 0 && l_f > 0, at + " has an edge without length");
  Point rest_cross = detail::cross(e, f);
  const double cosine = detail::dot(e, f) / (l_e * l_f), sine = rest_cross.norm() / (l_e * l_f);
  require(cosine > 0 || sine > straight, at + " folds back onto itself");
  double rest_bend = 2 * sine / (1 + cosine);
  if (rest_bend < straight) {  // then exactly so: otherwise rounding would choose the plane in which the rod resists
    const Point along = (e + f).normalized();
    e = l_e * along;
    f = l_f * along;
    rest_cross.setZero();
    rest_bend = 0;
  }
  Term<double> term{};
  for (int i = 0; i < 3; ++i) {
    term.rest[i] = e[i];
    term.rest[3 + i] = f[i];
    term.rest_cross[i] = rest_cross[i];
  }
  term.rest_length = {l_e, l_f};
  term.spring = {shares[0] * material.stretch / l_e, shares[1] * material.stretch / l_f};
  term.bending = 2 * material.bending / (l_e + l_f);
  term.rest_bend = rest_bend;
  stencils_.push_back(nodes);
  terms_.push_back(term);
}

}  // namespace supple

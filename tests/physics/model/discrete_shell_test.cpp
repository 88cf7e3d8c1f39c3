#include <numerics/optimize/newton.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/discrete_shell.hpp>
#include <physics/statics/equilibrium.hpp>
#include <physics/system/full_system.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/force_models.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/rounding.hpp>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace supple::test {
namespace {

using Mat3 = Matrix3<double>;
constexpr double pi = std::numbers::pi;

/// Two triangles at the edge (0, 0, 0) … (1, 0, 0): d turned away by the hinge angle θ from the plane of c.
/// Heights may be negative: then the triangle is inverted.
Points hinge(double theta, double height_c = 0.7, double height_d = 0.9) {
  Points nodes(4, 3);
  nodes << 0, 0, 0,      //
      1, 0, 0,           //
      0.3, height_c, 0,  //
      0.6, -height_d * std::cos(theta), -height_d * std::sin(theta);
  return nodes;
}
DiscreteShell hinge_shell(double rest_angle, const ShellMaterial& material) {
  return {{hinge(rest_angle), {{0, 1, 2}, {1, 0, 3}}}, material};
}
Local<12> displacement(const Points& from, const Points& to) {
  const Points u = to - from;
  return Eigen::Map<const Local<12>>(u.data());
}
/// θ − θ̄ for the hinge as it stands.
double bend_at(const DiscreteShell& shell, const Points& nodes) {
  return shell.term(0).bend(displacement(shell.rest_positions(), nodes));
}
double wrapped(double angle) {
  return std::remainder(angle, 2 * pi);
}

constexpr ShellMaterial all_terms{.bending = 0.8, .stretch = 3, .area = 2};
const double rest_angles[] = {0, 0.5, -1.2, 2.9, -3.0, pi};

TEST(DiscreteShell, MeasuresTheHingeAngleFromTheRestAngleWithoutJumpAtPi) {
  for (const double rest : rest_angles) {
    const DiscreteShell shell = hinge_shell(rest, all_terms);
    for (int k = -62; k <= 62; ++k) {
      const double bend = 0.05 * k;
      EXPECT_NEAR(bend_at(shell, hinge(rest + bend)), bend, 1e-14) << rest;
    }
  }
  EXPECT_GT(bend_at(hinge_shell(0, all_terms), hinge(0.1)), 0) << "convex on the side of the normals";
}

TEST(DiscreteShell, InvertedTrianglesAreHingesFoldedOver) {
  const DiscreteShell shell = hinge_shell(0.4, all_terms);
  EXPECT_NEAR(bend_at(shell, hinge(0.7, -0.5)), wrapped(0.3 + pi), 1e-14);
  EXPECT_NEAR(bend_at(shell, hinge(0.7, 0.5, -0.2)), wrapped(0.3 + pi), 1e-14);
  EXPECT_NEAR(bend_at(shell, hinge(0.7, -0.5, -0.2)), 0.3, 1e-14);
}

/// Flat, folded to both sides of π, through it, inverted and distorted states of the hinge; none within 0.02
/// of the kink opposite to the rest angle.
std::vector<Points> difficult_states(double rest) {
  std::vector<Points> states;
  for (const double theta : {0.0, 1e-9, 0.3, 2.0, pi - 0.01, pi - 1e-9, pi, pi + 1e-9, pi + 0.01, 4.0, 6.0})
    for (const auto& [c, d] : {std::pair{0.7, 0.9}, {0.4, 1.3}, {-0.6, 0.9}, {0.7, -0.5}, {-0.6, -0.5}})
      if (const bool is_over = c * d < 0; std::abs(wrapped(theta + (is_over ? pi : 0) - rest)) < pi - 0.02)
        states.push_back(hinge(theta, c, d));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Points state = hinge(rest) + Points(random_matrix(4, 3, 0.5, seed));
    const auto area = [&](int k) {
      const Point e = (state.row(1) - state.row(0)).transpose();
      return e.cross(Point((state.row(k) - state.row(0)).transpose())).norm();
    };
    if (std::min(area(2), area(3)) > 0.15) states.push_back(state);
  }
  return states;
}

// Central differences err by h² times third derivatives, which grow as 1/height³ ~ 100, and by rounding / h:
// with h = 1e-5 both stay below 1e-8 of the coefficients.
TEST(DiscreteShell, ForceAndTangentAreDerivativesInFlatFoldedAndInvertedStates) {
  constexpr double h = 1e-5, tolerance = 1e-6;
  for (const double rest : rest_angles)
    for (const ShellMaterial& material : {all_terms, ShellMaterial{.bending = 1, .stretch = 1e-9, .area = 0},
                                          ShellMaterial{.bending = 0, .stretch = 1e-9, .area = 1},
                                          ShellMaterial{.bending = 0, .stretch = 1, .area = 0}}) {
      const DiscreteShell shell = hinge_shell(rest, material);
      const std::vector<Points> states = difficult_states(rest);
      ASSERT_GT(states.size(), 30u);
      for (std::size_t s = 0; s < states.size(); ++s) {
        SCOPED_TRACE("rest angle " + std::to_string(rest) + ", state " + std::to_string(s) + ", bending " +
                     std::to_string(material.bending) + ", area " + std::to_string(material.area));
        const Local<12> u = displacement(shell.rest_positions(), states[s]);
        Local<12> force;
        LocalMatrix<12> stiffness;
        for (int j = 0; j < 12; ++j) {
          const Local<12> step = h * Local<12>::Unit(j);
          force[j] = (shell.energy(0, u + step) - shell.energy(0, u - step)) / (2 * h);
          stiffness.col(j) = (shell.force(0, u + step) - shell.force(0, u - step)) / (2 * h);
        }
        const LocalMatrix<12> K = shell.stiffness(0, u);
        EXPECT_TRUE(is_near(shell.force(0, u), force, tolerance));
        EXPECT_TRUE(is_near(K, stiffness, tolerance * std::max(1.0, K.cwiseAbs().maxCoeff())));
        EXPECT_TRUE(is_same(K, K.transpose()));
        if (testing::Test::HasFailure()) return;
      }
    }
}

TEST(DiscreteShell, EnergyAndForceAreFiniteWhereTrianglesAndEdgesHaveCollapsed) {
  const DiscreteShell shell = hinge_shell(0.5, all_terms);
  std::vector<Points> states{hinge(0.5, 0.0), hinge(0.5, 0.7, 0.0), hinge(0.5, 0.0, 0.0), Points::Zero(4, 3)};
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < a; ++b) {
      states.push_back(hinge(0.5));
      states.back().row(a) = states.back().row(b);
    }
  for (std::size_t s = 0; s < states.size(); ++s) {
    const Local<12> u = displacement(shell.rest_positions(), states[s]);
    EXPECT_TRUE(std::isfinite(shell.energy(0, u))) << "state " << s;
    EXPECT_TRUE(shell.force(0, u).allFinite()) << "state " << s;
    EXPECT_TRUE(shell.stiffness(0, u).allFinite()) << "state " << s;
  }
}

/// The energy as notation.md states it: edges and triangles once each, with no notion of flaps but for
/// hinges.
double energy_by_parts(const TriangleMesh& mesh, const Points& moved, const std::vector<ShellMaterial>& of) {
  double energy = 0;
  TriangleMesh now = mesh;
  now.nodes = moved;
  const std::vector<Index> neighbour = neighbour_sides(mesh);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const double area = triangle_area(mesh, t), ratio = triangle_area(now, t) / area;
    energy += 0.5 * of[t].area * area * (ratio - 1) * (ratio - 1);
    for (int k = 0; k < 3; ++k) {  // a third of the area of t goes to each of its edges
      const Index from = mesh.triangles[t][k], to = mesh.triangles[t][(k + 1) % 3];
      const double stretch =
          (moved.row(to) - moved.row(from)).norm() / (mesh.nodes.row(to) - mesh.nodes.row(from)).norm() - 1;
      energy += 0.5 * of[t].stretch * area / 3 * stretch * stretch;
    }
  }
  for (const Flap& flap : interior_edges(mesh)) {
    const auto angle = [&](const TriangleMesh& m) {
      const auto at = [&](int k) { return Point(m.nodes.row(flap.nodes[k])); };
      const Point n1 = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
      const Point n2 = (at(0) - at(1)).cross(at(3) - at(1)).normalized();
      return std::atan2(n1.cross(n2).dot((at(1) - at(0)).normalized()), n1.dot(n2));
    };
    const auto [t1, t2] = flap.triangles;
    const double a1 = triangle_area(mesh, t1), a2 = triangle_area(mesh, t2);
    const double bending = (a1 + a2) / (a1 / of[t1].bending + a2 / of[t2].bending);
    const double length = (mesh.nodes.row(flap.nodes[1]) - mesh.nodes.row(flap.nodes[0])).norm();
    const double bend = wrapped(angle(now) - angle(mesh));
    energy += bending * 3 * length * length / (a1 + a2) * bend * bend;
  }
  return energy;
}

TEST(DiscreteShell, FlapsShareEveryEdgeAndTriangleSoThatEachCountsOnce) {
  const auto check = [](const TriangleMesh& mesh) {
    std::vector<ShellMaterial> materials;
    for (Index t = 0; t < mesh.num_triangles(); ++t) {
      const double k = 1 + static_cast<double>(t);
      materials.push_back({.bending = 0.1 * k, .stretch = 50 / k, .area = 7 + k});
    }
    const FullSystem<DiscreteShell> system(DiscreteShell(mesh, materials), lumped_mass(mesh, 1.0, 1.0));
    const Vector u = random_vector(system.dim(), 0.02, 5);
    const Points moved = mesh.nodes + Eigen::Map<const Points>(u.data(), mesh.num_nodes(), 3);
    const double energy = energy_by_parts(mesh, moved, materials);
    EXPECT_NEAR(system.energy(u), energy, rounding * energy);
  };
  check(FlatShell::mesh());
  check(ClosedShell::mesh());
  check(CurvedShell::mesh());
  check(square_grid(1, 1));
  check(equilateral_grid(2, 1));
}

TEST(DiscreteShell, RigidMotionsChangeNothing) {
  const TriangleMesh mesh = CurvedShell::mesh();
  const FullSystem<DiscreteShell> system(CurvedShell::make(), CurvedShell::nodal_mass());
  const double scale = system.rest_stiffness().norm() * CurvedShell::length * CurvedShell::length;
  const Vector w = random_vector(system.dim(), 0.1 * CurvedShell::length, 3);
  const Points deformed = mesh.nodes + Eigen::Map<const Points>(w.data(), mesh.num_nodes(), 3);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Mat3 R = random_rotation(seed);
    const Vector rigid = affine_displacement(mesh.nodes, R, {0.3, -2, 1});
    EXPECT_NEAR(system.energy(rigid), 0, rounding * scale);
    EXPECT_TRUE(is_near(system.force(rigid), Vector::Zero(rigid.size()), rounding * scale / CurvedShell::length));
    const Vector u = w + affine_displacement(deformed, R, {1, 2, -1});
    EXPECT_NEAR(system.energy(u), system.energy(w), rounding * scale);
    const Vector f_w = system.force(w), f_u = system.force(u);
    for (Index v = 0; v < mesh.num_nodes(); ++v)
      EXPECT_TRUE(is_near(f_u.segment<3>(3 * v), R * f_w.segment<3>(3 * v), rounding * scale));
  }
}

TEST(DiscreteShell, InternalForcesHaveNoResultantAndNoMoment) {
  const TriangleMesh mesh = FlatShell::mesh();
  const FullSystem<DiscreteShell> system(FlatShell::make(), FlatShell::nodal_mass());
  const Vector u = random_vector(system.dim(), 0.05, 4), f = system.force(u);
  Point resultant = Point::Zero(), moment = Point::Zero();
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    resultant += f.segment<3>(3 * v);
    moment += (mesh.nodes.row(v).transpose() + u.segment<3>(3 * v)).cross(f.segment<3>(3 * v));
  }
  EXPECT_TRUE(is_near(resultant, Point::Zero(), rounding * f.norm()));
  EXPECT_TRUE(is_near(moment, Point::Zero(), rounding * f.norm()));
}

/// Bending energy an area [J/m²] around triangle t: its three edges stand for all edges of their directions,
/// of which every two triangles have one each.
template <typename Move>
double bending_density(const TriangleMesh& mesh, Index t, double bending, const Move& move) {
  const DiscreteShell shell(mesh, {.bending = bending, .stretch = 1e-200, .area = 0});
  Vector u(3 * mesh.num_nodes());
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    const Point x = mesh.nodes.row(v);
    u.segment<3>(3 * v) = move(x) - x;
  }
  double energy = 0;
  const std::vector<Flap> flaps = interior_edges(mesh);
  int num_edges = 0;
  for (Index i = 0; i < shell.num_components(); ++i) {
    if (flaps[i].triangles[0] != t && flaps[i].triangles[1] != t) continue;
    Local<12> u_i;
    for (int a = 0; a < 4; ++a) u_i.segment<3>(3 * a) = u.segment<3>(3 * shell.stencil(i)[a]);
    energy += shell.energy(i, u_i);
    ++num_edges;
  }
  EXPECT_EQ(num_edges, 3);
  return energy / (2 * triangle_area(mesh, t));
}

// Plate theory: bending a flat sheet to a cylinder of curvature κ costs ½ D κ² an area, whatever the
// direction.
TEST(DiscreteShell, SheetBentToACylinderHasTheEnergyOfThePlate) {
  const IsotropicModuli moduli{.young = 1e6, .poisson = 0.3};
  constexpr double thickness = 0.01, kappa = 2;
  const double D = 1e6 * 1e-6 / (12 * (1 - 0.09)), expected = 0.5 * D * kappa * kappa;
  for (const double direction : {0.0, 0.2, pi / 6, 1.0, pi / 2}) {
    std::array<double, 3> error;
    for (int level = 0; level < 3; ++level) {
      const double edge = 0.1 / (1 << level);
      const double density = bending_density(
          equilateral_grid(4, 4, edge), 12, ShellMaterial::from(moduli, thickness).bending, [&](const Point& x) {
            const double s = std::cos(direction) * x[0] + std::sin(direction) * x[1];
            const double t = -std::sin(direction) * x[0] + std::cos(direction) * x[1];
            const double p = std::sin(kappa * s) / kappa, z = (1 - std::cos(kappa * s)) / kappa;
            return Point(std::cos(direction) * p - std::sin(direction) * t,
                         std::sin(direction) * p + std::cos(direction) * t, z);
          });
      error[level] = std::abs(density / expected - 1);
    }
    EXPECT_LT(error[0], (kappa * 0.1) * (kappa * 0.1)) << direction;
    EXPECT_LT(error[2], std::max(error[0] / 12, rounding))
        << "second order in the edge length: a factor of 16; " << direction;
  }
}

// The energies that the three hinge directions make of a small deflection ½ xᵀ S x, worked out in
// notation.md.
TEST(DiscreteShell, SmallCurvaturesHaveTheQuadraticEnergyOfTheMesh) {
  constexpr double scale = 1e-5, D = 6;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Vector s = random_vector(3, 1, seed);
    const double S11 = s[0], S22 = s[1], S12 = s[2];
    const auto bend = [&](const Point& x) -> Point {
      return x + Point(0, 0, scale * (S11 * x[0] * x[0] / 2 + S12 * x[0] * x[1] + S22 * x[1] * x[1] / 2));
    };
    const double trace = S11 + S22, determinant = S11 * S22 - S12 * S12;
    const double tolerance = 1e-6;  // second order in slopes of 1e-5, and rounding / slope
    // equilateral: the plate with ν = −⅓
    EXPECT_NEAR(bending_density(equilateral_grid(4, 4), 12, D / 6, bend) / (scale * scale),
                0.5 * D * (trace * trace - 2 * (1 + 1.0 / 3) * determinant), tolerance * D);
    // squares cut along (1, 1)
    EXPECT_NEAR(bending_density(square_grid(4, 4), 12, D / 6, bend) / (scale * scale),
                0.5 * D * ((S11 + S12) * (S11 + S12) + (S22 + S12) * (S22 + S12) + 4 * S12 * S12), tolerance * D);
  }
}

// Plane stress: E h / (2 (1 − ν²)) (ε₁₁² + ε₂₂² + 2 ν ε₁₁ ε₂₂ + 2 (1 − ν) ε₁₂²) an area. All triangles of the
// patch are equilateral and count a third for each edge, so this holds for the patch as a whole, boundary
// included.
TEST(DiscreteShell, SmallStretchesOfAnEquilateralPatchArePlaneStress) {
  const TriangleMesh mesh = equilateral_grid(5, 4);
  const double area = static_cast<double>(mesh.num_triangles()) * triangle_area(mesh, 0);
  constexpr double E = 2e6, h = 0.003;
  for (const double nu : {0.1, 1.0 / 3, 0.4, 0.49}) {
    const FullSystem<DiscreteShell> system(DiscreteShell(mesh, ShellMaterial::from({E, nu}, h)),
                                           lumped_mass(mesh, 1000.0, h));
    const double nu_m = std::max(nu, 1.0 / 3);  // below ⅓ the shell behaves as at ⅓
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Vector e = random_vector(3, 1, seed);
      Mat3 F = Mat3::Identity();
      F.topLeftCorner<2, 2>() += Eigen::Matrix2d{{e[0], e[2]}, {e[2], e[1]}};
      const Vector u = affine_displacement(mesh.nodes, F);
      const double density = E * h / (2 * (1 - nu_m * nu_m)) *
                             (e[0] * e[0] + e[1] * e[1] + 2 * nu_m * e[0] * e[1] + 2 * (1 - nu_m) * e[2] * e[2]);
      EXPECT_NEAR(0.5 * u.dot(system.rest_stiffness() * u), density * area, rounding * E * h * area);
    }
  }
}

/// Tip deflection of a strip 0.07 m wide, clamped over two columns of nodes at x = 0 and loaded at its tip,
/// over P L³ / (3 D b): 1 / (effective stiffness over D).
double relative_tip_deflection(const TriangleMesh& mesh, double edge, double clamped_to, double width) {
  constexpr double E = 1e9, h = 0.002, nu = 1.0 / 3;
  const std::vector<Index> fixed = nodes_where(mesh, [&](const Point& x) { return x[0] < clamped_to; });
  const double length = mesh.nodes.col(0).maxCoeff();
  const std::vector<Index> tip = nodes_where(mesh, [&](const Point& x) { return x[0] > length - 0.7 * edge; });
  double clamp = 0, load_at = 0;  // where rows are staggered: in the mean of both kinds of rows
  for (const Index v : fixed) clamp += (mesh.nodes(v, 0) - 0.5 * edge) / static_cast<double>(fixed.size());
  clamp += edge;  // the mean of the second clamped column
  for (const Index v : tip) load_at += mesh.nodes(v, 0) / static_cast<double>(tip.size());
  const double L = load_at - clamp, D = E * h * h * h / (12 * (1 - nu * nu)), P = 0.1 * h * D * width / (L * L * L);

  const FullSystem<DiscreteShell> system(DiscreteShell(mesh, ShellMaterial::from({E, nu}, h)),
                                         lumped_mass(mesh, 1000.0, h), fixed);
  Loads loads;
  for (const Index v : tip) loads.forces.push_back({v, {0, 0, P / static_cast<double>(tip.size())}});
  Equilibrium problem(system, system.project(loads));
  SpdSolver<SparseMatrix> solver;
  Vector u = Vector::Zero(system.dim());
  const Report report = Newton{}(problem, solver, u, {.tolerance = 1e-5});
  EXPECT_EQ(report.status, Status::Converged) << report.residual;
  const Vector full = system.expand(u);
  double deflection = 0;
  for (const Index v : tip) deflection += full[3 * v + 2] / static_cast<double>(tip.size());
  return deflection / (P * L * L * L / (3 * D * width));
}

// A beam of width b has the stiffness E h³ b / 12 = D (1 − ν²) b, as its edges are free to curl the other
// way; with ν = ⅓, (8/9) D b. Equilateral hinges curl the same amount to the other side (−⅓), so the beam is
// met. Errors of about 1 %, opposite in sign, come from boundary edges, which do not bend (first order in the
// mesh), and from the clamp, which hinders curling over a length of about b.
TEST(DiscreteShell, ClampedStripBendsLikeABeamUnderALoadAtItsTip) {
  for (const Index rows : {4, 8, 16}) {
    const Index columns = 12 * rows;
    const double edge = 1.0 / static_cast<double>(columns);
    EXPECT_NEAR(relative_tip_deflection(equilateral_grid(columns, rows, edge), edge, 1.8 * edge,
                                        std::sqrt(0.75) * edge * static_cast<double>(rows)),
                9.0 / 8, 0.015 * 9 / 8)
        << rows << " rows";
  }
}

// Squares that are all cut one way make a strip twist as it bends (S₁₂ = −S₁₁/5 lets the energy of
// notation.md fall to ⅘ ½ D S₁₁²), whatever ν is meant to be.
TEST(DiscreteShell, ClampedStripOfSquaresHasFourFifthsOfTheStiffnessOfThePlate) {
  constexpr Index rows = 12, columns = 12 * rows;
  constexpr double edge = 1.0 / columns;
  EXPECT_NEAR(relative_tip_deflection(square_grid(columns, rows, edge), edge, 1.2 * edge, rows * edge), 5.0 / 4,
              0.015 * 5 / 4);
}

TEST(DiscreteShell, ThicknessMayVaryByTriangle) {
  TriangleMesh mesh = square_grid(1, 1);  // one flap
  const ShellMaterial thin = ShellMaterial::from({1e6, 0.4}, 0.01), thick = ShellMaterial::from({1e6, 0.4}, 0.02);
  EXPECT_NEAR(thick.bending, 8 * thin.bending, rounding * thick.bending);
  const auto bending = [&](const ShellMaterial& a, const ShellMaterial& b) {
    return DiscreteShell(mesh, {a, b}).term(0).bending;
  };
  EXPECT_NEAR(bending(thin, thick), 2 / (1 / bending(thin, thin) + 1 / bending(thick, thick)),
              rounding * bending(thick, thick));
  EXPECT_EQ(bending(thin, thick), bending(thick, thin));
  const auto spring = [&](const ShellMaterial& a, const ShellMaterial& b) {
    return DiscreteShell(mesh, {a, b}).term(0).spring[0];
  };
  EXPECT_NEAR(spring(thin, thick), 0.5 * (spring(thin, thin) + spring(thick, thick)), rounding * spring(thick, thick));
  EXPECT_EQ(bending(thin, {.bending = 0, .stretch = 1, .area = 0}), 0);
}

TEST(DiscreteShell, RefusesMaterialsAndMeshesThatCannotBe) {
  const auto message = [](const TriangleMesh& mesh, const std::vector<ShellMaterial>& materials) -> std::string {
    try {
      DiscreteShell(mesh, materials);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  using testing::HasSubstr;
  const TriangleMesh two = square_grid(1, 1);
  EXPECT_EQ(message(two, {all_terms, all_terms}), "");
  EXPECT_THAT(message(two, {}), HasSubstr("0 materials for 2 triangles"));
  EXPECT_THAT(message(two, {all_terms, all_terms, all_terms}), HasSubstr("3 materials for 2 triangles"));
  EXPECT_THAT(message(two, {{.bending = -1, .stretch = 1, .area = 0}}), HasSubstr("bending"));
  EXPECT_THAT(message(two, {{.bending = 1, .stretch = 0, .area = 0}}), HasSubstr("stretch"));
  EXPECT_THAT(message(two, {{.bending = 1, .stretch = 1, .area = NAN}}), HasSubstr("area"));
  EXPECT_THROW((void)ShellMaterial::from({1e5, 0.3}, 0), std::invalid_argument);
  EXPECT_THROW((void)ShellMaterial::from({1e5, 0.5}, 0.1), std::invalid_argument);

  TriangleMesh alone = square_grid(2, 1);  // the last two triangles hang together with the first two by a node
  alone.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}};
  EXPECT_THAT(message(alone, {all_terms}), HasSubstr("triangle 2 shares no edge"));
  TriangleMesh turned = two;
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_THAT(message(turned, {all_terms}), HasSubstr("turned over"));
}

}  // namespace
}  // namespace supple::test

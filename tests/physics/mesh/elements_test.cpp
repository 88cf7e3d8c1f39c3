#include <numerics/linear/symmetric_eigen.hpp>
#include <numerics/optimize/newton.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/solid_elasticity.hpp>
#include <physics/statics/equilibrium.hpp>
#include <physics/system/full_system.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/boundary_values.hpp>
#include <tests/support/rounding.hpp>
#include <tests/support/solids.hpp>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <set>

namespace supple::test {
namespace {

using Mat3 = Matrix3<double>;
constexpr IsotropicModuli cell_moduli{.young = 1e5, .poisson = 0.3};
constexpr double cell_edge = 0.1;

Point point(const std::array<double, 3>& xi) {
  return {xi[0], xi[1], xi[2]};
}

/// ∫ ξ^i η^j ζ^k over the reference cell.
template <typename Element>
double monomial_integral(int i, int j, int k) {
  if constexpr (std::same_as<Element, TrilinearHex>) return 1.0 / ((i + 1) * (j + 1) * (k + 1));
  return std::tgamma(i + 1) * std::tgamma(j + 1) * std::tgamma(k + 1) / std::tgamma(i + j + k + 4);
}
double monomial(const QuadraturePoint& at, int i, int j, int k) {
  return std::pow(at.xi[0], i) * std::pow(at.xi[1], j) * std::pow(at.xi[2], k);
}
/// Integrates monomials up to `degree`, of all together or, for a hex, of each coordinate.
template <typename Element>
void expect_exact(std::span<const QuadraturePoint> rule, int degree) {
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; j <= degree; ++j)
      for (int k = 0; k <= degree; ++k) {
        if (i + j + k > degree && !std::same_as<Element, TrilinearHex>) continue;
        double sum = 0;
        for (const QuadraturePoint& at : rule) sum += at.weight * monomial(at, i, j, k);
        EXPECT_NEAR(sum, (monomial_integral<Element>(i, j, k)), 1e-15) << i << j << k;
      }
}

template <typename Element>
class ElementTest : public testing::Test {
 protected:
  static CellMesh<Element::num_nodes> straight_box(Index n) {
    auto mesh = irregular_box<Element>({n, n, n}, cell_edge);
    straighten(mesh);
    return mesh;
  }
  /// Nodes on the boundary of a box of n³ cells, by where they were before they moved.
  static std::vector<Index> box_boundary(Index n) {
    return nodes_where(box_of<Element>({n, n, n}, cell_edge), [n](const Point& x) {
      return x.minCoeff() < 1e-9 || x.maxCoeff() > cell_edge * static_cast<double>(n) - 1e-9;
    });
  }
  /// Only inner nodes moved: fills the box.
  static CellMesh<Element::num_nodes> irregular_inside(Index n) {
    auto mesh = irregular_box<Element>({n, n, n}, cell_edge);
    const auto still = box_of<Element>({n, n, n}, cell_edge);
    for (const Index v : box_boundary(n)) mesh.nodes.row(v) = still.nodes.row(v);
    return mesh;
  }
};
using Elements = testing::Types<LinearTet, QuadraticTet, TrilinearHex>;
TYPED_TEST_SUITE(ElementTest, Elements);

TYPED_TEST(ElementTest, ShapeFunctionsInterpolate) {
  constexpr int n = TypeParam::num_nodes;
  LocalMatrix<n> values;
  for (int b = 0; b < n; ++b) values.col(b) = TypeParam::shape(point(TypeParam::nodes[b]));
  EXPECT_TRUE(is_near(values, LocalMatrix<n>::Identity(), 1e-15));
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const Point xi = random_vector(3, 0.5, seed);
    const Local<n> N = TypeParam::shape(xi);
    EXPECT_NEAR(N.sum(), 1, 1e-14);
    Point again = Point::Zero();  // linear fields are theirs
    for (int a = 0; a < n; ++a) again += N[a] * point(TypeParam::nodes[a]);
    EXPECT_TRUE(is_near(again, xi, 1e-14));
    ShapeGradients<TypeParam> differences;
    constexpr double h = 1e-5;  // polynomials of degree 2 along an axis: no error but rounding
    for (int x = 0; x < 3; ++x)
      differences.col(x) =
          (TypeParam::shape(xi + h * Point::Unit(x)) - TypeParam::shape(xi - h * Point::Unit(x))) / (2 * h);
    EXPECT_TRUE(is_near(TypeParam::shape_gradients(xi), differences, 1e-10));
  }
}

TEST(Elements, QuadratureRulesAreExactToTheirDegree) {
  expect_exact<LinearTet>(LinearTet::gauss_points, 1);
  expect_exact<QuadraticTet>(QuadraticTet::gauss_points, 2);
  expect_exact<QuadraticTet>(QuadraticTet::mass_points, 5);
  expect_exact<TrilinearHex>(TrilinearHex::gauss_points, 3);
}

// A rule of too few points would leave modes without energy beside the six rigid ones.
TYPED_TEST(ElementTest, OnlyRigidMotionsCostNothingAtRest) {
  const auto mesh = irregular_box<TypeParam>({1, 1, 1}, cell_edge);
  const SolidElasticity<TypeParam, StVenantKirchhoff> model(mesh, StVenantKirchhoff<double>::from(cell_moduli));
  using Model = decltype(model);
  constexpr int dofs = std::remove_cvref_t<Model>::local_dofs;
  const Vector eigenvalues = symmetric_eigenvalues(model.stiffness(0, Local<dofs>::Zero()));
  const double largest = eigenvalues[dofs - 1];
  EXPECT_LT(eigenvalues[5], rounding * largest);
  EXPECT_GT(eigenvalues[6], 1e-3 * largest);
}

TYPED_TEST(ElementTest, GaussPointsOfACellAddUpToTheCell) {
  const auto mesh = irregular_box<TypeParam>({1, 1, 1}, cell_edge);
  const auto material = MooneyRivlin<double>::from(cell_moduli);
  const SolidElasticity<TypeParam, MooneyRivlin> cells(mesh, material);
  const GaussPointElasticity<TypeParam, MooneyRivlin> points(mesh, material);
  constexpr int P = decltype(cells)::points_per_cell;
  ASSERT_EQ(points.num_components(), P * cells.num_components());
  constexpr int dofs = 3 * TypeParam::num_nodes;
  for (Index e = 0; e < cells.num_components(); ++e) {
    const Local<dofs> u = random_vector(dofs, 0.03 * cell_edge, 40 + e);
    double energy = 0, smallest = 2;
    Local<dofs> force = Local<dofs>::Zero();
    LocalMatrix<dofs> K = LocalMatrix<dofs>::Zero();
    for (Index i = e * P; i < (e + 1) * P; ++i) {
      EXPECT_TRUE(std::ranges::equal(points.stencil(i), cells.stencil(e)));
      energy += points.energy(i, u);
      force += points.force(i, u);
      K += points.stiffness(i, u);
      smallest = std::min(smallest, points.term(i).jacobian(u));
    }
    EXPECT_NEAR(cells.energy(e, u), energy, rounding * energy);
    EXPECT_TRUE(is_near(cells.force(e, u), force, rounding * force.norm()));
    EXPECT_TRUE(is_near(cells.stiffness(e, u), K, rounding * K.norm()));
    EXPECT_EQ(cells.term(e).jacobian(u), smallest);
  }
}

// Patch test, first half: under an affine field F is the same everywhere, inner nodes are in equilibrium and
// the forces on the boundary have the moments Σ f_v ⊗ X_v = V P.
TYPED_TEST(ElementTest, AffineFieldsGiveConstantStressAndInteriorEquilibrium) {
  const auto mesh = this->straight_box(3);
  const auto material = MooneyRivlin<double>::from(cell_moduli);
  const FullSystem system(SolidElasticity<TypeParam, MooneyRivlin>(mesh, material), lumped_mass<TypeParam>(mesh, 1.0));
  const Mat3 F = random_rotation(2) * (Mat3::Identity() + Mat3(random_matrix(3, 3, 0.2, 31)));
  const Vector u = affine_displacement(mesh.nodes, F, {0.1, 0, 0});
  const double volume = lumped_mass<TypeParam>(mesh, 1.0).sum();
  const Vector f = system.force(u);
  EXPECT_NEAR(system.energy(u), volume * material.energy(F), rounding * cell_moduli.young * volume);
  const std::vector<Index> boundary = this->box_boundary(3);
  const NodeNumbering interior(mesh.num_nodes(), boundary);
  ASSERT_GE(interior.num_free(), 8);
  EXPECT_TRUE(is_near(interior.restrict(f, 3), Vector::Zero(3 * interior.num_free()), rounding * f.norm()));
  const Mat3 moments = Eigen::Map<const Points>(f.data(), mesh.num_nodes(), 3).transpose() * mesh.nodes;
  EXPECT_TRUE(is_near(moments, volume * material.stress(F), rounding * f.norm()));
  using Model = SolidElasticity<TypeParam, MooneyRivlin>;
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    Local<Model::local_dofs> u_e;
    for (int a = 0; a < TypeParam::num_nodes; ++a) u_e.template segment<3>(3 * a) = u.segment<3>(3 * mesh.cells[e][a]);
    for (int g = 0; g < Model::num_points; ++g)
      EXPECT_TRUE(is_near(system.model().term(e).gradient(u_e, g), F, rounding)) << "cell " << e << ", point " << g;
  }
}

// Patch test, second half: given affine displacements at the boundary, the affine field is what the solver
// finds.
TYPED_TEST(ElementTest, AffineBoundaryDisplacementsHaveTheAffineSolution) {
  const auto mesh = this->straight_box(2);
  const FullSystem system(
      SolidElasticity<TypeParam, StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from(cell_moduli)),
      lumped_mass<TypeParam>(mesh, 1000.0));
  const Mat3 F = Mat3::Identity() + Mat3(random_matrix(3, 3, 0.08, 32));
  const Vector u = affine_displacement(mesh.nodes, F);
  const NodeNumbering interior(mesh.num_nodes(), this->box_boundary(2));
  const Vector g = u - interior.expand(interior.restrict(u, 3), 3);  // on the boundary only
  BoundaryValueProblem<std::remove_cvref_t<decltype(system)>> problem{system, interior, g};
  SpdSolver<Matrix> solver;
  Vector w = interior.restrict(u, 3) + random_vector(interior.num_free() * 3, 0.05 * cell_edge, 5);
  const Report report = Newton{}(problem, solver, w, {.tolerance = 1e-13, .max_iterations = 50});
  EXPECT_EQ(report.status, Status::Converged) << to_string(report.status) << ", " << report.residual;
  EXPECT_TRUE(is_near(problem.at(w), u, 1e-11 * cell_edge));  // residual times the condition of the stiffness
}

/// A field that vanishes on the boundary of the unit cube, with its first and second derivatives.
struct SmoothField {
  Point direction{0.05, -0.03, 0.04};

  Point operator()(const Point& X) const { return direction * factor(X, -1, -1); }
  Mat3 gradient(const Point& X) const {
    Mat3 H;
    for (int J = 0; J < 3; ++J) H.col(J) = direction * factor(X, J, -1);
    return H;
  }
  /// ∂²u_k / ∂X_J ∂X_L
  double second(const Point& X, int k, int J, int L) const { return direction[k] * factor(X, J, L); }

 private:
  /// Π sin(π X_x), derived by X_J and X_L; −1: not derived.
  static double factor(const Point& X, int J, int L) {
    constexpr double pi = std::numbers::pi;
    double product = 1;
    for (int x = 0; x < 3; ++x) {
      const int order = (J == x) + (L == x);
      product *= order == 0   ? std::sin(pi * X[x])
                 : order == 1 ? pi * std::cos(pi * X[x])
                              : -pi * pi * std::sin(pi * X[x]);
    }
    return product;
  }
};

/// The force density whose solution is the field: b = −Div P(I + ∇u), b_i = −C_iJkL ∂²u_k / ∂X_J ∂X_L.
template <typename Material>
Point body_force(const Material& material, const SmoothField& u, const Point& X) {
  const Matrix9<double> C = material.tangent(Mat3(Mat3::Identity() + u.gradient(X)));
  Point b = Point::Zero();
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J)
      for (int k = 0; k < 3; ++k)
        for (int L = 0; L < 3; ++L) b[i] -= C(i + 3 * J, k + 3 * L) * u.second(X, k, J, L);
  return b;
}

/// A rule so fine that its error is far below that of displacements.
template <typename Element>
std::vector<QuadraturePoint> fine_rule() {
  if constexpr (!std::same_as<Element, TrilinearHex>)
    return {QuadraticTet::mass_points.begin(), QuadraticTet::mass_points.end()};
  std::vector<QuadraturePoint> rule;  // of the eight octants
  for (const auto& corner : TrilinearHex::corners)
    for (const QuadraturePoint& at : TrilinearHex::gauss_points) {
      QuadraturePoint fine{at.xi, at.weight / 8};
      for (int x = 0; x < 3; ++x) fine.xi[x] = (at.xi[x] + corner[x]) / 2;
      rule.push_back(fine);
    }
  return rule;
}

/// visit(cell, N, X, volume) at every point of the fine rule in every cell.
template <typename Element, typename Visit>
void for_fine_points(const CellMesh<Element::num_nodes>& mesh, const Visit& visit) {
  const std::vector<QuadraturePoint> rule = fine_rule<Element>();
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    const ShapeGradients<Element> corners = cell_positions<Element>(mesh.nodes, mesh.cells, e);
    const auto points = cell_points<Element>(corners, e, rule);
    for (std::size_t g = 0; g < rule.size(); ++g) {
      const Local<Element::num_nodes> N = Element::shape(point(rule[g].xi));
      visit(mesh.cells[e], N, Point(corners.transpose() * N), rule[g].weight * points[g].det_J);
    }
  }
}

/// L2 norm of the error in displacements on n³ boxes of smoothly distorted cells.
template <typename Element>
double displacement_error(Index n) {
  auto mesh = box_of<Element>({n, n, n}, 1.0 / static_cast<double>(n));
  const std::vector<Index> boundary =
      nodes_where(mesh, [](const Point& x) { return x.minCoeff() < 1e-9 || x.maxCoeff() > 1 - 1e-9; });
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    const Point X = mesh.nodes.row(v);
    mesh.nodes.row(v) += 0.5 * SmoothField{{-0.04, 0.05, 0.06}}(X).transpose();
  }
  straighten(mesh);
  const auto material = StVenantKirchhoff<double>::from(cell_moduli);
  const SmoothField exact;
  const FullSystem system(SolidElasticity<Element, StVenantKirchhoff>(mesh, material), lumped_mass<Element>(mesh, 1.0),
                          boundary);
  Vector load = Vector::Zero(3 * mesh.num_nodes());
  for_fine_points<Element>(mesh, [&](const auto& cell, const auto& N, const Point& X, double volume) {
    const Point b = body_force(material, exact, X);
    for (int a = 0; a < Element::num_nodes; ++a) load.segment<3>(3 * cell[a]) += N[a] * volume * b;
  });
  Equilibrium problem(system, SystemLoad<SparseMatrix>{system.restrict(load), {}});
  SpdSolver<SparseMatrix> solver;
  Vector u = Vector::Zero(system.dim());
  EXPECT_EQ(Newton{}(problem, solver, u, {.tolerance = 1e-9}).status, Status::Converged);
  const Vector full = system.expand(u);
  double squared = 0;
  for_fine_points<Element>(mesh, [&](const auto& cell, const auto& N, const Point& X, double volume) {
    Point error = -exact(X);
    for (int a = 0; a < Element::num_nodes; ++a) error += N[a] * full.segment<3>(3 * cell[a]);
    squared += volume * error.squaredNorm();
  });
  return std::sqrt(squared);
}

/// log₂ of the ratios of errors as the mesh is halved and halved again.
template <typename Element>
std::array<double, 2> convergence_orders(Index coarsest) {
  std::array<double, 3> errors;
  for (int k = 0; k < 3; ++k) errors[k] = displacement_error<Element>(coarsest << k);
  SCOPED_TRACE(testing::PrintToString(errors));
  return {std::log2(errors[0] / errors[1]), std::log2(errors[1] / errors[2])};
}

// Finite strains (|∇u| up to 0.22) under a manufactured force; linear shape functions err by h², quadratic
// ones by h³.
TEST(Elements, DisplacementsOfLinearTetsConvergeWithOrderTwo) {
  const auto [coarse, fine] = convergence_orders<LinearTet>(4);
  EXPECT_NEAR(fine, 2, 0.1) << "before: " << coarse;
}
TEST(Elements, DisplacementsOfHexesConvergeWithOrderTwo) {
  const auto [coarse, fine] = convergence_orders<TrilinearHex>(3);
  EXPECT_NEAR(fine, 2, 0.1) << "before: " << coarse;
}
TEST(Elements, DisplacementsOfQuadraticTetsConvergeWithOrderThree) {
  const auto [coarse, fine] = convergence_orders<QuadraticTet>(2);
  EXPECT_NEAR(fine, 3, 0.15) << "before: " << coarse;
}

TYPED_TEST(ElementTest, LumpedMassesArePositiveAndSumToTheMass) {
  const auto mesh = this->irregular_inside(3);  // curved edges inside, yet the volume of the box
  const double volume = std::pow(3 * cell_edge, 3);
  const Vector mass = lumped_mass<TypeParam>(mesh, 1200.0);
  EXPECT_NEAR(mass.sum(), 1200 * volume, rounding * 1200 * volume);
  EXPECT_GT(mass.minCoeff(), 0);
  const Vector density = Vector::LinSpaced(mesh.num_cells(), 500, 3000);
  double expected = 0;
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    CellMesh<TypeParam::num_nodes> one{mesh.nodes, {mesh.cells[e]}};
    expected += density[e] * lumped_mass<TypeParam>(one, 1.0).sum();
  }
  EXPECT_NEAR(lumped_mass<TypeParam>(mesh, density).sum(), expected, rounding * expected);
}

TYPED_TEST(ElementTest, LumpedMassesKeepTheCentreOfMass) {
  auto mesh = this->irregular_inside(3);
  straighten(mesh);  // of curved quadratic tets it moves a little
  const Vector mass = lumped_mass<TypeParam>(mesh, 1.0);
  EXPECT_TRUE(
      is_near(mesh.nodes.transpose() * mass / mass.sum(), Point::Constant(1.5 * cell_edge), rounding * cell_edge));
}

TEST(Elements, EveryTypeOfTetSharesItsMassAsDocumented) {
  const QuadraticTetMesh quadratic = quadratic_mesh(single_tet(2));
  const Vector mass = lumped_mass<QuadraticTet>(quadratic, 3.0) / (3 * 8.0 / 6);
  EXPECT_TRUE(is_near(mass.head(4), Vector::Constant(4, 1.0 / 36), 1e-14));
  EXPECT_TRUE(is_near(mass.tail(6), Vector::Constant(6, 4.0 / 27), 1e-14));
  const TetMesh box = perturbed(kuhn_box(2, 2, 2, cell_edge), 0.1 * cell_edge, 6);
  const Vector quarter = lumped_mass(box, 700.0);
  EXPECT_TRUE(is_near(lumped_mass<LinearTet>(box, 700.0), quarter, rounding * quarter.maxCoeff()));
}

template <typename Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

TYPED_TEST(ElementTest, CellsThatCannotBeAreRefusedByName) {
  using Solid = SolidElasticity<TypeParam, StVenantKirchhoff>;
  const auto material = StVenantKirchhoff<double>::from(cell_moduli);
  const auto refusal = [&](const CellMesh<TypeParam::num_nodes>& mesh) {
    const std::string by_solid = message_of([&] { Solid(mesh, material); });
    EXPECT_EQ(by_solid, message_of([&] { (void)lumped_mass<TypeParam>(mesh, 1.0); }));
    return by_solid;
  };
  const auto box = box_of<TypeParam>({1, 1, 1}, cell_edge);
  const Index last = box.num_cells() - 1;
  const std::string name = std::string(TypeParam::name) + " " + std::to_string(last);
  EXPECT_EQ(refusal(box), "nothing thrown");
  auto bad = box;
  bad.cells[last][1] = box.num_nodes();
  EXPECT_THAT(refusal(bad), testing::HasSubstr(name + " names node " + std::to_string(box.num_nodes()) + ","));
  bad.cells[last][1] = -1;
  EXPECT_THAT(refusal(bad), testing::HasSubstr(name + " names node -1,"));
  bad.cells[last][1] = box.cells[last][3];
  EXPECT_THAT(refusal(bad), testing::HasSubstr(name + " names node " + std::to_string(box.cells[last][3]) + " twice"));
  bad = box;
  bad.nodes.col(0) *= -1;
  EXPECT_THAT(refusal(bad), testing::AllOf(testing::HasSubstr(std::string(TypeParam::name) + " 0 has det J = "),
                                           testing::HasSubstr("Gauss point 0")));
  bad = box;
  bad.nodes.col(2).setZero();
  EXPECT_THAT(refusal(bad), testing::HasSubstr("has det J = "));

  const std::vector<StVenantKirchhoff<double>> too_many(box.num_cells() + 1, material);
  EXPECT_THROW(Solid(box, too_many), std::invalid_argument);
  EXPECT_THROW(Solid(box, std::vector<StVenantKirchhoff<double>>()), std::invalid_argument);
  EXPECT_THROW((void)lumped_mass<TypeParam>(box, 0.0), std::invalid_argument);
  EXPECT_THROW((void)lumped_mass<TypeParam>(box, Vector::Ones(box.num_cells() + 1)), std::invalid_argument);
}

// Turned over at one corner only: most points are fine.
TEST(Elements, TheGaussPointAtFaultIsNamed) {
  HexMesh hex = hex_box(1, 1, 1, {1, 1, 1});
  hex.nodes.row(hex.cells[0][6]) << 0.1, 0.1, 0.1;  // pushed through its neighbours
  const std::string message = message_of(
      [&] { SolidElasticity<TrilinearHex, StVenantKirchhoff>(hex, StVenantKirchhoff<double>::from(cell_moduli)); });
  EXPECT_THAT(message, testing::AllOf(testing::HasSubstr("hex 0"), testing::HasSubstr("at Gauss point 6")));
}

TEST(CellMesh, HexBoxFillsTheBoxWithConformingCells) {
  const HexMesh box = hex_box(3, 2, 4, {0.3, 0.4, 0.6});
  EXPECT_EQ(box.num_cells(), 24);
  EXPECT_EQ(box.num_nodes(), 60);
  EXPECT_NEAR(lumped_mass<TrilinearHex>(box, 1.0).sum(), 0.3 * 0.4 * 0.6, 1e-15);
  EXPECT_TRUE(is_near(box.nodes.colwise().maxCoeff(), Eigen::RowVector3d(0.3, 0.4, 0.6), 0));
  std::vector<int> count(box.num_nodes(), 0);
  for (const auto& cell : box.cells)
    for (const Index v : cell) ++count[v];
  EXPECT_EQ(std::ranges::count(count, 8), 2 * 1 * 3);  // nodes inside
  EXPECT_EQ(std::ranges::count(count, 1), 8);          // corners of the box
  EXPECT_THROW((void)hex_box(0, 1, 1, {1, 1, 1}), std::invalid_argument);
  EXPECT_THROW((void)hex_box(1, 1, 1, {1, -1, 1}), std::invalid_argument);
}

TEST(CellMesh, QuadraticMeshHasOneNodeAmidEachEdge) {
  const TetMesh corners = perturbed(kuhn_box(2, 3, 1, cell_edge), 0.1 * cell_edge, 8);
  const QuadraticTetMesh mesh = quadratic_mesh(corners);
  std::set<std::pair<Index, Index>> edges;
  for (const Tet& tet : corners.cells)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) edges.insert(std::minmax(tet[a], tet[b]));
  ASSERT_EQ(mesh.num_nodes(), corners.num_nodes() + static_cast<Index>(edges.size()));
  EXPECT_TRUE(is_same(mesh.nodes.topRows(corners.num_nodes()), corners.nodes));
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    const auto& cell = mesh.cells[e];
    EXPECT_TRUE(std::equal(corners.cells[e].begin(), corners.cells[e].end(), cell.begin()));
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = QuadraticTet::edges[k];
      EXPECT_TRUE(is_near(mesh.nodes.row(cell[4 + k]), (mesh.nodes.row(cell[a]) + mesh.nodes.row(cell[b])) / 2,
                          rounding * cell_edge));
    }
  }
  Index next = corners.num_nodes();  // numbered in order of the corners of their edges
  for (const auto& [a, b] : edges)
    EXPECT_TRUE(
        is_near(mesh.nodes.row(next++), (corners.nodes.row(a) + corners.nodes.row(b)) / 2, rounding * cell_edge));
}

}  // namespace
}  // namespace supple::test

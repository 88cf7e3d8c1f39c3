#include <numerics/optimize/newton.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/boundary_values.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/rounding.hpp>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using Mat3 = Matrix3<double>;
constexpr IsotropicModuli tet_moduli{.young = 1e5, .poisson = 0.4};
constexpr double tet_edge = 0.1;

template <template <typename> class M>
struct Law {
  using Model = TetElasticity<M>;
  using Material = M<double>;
};

template <typename Law>
class TetElasticityTest : public testing::Test {
 protected:
  using Model = typename Law::Model;
  using Material = typename Law::Material;

  const TetMesh mesh = perturbed(kuhn_box(3, 3, 3, tet_edge), 0.1 * tet_edge, 21);
  const Material material = Material::from(tet_moduli);
  const FullSystem<Model> system{Model(mesh, material), lumped_mass(mesh, 1000.0)};
  const double volume = [this] {
    double sum = 0;
    for (Index e = 0; e < mesh.num_cells(); ++e) sum += tet_volume(mesh, e);
    return sum;
  }();
};
using Laws = testing::Types<Law<StVenantKirchhoff>, Law<MooneyRivlin>>;
TYPED_TEST_SUITE(TetElasticityTest, Laws);

TYPED_TEST(TetElasticityTest, RigidMotionsCostNothing) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Vector u = affine_displacement(this->mesh.nodes, random_rotation(seed), {0.3, -2, 1});
    EXPECT_NEAR(this->system.energy(u), 0, rounding * tet_moduli.young * this->volume);
    EXPECT_TRUE(
        is_near(this->system.force(u), Vector::Zero(u.size()), rounding * tet_moduli.young * tet_edge * tet_edge));
  }
}

TYPED_TEST(TetElasticityTest, EnergyIsInvariantUnderRigidMotionsOfADeformedState) {
  const Vector w = random_vector(this->system.dim(), 0.1 * tet_edge, 3);
  const Points deformed = this->mesh.nodes + Eigen::Map<const Points>(w.data(), this->mesh.num_nodes(), 3);
  const Mat3 R = random_rotation(9);
  const Vector u = w + affine_displacement(deformed, R, {1, 2, -1});
  const Vector f_w = this->system.force(w), f_u = this->system.force(u);
  EXPECT_NEAR(this->system.energy(u), this->system.energy(w), rounding * tet_moduli.young * this->volume);
  for (Index v = 0; v < this->mesh.num_nodes(); ++v)
    EXPECT_TRUE(is_near(f_u.segment<3>(3 * v), R * f_w.segment<3>(3 * v), rounding * f_w.norm()));
}

TYPED_TEST(TetElasticityTest, InternalForcesHaveNoResultantAndNoMoment) {
  const Vector u = random_vector(this->system.dim(), 0.1 * tet_edge, 4);
  const Vector f = this->system.force(u);
  Point resultant = Point::Zero(), moment = Point::Zero();
  for (Index v = 0; v < this->mesh.num_nodes(); ++v) {
    const Point x = this->mesh.nodes.row(v).transpose() + u.segment<3>(3 * v);
    resultant += f.segment<3>(3 * v);
    moment += x.cross(Point(f.segment<3>(3 * v)));
  }
  EXPECT_TRUE(is_near(resultant, Point::Zero(), rounding * f.norm()));
  EXPECT_TRUE(is_near(moment, Point::Zero(), rounding * f.norm()));
}

// Patch test, first half: under an affine field the stress P is the same in every tet, the interior is in
// equilibrium and the forces on the boundary have the moments Σ f_v ⊗ X_v = V P.
TYPED_TEST(TetElasticityTest, AffineFieldsGiveConstantStressAndInteriorEquilibrium) {
  const Mat3 F = random_rotation(2) * (Mat3::Identity() + Mat3(random_matrix(3, 3, 0.2, 31)));
  const Vector u = affine_displacement(this->mesh.nodes, F, {0.1, 0, 0});
  const Mat3 P = this->material.stress(F);
  const Vector f = this->system.force(u);
  EXPECT_NEAR(this->system.energy(u), this->volume * this->material.energy(F),
              rounding * tet_moduli.young * this->volume);
  const std::vector<Index> boundary = boundary_nodes(this->mesh);
  ASSERT_EQ(this->mesh.num_nodes() - static_cast<Index>(boundary.size()), 8);
  for (Index v = 0; v < this->mesh.num_nodes(); ++v)
    if (!std::binary_search(boundary.begin(), boundary.end(), v)) {
      EXPECT_TRUE(is_near(f.segment<3>(3 * v), Point::Zero(), rounding * f.norm())) << "node " << v;
    }
  const Mat3 moments = Eigen::Map<const Points>(f.data(), this->mesh.num_nodes(), 3).transpose() * this->mesh.nodes;
  EXPECT_TRUE(is_near(moments, this->volume * P, rounding * P.norm()));
  for (Index e = 0; e < this->mesh.num_cells(); ++e) {
    Local<12> u_e;
    for (int a = 0; a < 4; ++a) u_e.segment<3>(3 * a) = u.segment<3>(3 * this->mesh.cells[e][a]);
    EXPECT_TRUE(is_near(this->system.model().term(e).gradient(u_e), F, rounding)) << "tet " << e;
  }
}

// Patch test, second half: given affine displacements at the boundary, the affine field is what the solver
// finds.
TYPED_TEST(TetElasticityTest, AffineBoundaryDisplacementsHaveTheAffineSolution) {
  const Mat3 F = Mat3::Identity() + Mat3(random_matrix(3, 3, 0.08, 32));
  const Vector u = affine_displacement(this->mesh.nodes, F);
  const NodeNumbering interior(this->mesh.num_nodes(), boundary_nodes(this->mesh));
  const Vector g = u - interior.expand(interior.restrict(u, 3), 3);  // on the boundary only
  BoundaryValueProblem<FullSystem<typename TestFixture::Model>> problem{this->system, interior, g};
  SpdSolver<Matrix> solver;
  Vector w = interior.restrict(u, 3) + random_vector(interior.num_free() * 3, 0.1 * tet_edge, 5);
  const Report report = Newton{}(problem, solver, w, {.tolerance = 1e-13, .max_iterations = 50});
  EXPECT_EQ(report.status, Status::Converged) << to_string(report.status) << ", " << report.residual;
  EXPECT_TRUE(is_near(problem.at(w), u, 1e-11 * tet_edge));  // residual times the condition of the stiffness
}

// Mesh-independent: the same material cut differently has the same energy under an affine field; a stiffer
// tet carries its own share.
TYPED_TEST(TetElasticityTest, EveryTetHasItsOwnMaterial) {
  std::vector<typename TestFixture::Material> materials;
  for (Index e = 0; e < this->mesh.num_cells(); ++e)
    materials.push_back(TestFixture::Material::from({.young = 1e4 * static_cast<double>(e + 1), .poisson = 0.1}));
  const typename TestFixture::Model model(this->mesh, materials);
  const Mat3 F = Mat3::Identity() + Mat3(random_matrix(3, 3, 0.2, 33));
  const Vector u = affine_displacement(this->mesh.nodes, F);
  double expected = 0;
  for (Index e = 0; e < this->mesh.num_cells(); ++e) {
    const double energy = tet_volume(this->mesh, e) * materials[e].energy(F);
    Local<12> u_e;
    for (int a = 0; a < 4; ++a) u_e.segment<3>(3 * a) = u.segment<3>(3 * this->mesh.cells[e][a]);
    EXPECT_NEAR(model.energy(e, u_e), energy, rounding * 1e4 * static_cast<double>(e + 1)) << "tet " << e;
    expected += energy;
  }
  const FullSystem<typename TestFixture::Model> sum(model, lumped_mass(this->mesh, 1.0));
  EXPECT_NEAR(sum.energy(u), expected, rounding * expected);
}

TYPED_TEST(TetElasticityTest, MaterialsAndTetsThatCannotBeThrow) {
  using Solid = typename TestFixture::Model;
  using Materials = std::vector<typename TestFixture::Material>;
  const TetMesh two = [] {
    TetMesh box = kuhn_box(1, 1, 1);
    box.cells.resize(2);
    return box;
  }();
  EXPECT_NO_THROW(Solid(two, Materials(1, this->material)));
  EXPECT_NO_THROW(Solid(two, Materials(2, this->material)));
  EXPECT_THROW(Solid(two, Materials(3, this->material)), std::invalid_argument);
  EXPECT_THROW(Solid(two, Materials()), std::invalid_argument);
  TetMesh reversed = single_tet();
  std::swap(reversed.cells[0][0], reversed.cells[0][1]);
  EXPECT_THROW(Solid(reversed, this->material), std::invalid_argument);
  TetMesh flat = single_tet();
  flat.nodes.row(3).setZero();
  EXPECT_THROW(Solid(flat, this->material), std::invalid_argument);
  for (const Index node : {Index{-1}, Index{4}}) {
    TetMesh out_of_range = single_tet();
    out_of_range.cells[0][2] = node;
    EXPECT_THROW(Solid(out_of_range, this->material), std::invalid_argument) << node;
  }
}

TEST(LumpedMass, SumsToTheMassOfTheObject) {
  const TetMesh box = kuhn_box(4, 2, 3, tet_edge);
  const double volume = 24 * tet_edge * tet_edge * tet_edge;
  EXPECT_NEAR(lumped_mass(box, 1200.0).sum(), 1200 * volume, rounding * 1200 * volume);
  EXPECT_NEAR(lumped_mass(perturbed(box, 0, 1), Vector::Constant(box.num_cells(), 700)).sum(), 700 * volume,
              rounding * 700 * volume);

  const TetMesh irregular = perturbed(box, 0.1 * tet_edge, 6);
  const Vector density = Vector::LinSpaced(irregular.num_cells(), 500, 3000);
  double mass = 0;
  for (Index e = 0; e < irregular.num_cells(); ++e) mass += density[e] * tet_volume(irregular, e);
  const Vector nodal = lumped_mass(irregular, density);
  EXPECT_NEAR(nodal.sum(), mass, rounding * mass);
  EXPECT_GT(nodal.minCoeff(), 0);
}

TEST(LumpedMass, GivesEachCornerAQuarter) {
  EXPECT_TRUE(is_near(lumped_mass(single_tet(2), 3.0), Vector::Constant(4, 3 * (8.0 / 6) / 4), rounding));
  TetMesh with_isolated_node = single_tet();
  with_isolated_node.nodes.conservativeResize(5, 3);
  with_isolated_node.nodes.row(4).setOnes();
  EXPECT_EQ(lumped_mass(with_isolated_node, 1.0)[4], 0);
}

TEST(LumpedMass, RefusesDensitiesThatCannotBe) {
  const TetMesh box = kuhn_box(1, 1, 1);
  EXPECT_THROW((void)lumped_mass(box, 0.0), std::invalid_argument);
  EXPECT_THROW((void)lumped_mass(box, -1.0), std::invalid_argument);
  EXPECT_THROW((void)lumped_mass(box, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW((void)lumped_mass(box, Vector::Ones(5)), std::invalid_argument);
  Vector one_bad = Vector::Ones(6);
  one_bad[4] = 0;
  EXPECT_THROW((void)lumped_mass(box, one_bad), std::invalid_argument);
}

}  // namespace
}  // namespace supple::test

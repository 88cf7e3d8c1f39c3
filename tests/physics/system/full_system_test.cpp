#include <core/parallel.hpp>
#include <numerics/linear/spd_solver.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/force_models.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/spring_network.hpp>

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using Tets = TetElasticity<StVenantKirchhoff>;
constexpr double edge = 0.1;

/// Sums over components, entry by entry, without packs, patterns or threads.
template <typename Model>
struct BruteForce {
  double energy = 0, energy_size = 0;
  Vector force;
  Matrix stiffness;

  BruteForce(const Model& model, VectorIn u) {
    const Index dofs = model.num_nodes() * Model::node_dim;
    force = Vector::Zero(dofs);
    stiffness = Matrix::Zero(dofs, dofs);
    for (Index i = 0; i < model.num_components(); ++i) {
      const auto nodes = model.stencil(i);
      std::array<Index, Model::local_dofs> at;
      Local<Model::local_dofs> u_i;
      for (int j = 0; j < Model::local_dofs; ++j) {
        at[j] = nodes[j / Model::node_dim] * Model::node_dim + j % Model::node_dim;
        u_i[j] = u[at[j]];
      }
      const Local<Model::local_dofs> f = model.force(i, u_i);
      const LocalMatrix<Model::local_dofs> K = model.stiffness(i, u_i);
      if constexpr (PotentialModel<Model>) energy += model.energy(i, u_i);
      for (int j = 0; j < Model::local_dofs; ++j) {
        force[at[j]] += f[j];
        for (int k = 0; k < Model::local_dofs; ++k) stiffness(at[j], at[k]) += K(j, k);
      }
    }
  }
};

template <typename Factory>
class AssemblyTest : public testing::Test {};
using Factories = testing::Types<TetBar<StVenantKirchhoff>, TetBar<MooneyRivlin>, SpringBar, DuffingSet,
                                 HeatBar<LinearConductivity>, CoolingBar>;
TYPED_TEST_SUITE(AssemblyTest, Factories);

TYPED_TEST(AssemblyTest, ManyStatesAtOnceAreEachOfThem) {
  const auto model = TypeParam::make();
  using Model = std::remove_const_t<decltype(model)>;
  const FullSystem<Model> system(model, TypeParam::nodal_mass(), {2});
  for (const Index count : {1, 3, 8, 17}) {
    const Matrix U = random_vector(system.dim() * count, 0.1 * TypeParam::length, 5).reshaped(system.dim(), count);
    Matrix F(system.dim(), count);
    system.forces(U, F);
    for (Index k = 0; k < count; ++k) {
      const Vector f = system.force(U.col(k));
      EXPECT_TRUE(is_near(Vector(F.col(k)), f, 1e-12 * f.norm())) << k << " of " << count;
    }
    if constexpr (PotentialModel<Model>) {
      Vector energies(count);
      Matrix same(system.dim(), count);
      system.forces(U, same, energies);
      EXPECT_EQ(same, F);
      for (Index k = 0; k < count; ++k) {
        const double energy = system.energy(U.col(k));
        EXPECT_NEAR(energies[k], energy, 1e-12 * std::abs(energy));
      }
    }
    set_num_threads(1);
    Matrix serial(system.dim(), count);
    system.forces(U, serial);
    set_num_threads(0);
    EXPECT_EQ(serial, F);
  }
  Matrix few(system.dim(), 2);
  EXPECT_THROW(system.forces(Matrix::Zero(system.dim(), 3), few), std::invalid_argument);
}

TYPED_TEST(AssemblyTest, SumsOverComponentsEqualBruteForce) {
  const auto model = TypeParam::make();
  using Model = std::remove_const_t<decltype(model)>;
  for (const std::vector<Index>& fixed : {std::vector<Index>{}, {2}, {9, 1, 4, 10}}) {
    const FullSystem<Model> system(model, TypeParam::nodal_mass(), fixed);
    ASSERT_EQ(system.dim(), Model::node_dim * (model.num_nodes() - static_cast<Index>(fixed.size())));
    const Vector u = random_vector(system.dim(), 0.1 * TypeParam::length, 12), full = system.expand(u);
    const BruteForce<Model> brute(model, full);
    if constexpr (PotentialModel<Model>) {
      EXPECT_NEAR(system.energy(u), brute.energy, 1e-12 * std::abs(brute.energy));
    }
    EXPECT_TRUE(is_near(system.force(u), system.restrict(brute.force), 1e-12 * brute.force.norm()));
    Vector full_force(full.size());
    system.full_force(full, full_force);
    EXPECT_TRUE(is_near(full_force, brute.force, 1e-12 * brute.force.norm()));
    Matrix K(system.dim(), system.dim());
    for (Index j = 0; j < system.dim(); ++j)
      K.col(j) = system.restrict(brute.stiffness * system.expand(Vector::Unit(system.dim(), j)));
    EXPECT_TRUE(is_near(Matrix(system.stiffness(u)), K, 1e-12 * K.norm()));
  }
}

// 10 368 tets: more than one round of chunks in the assembly, and a last pack that is whole.
TEST(FullSystem, LargeSystemsAreSummedInAFixedOrder) {
  const TetMesh mesh = perturbed(kuhn_box(12, 12, 12, edge), 0.1 * edge, 3);
  const Tets model(mesh, StVenantKirchhoff<double>::from({}));
  const FullSystem<Tets> system(model, lumped_mass(mesh, 1000.0), {0, 5, 1000});
  const Vector u = random_vector(system.dim(), 0.1 * edge, 4);
  const int before = num_threads();
  set_num_threads(1);
  const double energy = system.energy(u);
  const Vector force = system.force(u);
  const SparseMatrix K = system.stiffness(u);
  set_num_threads(2);
  EXPECT_EQ(system.energy(u), energy);
  EXPECT_TRUE(is_same(system.force(u), force));
  const SparseMatrix K2 = system.stiffness(u);
  EXPECT_TRUE(is_same(Eigen::Map<const Vector>(K2.valuePtr(), K2.nonZeros()),
                      Eigen::Map<const Vector>(K.valuePtr(), K.nonZeros())));
  set_num_threads(before);

  // against sums over components: K by its action on a vector
  const Vector full = system.expand(u), d = random_vector(system.dim(), 1, 5), d_full = system.expand(d);
  Vector f = Vector::Zero(full.size()), Kd = Vector::Zero(full.size());
  double E = 0;
  for (Index i = 0; i < model.num_components(); ++i) {
    Local<12> u_i, d_i;
    for (int a = 0; a < 4; ++a) {
      u_i.segment<3>(3 * a) = full.segment<3>(3 * mesh.cells[i][a]);
      d_i.segment<3>(3 * a) = d_full.segment<3>(3 * mesh.cells[i][a]);
    }
    const Local<12> f_i = model.force(i, u_i), Kd_i = model.stiffness(i, u_i) * d_i;
    E += model.energy(i, u_i);
    for (int a = 0; a < 4; ++a) {
      f.segment<3>(3 * mesh.cells[i][a]) += f_i.segment<3>(3 * a);
      Kd.segment<3>(3 * mesh.cells[i][a]) += Kd_i.segment<3>(3 * a);
    }
  }
  EXPECT_NEAR(energy, E, 1e-12 * E);
  EXPECT_TRUE(is_near(force, system.restrict(f), 1e-12 * f.norm()));
  EXPECT_TRUE(is_near(K * d, system.restrict(Kd), 1e-12 * Kd.norm()));
}

TEST(FullSystem, ExpandAndRestrictGoBetweenUnknownsAndNodes) {
  const std::vector<Index> fixed{7, 2, 7, 0};  // any order, repeated
  const FullSystem<SpringNetwork> system(SpringBar::make(), SpringBar::nodal_mass(), fixed);
  EXPECT_THAT(system.numbering().fixed_nodes(), testing::ElementsAre(0, 2, 7));
  EXPECT_EQ(system.dim(), 3 * (system.num_nodes() - 3));
  const Vector u = random_vector(system.dim(), 1, 3), full = system.expand(u);
  EXPECT_TRUE(is_same(system.restrict(full), u));
  for (Index v = 0; v < system.num_nodes(); ++v) {
    const Index f = system.numbering().free_index(v);
    const Point expected = f < 0 ? Point(Point::Zero()) : Point(u.segment<3>(3 * f));
    EXPECT_TRUE(is_same(full.segment<3>(3 * v), expected)) << "node " << v;
    if (f >= 0) {
      EXPECT_TRUE(is_same(system.mass().segment<3>(3 * f), Point::Constant(system.nodal_mass()[v])));
    }
  }
  EXPECT_THROW((void)system.expand(full), std::invalid_argument);
  EXPECT_THROW((void)system.restrict(u), std::invalid_argument);
}

TEST(FullSystem, ReactionsAtFixedNodesBalanceTheRest) {
  const TetMesh mesh = TetBar<MooneyRivlin>::mesh();
  const FullSystem<TetElasticity<MooneyRivlin>> system(TetBar<MooneyRivlin>::make(), TetBar<MooneyRivlin>::nodal_mass(),
                                                       {0, 3});
  const Vector u = system.expand(random_vector(system.dim(), 0.1 * edge, 3));
  Vector f(u.size());
  system.full_force(u, f);
  const Eigen::Map<const Points> rows(f.data(), mesh.num_nodes(), 3);
  EXPECT_GT(rows.row(0).norm(), 0.01 * f.norm());
  EXPECT_TRUE(is_near(rows.colwise().sum(), Eigen::RowVector3d::Zero(), 1e-12 * f.norm()));
}

TEST(FullSystem, ANodeWithoutComponentsFloatsFreely) {
  const TetMesh mesh = [] {
    TetMesh m = single_tet();
    m.nodes.conservativeResize(5, 3);
    m.nodes.row(4).setConstant(3);
    return m;
  }();
  const Tets model(mesh, StVenantKirchhoff<double>::from({}));
  EXPECT_THROW(FullSystem<Tets>(model, lumped_mass(mesh, 1.0)), std::invalid_argument) << "it has no mass";
  const FullSystem<Tets> system(model, Vector::Constant(5, 2.0));
  const Vector u = random_vector(15, 0.1, 6);
  EXPECT_TRUE(is_same(system.force(u).tail<3>(), Point::Zero()));
  const SparseMatrix K = system.stiffness(u);
  EXPECT_TRUE(is_same(Matrix(K).bottomRows(3), Matrix::Zero(3, 15)));
  EXPECT_EQ(K.nonZeros(), 4 * 4 * 9 + 9) << "its diagonal block exists, so that a mass can be added";
  SparseMatrix A = K;
  add_diagonal(A, Vector::Ones(15));
  EXPECT_EQ(A.nonZeros(), K.nonZeros());
}

TEST(FullSystem, FixedNodesCutTheirComponentsOff) {
  // all but node 3 of a tet fixed: what is left is the 3 × 3 block of that node
  const Tets model(single_tet(), StVenantKirchhoff<double>::from({}));
  const FullSystem<Tets> system(model, Vector::Ones(4), {0, 1, 2});
  const Vector u = random_vector(3, 0.1, 8);
  Local<12> u_tet = Local<12>::Zero();
  u_tet.tail<3>() = u;
  EXPECT_TRUE(is_near(system.force(u), model.force(0, u_tet).tail<3>(), 1e-9));
  EXPECT_TRUE(is_near(Matrix(system.stiffness(u)), model.stiffness(0, u_tet).bottomRightCorner<3, 3>(), 1e-7));
}

TEST(FullSystem, LoadsOnFixedNodesDoNothing) {
  const FullSystem<DuffingOscillators> system(DuffingSet::make(), DuffingSet::nodal_mass(), {0, 4});
  const SystemLoad<SparseMatrix> load =
      system.project({.gravity = Point::Zero(), .forces = {{0, {1, 2, 3}}}, .springs = {{4, 5, {1, 1, 1}}}});
  EXPECT_TRUE(is_same(load.force, Vector::Zero(system.dim())));
  EXPECT_FALSE(load.has_stiffness());
}

TEST(FullSystem, RefusesWhatCannotBeASystem) {
  const SpringNetwork model = SpringBar::make();
  const Vector mass = SpringBar::nodal_mass();
  const auto make = [&](const Vector& nodal_mass, const std::vector<Index>& fixed) {
    return FullSystem<SpringNetwork>(model, nodal_mass, fixed);
  };
  EXPECT_NO_THROW(make(mass, {}));
  EXPECT_THROW(make(mass.head(3), {}), std::invalid_argument);
  Vector bad = mass;
  for (const double value : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    bad[2] = value;
    EXPECT_THAT([&] { make(bad, {}); },
                testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("mass of node ")))
        << value;
  }
  EXPECT_THROW(make(mass, {model.num_nodes()}), std::invalid_argument);
  EXPECT_THROW(make(mass, {-1}), std::invalid_argument);
  std::vector<Index> all(model.num_nodes());
  for (Index v = 0; v < model.num_nodes(); ++v) all[v] = v;
  EXPECT_THROW(make(mass, all), std::invalid_argument);
  EXPECT_THROW(FullSystem<SpringNetwork>(SpringNetwork(Points::Zero(2, 3), {}, 1), Vector::Ones(2)),
               std::invalid_argument)
      << "no components";
  EXPECT_THROW(FullSystem<SpringNetwork>(SpringNetwork(Points::Zero(2, 3), {{0, 2}}, 1), Vector::Ones(2)),
               std::invalid_argument)
      << "a stencil out of range";
}

}  // namespace
}  // namespace supple::test

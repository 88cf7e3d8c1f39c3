// Nodes that slide on supports, held along some axes: subspaces, fitted models and files keep them.

#include <core/check.hpp>
#include <physics/body/body_system.hpp>
#include <physics/statics/static_solver.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/body_training.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <testing/near.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/solids.hpp>
#include <tests/support/test_folder.hpp>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

namespace supple::test {
namespace {

enum : std::uint8_t { along_x = 1, along_y = 2, along_z = 4 };

/// Three cubes by two by two, held at one end; the nodes of its lower side slide on rollers, some along y alone.
Solid bar_on_rollers() {
  Solid solid = isotropic_solid(bar_mesh(), rubber, bar_end(bar_mesh()));
  for (Index v = 0; v < solid.mesh.num_nodes(); ++v)
    if (solid.mesh.nodes(v, 2) < 0.05 && solid.mesh.nodes(v, 0) > 0.05)
      solid.held_axes.push_back({v, v % 3 == 0 ? static_cast<std::uint8_t>(along_x | along_z) : std::uint8_t{along_z}});
  return solid;
}

template <typename Visitor>
void with_system(const Solid& solid, const Visitor& visit) {
  with_force_model(Body(solid), [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    visit(FullSystem<Model>(model, solid.nodal_mass(), solid.fixed_nodes, solid.held_axes));
  });
}

void expect_kept(const Solid& solid, const Vector& u, const std::string& what) {
  for (const Index v : solid.fixed_nodes) EXPECT_TRUE(u.segment<3>(3 * v).isZero(0)) << what;
  for (const auto& [v, axes] : solid.held_axes)
    for (int c = 0; c < 3; ++c)
      if (axes >> c & 1) EXPECT_EQ(u[3 * v + c], 0) << what << ", node " << v;
}

TEST(SlidingSupports, LeaveTheFrequenciesOfTheSystemWithoutTheHeldUnknowns) {
  const Solid solid = bar_on_rollers();
  with_system(solid, [&](const auto& system) {
    std::vector<Index> free;
    for (Index i = 0; i < system.dim(); ++i)
      if (!std::ranges::binary_search(system.numbering().held_unknowns(), i)) free.push_back(i);
    ASSERT_LT(static_cast<Index>(free.size()), system.dim());
    const Matrix K = Matrix(system.rest_stiffness())(free, free), M = system.mass()(free).asDiagonal();
    const Vector exact = Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(K, M).eigenvalues().head(12).cwiseSqrt();
    const VibrationModes modes = vibration_modes(system.rest_state(), {.num_modes = 12});
    EXPECT_EQ(modes.num_rigid, 0);
    EXPECT_TRUE(is_near(modes.omega, exact, 1e-8 * exact[11]));
    for (Index j = 0; j < 12; ++j) expect_kept(solid, modes.vectors.col(j), "mode");
  });
}

TEST(SlidingSupports, AreKeptByEverySubspace) {
  const Solid solid = bar_on_rollers();
  with_system(solid, [&](const auto& system) {
    for (const std::string name : {"modal", "extended", "derivatives", "skinning", "modal+skinning"}) {
      const AnyBasis basis = build_subspace(system.rest_state(), {.name = name, .modes = 5});
      std::visit(
          [&](const auto& subspace) {
            const Matrix U = subspace->dense();
            const Vector mass = system.rest_state().mass_of_rows();
            EXPECT_LT((U.transpose() * mass.asDiagonal() * U - Matrix::Identity(U.cols(), U.cols())).norm(), 1e-8);
            for (Index j = 0; j < U.cols(); ++j) expect_kept(solid, U.col(j), name);
          },
          basis);
    }
  });
}

// A plane of symmetry alone lets the object move in it: three rigid motions, which are modes without energy.
TEST(SlidingSupports, OnOnePlaneLeaveItsThreeRigidMotions) {
  Solid solid = isotropic_solid(bar_mesh(), rubber);
  for (Index v = 0; v < solid.mesh.num_nodes(); ++v)
    if (solid.mesh.nodes(v, 2) < 0.05) {
      solid.mesh.nodes(v, 2) = 0;
      solid.held_axes.push_back({v, along_z});
    }
  with_system(solid, [&](const auto& system) {
    const VibrationModes modes = vibration_modes(system.rest_state(), {.num_modes = 8});
    EXPECT_EQ(modes.num_zero, 3);
    EXPECT_GT(modes.omega[3], 1);
    // the default subspace holds its finite turns: in-plane motions X, Y and 1 along x and y
    const AnyBasis basis = build_subspace(system.rest_state(), {.name = "derivatives", .modes = 6});
    std::visit(
        [&](const auto& subspace) {
          const Vector mass = system.rest_state().mass_of_rows();
          Vector turned(mass.size());
          for (Index v = 0; v < solid.mesh.num_nodes(); ++v) {
            const Point x = solid.mesh.nodes.row(v);
            turned.segment<3>(3 * v) = Point(-x[1], x[0], 0) - x.cwiseProduct(Point(1, 1, 0));
          }
          const Vector inside = subspace->reconstruct(subspace->project(mass.cwiseProduct(turned)));
          EXPECT_LT((inside - turned).norm(), 1e-8 * turned.norm());
        },
        basis);
    EXPECT_THROW(vibration_modes(system.rest_state(), {.num_modes = system.dim()}), std::invalid_argument);
  });
}

TEST(SlidingSupports, ReducedObjectsFollowTheFullOneAndSurviveAFile) {
  const Solid solid = bar_on_rollers();
  ReduceOptions options = ReduceOptions::relaxed_derivatives(8);
  options.points = 144;
  options.held_out_poses = 0;
  ReduceReport report;
  const ReducedModel model = reduce(solid, options, &report);
  const std::filesystem::path folder = test_folder();
  save_model(folder / "bar.supple", model);
  const ReducedModel loaded = load_model(folder / "bar.supple");
  EXPECT_EQ(held_axes(loaded.body), solid.held_axes);

  const AnySystem<SparseMatrix> full = full_system(solid);
  const AnySystem<Matrix> reduced = loaded.system();
  const Loads pull{.gravity = {1, 4, 2}};
  Vector u = Vector::Zero(full.dim()), q = Vector::Zero(reduced.dim());
  StaticSolver<AnySystem<SparseMatrix>> exact(full);
  StaticSolver<AnySystem<Matrix>> fitted(reduced);
  ASSERT_EQ(exact.solve(full.project(pull), u).status, Status::Converged);
  ASSERT_EQ(fitted.solve(reduced.project(pull), q).status, Status::Converged);
  expect_kept(solid, reduced.expand(q), "reduced");
  expect_kept(solid, full.expand(u), "full");
  EXPECT_LT((reduced.expand(q) - full.expand(u)).norm(), 0.25 * full.expand(u).norm());

  // a basis that moves a held node is refused, and so are supports that make no sense
  const auto refusal = [&](ReducedModel other) -> std::string {
    save_model(folder / "other.supple", other);
    try {
      (void)load_model(folder / "other.supple");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto with = [&](std::vector<HeldAxes> held) {
    ReducedModel other = model;
    std::get<Solid>(other.body).held_axes = std::move(held);
    return other;
  };
  const Index last = solid.mesh.num_nodes() - 1;
  EXPECT_THAT(refusal(with({{last, along_y}})), testing::HasSubstr("along y, where it is held"));
  EXPECT_THAT(refusal(with({{last + 1, along_y}})), testing::HasSubstr("held_axes.nodes names node"));
  EXPECT_THAT(refusal(with({{solid.fixed_nodes[0], along_y}})), testing::HasSubstr("none that is fixed"));
  EXPECT_THAT(refusal(with({{last, 0}})), testing::HasSubstr("expected 1 to 6"));
}

TEST(SlidingSupports, RefuseSnapshotsThatMoveThem) {
  const Solid solid = bar_on_rollers();
  with_system(solid, [&](const auto& system) {
    Matrix snapshots = Matrix::Zero(3 * solid.mesh.num_nodes(), 1);
    snapshots(3 * solid.held_axes[0].node + 2, 0) = 0.1;
    EXPECT_THROW(build_subspace(system.rest_state(), {.name = "pca", .snapshots = snapshots}), std::invalid_argument);
  });
}

}  // namespace
}  // namespace supple::test

// Free bodies keep their rigid motions: in every subspace, for every recipe, whatever was selected.

#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/body/body_system.hpp>
#include <physics/body/force_models.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <reduction/subspace/rigid_modes.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/solids.hpp>

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace supple::test {
namespace {

std::vector<std::pair<std::string, Body>> free_bodies() {
  QuadraticTetSolid points =
      isotropic_solid(irregular_box<QuadraticTet>({3, 1, 1}, 0.2), rubber, {}, "stable-neo-hookean");
  points.component = SolidComponent::GaussPoint;
  return {{"tets", isotropic_solid(bar_mesh(), rubber)},
          {"hexahedra", isotropic_solid(irregular_box<TrilinearHex>({5, 2, 2}, 0.1), rubber, {}, "neo-hookean")},
          {"Gauss points of curved quadratic tets", std::move(points)},
          {"shell", isotropic_shell(perturbed(equilateral_grid(6, 4, 0.1), 0.01, 5), {.young = 1e6}, 0.01)}};
}

/// Calls visit(rest state), which refers to the full system.
template <typename Visitor>
auto with_rest_state(const Body& body, const Visitor& visit) {
  return with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    const FullSystem<Model> system(model, nodal_mass(body), fixed_nodes(body));
    return visit(system.rest_state());
  });
}

/// Translations and infinitesimal rotations of a body in one piece, 3n × 6.
Matrix rigid_motions(const Body& body) {
  return with_rest_state(body, [&](const RestState& rest) -> Matrix {
    return rigid_modes(node_positions(body), find_free_components(rest.stencils, rest.stencil_size, rest.numbering));
  });
}

/// Their coordinates in the model's subspace, d × 6; a failure if they are not in it.
Matrix rigid_coordinates(const ReducedModel& model) {
  const Matrix R = rigid_motions(model.body);
  const Vector mass = nodal_mass(model.body).replicate(1, 3).transpose().reshaped();
  return std::visit(
      [&](const auto& basis) {
        Matrix Q(basis->dim(), R.cols());
        for (Index j = 0; j < R.cols(); ++j) {
          Q.col(j) = basis->project(mass.cwiseProduct(R.col(j)));
          EXPECT_LT((basis->reconstruct(Q.col(j)) - R.col(j)).norm(), 1e-12 * R.col(j).norm()) << "motion " << j;
        }
        return Q;
      },
      model.subspace);
}

struct Recipe {
  std::string name;
  ReduceOptions options;
};

std::vector<Recipe> recipes() {
  std::vector<Recipe> all{{"relaxed", ReduceOptions::relaxed_derivatives(10)},
                          {"relaxed, extended", ReduceOptions::relaxed_extended(9)},
                          {"subspace", {}},
                          {"paper", ReduceOptions::paper()}};
  all[0].options.subspace = "derivatives:num_derivatives=20";
  for (const std::string subspace :
       {"modal", "skinning", "derivatives:affine_fields=no:num_derivatives=12", "modal+skinning"}) {
    all.push_back({subspace, {}});
    all.back().options.subspace = subspace;
  }
  for (auto& [name, options] : all) {
    if (name != "relaxed") options.modes = 9;
    options.poses.count = 30;
    options.held_out_poses = options.full_loads = 0;
    if (options.equilibria != 0) options.equilibria = 8;
    options.points = 60;
  }
  return all;
}

TEST(RigidMotions, CostNothingInAnyModelOfAFreeBody) {
  for (const auto& [kind, body] : free_bodies())
    for (const auto& [name, options] : recipes()) {
      SCOPED_TRACE(kind + ", " + name);
      ReduceReport report;
      const ReducedModel model = reduce(body, options, &report);
      const Matrix Q = rigid_coordinates(model);
      const AnySystem<Matrix> system = model.system();
      const Matrix K = system.stiffness(Vector::Zero(model.dim()));
      const double size = K.norm() * Q.norm();
      EXPECT_LT((K * Q).norm(), 1e-12 * size) << "fitted";
      EXPECT_LT((model.rest_stiffness * Q).norm(), 1e-12 * size) << "exact";
      for (int axis = 0; axis < 3; ++axis)  // by a hundred metres
        EXPECT_LT(system.force(100 * Q.col(axis)).norm(), 1e-12 * 100 * size) << "along " << axis;
      // and nothing else does
      const Vector eigenvalues = symmetric_eigenvalues(K);
      EXPECT_LT(eigenvalues[5], 1e-12 * K.norm());
      ASSERT_FALSE(report.rest_stiffness.is_singular());
      EXPECT_GT(eigenvalues[6], 0.01 * report.exact_eigenvalues[0]);
    }
}

// Loads at rest push no free body apart from its momentum: Σ w f is free of net force and torque.
TEST(RigidMotions, AreNotPushedByForcesOfAnyModel) {
  for (const auto& [kind, body] : free_bodies())
    for (const auto& [name, options] : recipes()) {
      if (options.relaxed) continue;  // one fit is enough, this is of the components
      SCOPED_TRACE(kind + ", " + name);
      const ReducedModel model = reduce(body, options);
      const Matrix Q = rigid_coordinates(model);
      const Vector f = model.system().force(random_vector(model.dim(), 1e-3, 4));
      EXPECT_LT((Q.leftCols(3).transpose() * f).norm(), 1e-11 * f.norm() * Q.norm());
    }
}

TEST(RigidMotions, AreCountedWhereASubspaceLacksThem) {
  const auto notes_of = [](const AnyBasis& basis) {
    return std::visit([](const auto& some) { return some->report.notes; }, basis);
  };
  for (const auto& [kind, body] : free_bodies()) {
    SCOPED_TRACE(kind);
    const Matrix R = rigid_motions(body);
    SubspaceChoice choice{.name = "pca", .modes = 9, .snapshots = random_matrix(R.rows(), 5, 1, 2)};
    with_rest_state(body, [&](const RestState& rest) {
      const AnyBasis none = build_subspace(rest, choice);
      EXPECT_EQ(missing_rigid_motions(rest, none), 6);
      EXPECT_THAT(notes_of(none), testing::Contains(testing::HasSubstr("lacks 6 rigid motions")));
      choice.snapshots.leftCols(2) = R.leftCols(2);
      EXPECT_EQ(missing_rigid_motions(rest, build_subspace(rest, choice)), 4);
      choice.name = "modal+pca";
      const AnyBasis all = build_subspace(rest, choice);
      EXPECT_EQ(missing_rigid_motions(rest, all), 0);
      EXPECT_THAT(notes_of(all), testing::Not(testing::Contains(testing::HasSubstr("rigid"))));
    });
  }
  const Body held = isotropic_solid(bar_mesh(), rubber, bar_end(bar_mesh()));
  with_rest_state(held, [](const RestState& rest) {
    EXPECT_EQ(missing_rigid_motions(rest, build_subspace(rest, {.name = "modal", .modes = 4})), 0);
  });
}

}  // namespace
}  // namespace supple::test

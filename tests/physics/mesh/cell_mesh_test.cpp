#include <physics/body/body.hpp>
#include <physics/body/force_models.hpp>
#include <physics/body/material_law.hpp>
#include <physics/body/solid_model.hpp>
#include <physics/material/neo_hookean.hpp>
#include <physics/mesh/cell_mesh.hpp>
#include <physics/mesh/mass.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/solids.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using testing::HasSubstr;

TEST(CheckMesh, WantsHexahedraOnEitherSideOfAFace) {
  HexMesh mesh = hex_box(2, 1, 1, {2, 1, 1});
  EXPECT_NO_THROW(check_mesh(mesh));
  const auto message = [](const auto& some) -> std::string {
    try {
      check_mesh(some);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  HexMesh folded = mesh;  // the second cell over the first
  for (Index v = 0; v < folded.num_nodes(); ++v)
    if (folded.nodes(v, 0) > 1.5) folded.nodes(v, 0) = 0.1;
  folded.cells[1] = reversed(folded.cells[1]);
  EXPECT_THAT(message(folded), HasSubstr("hex 0 and hex 1 overlap"));
  HexMesh three = mesh;
  three.nodes.conservativeResize(16, 3);
  for (int k = 0; k < 4; ++k) three.nodes.row(12 + k) = three.nodes.row(mesh.cells[1][std::array{1, 2, 5, 6}[k]]) * 1.5;
  auto third = mesh.cells[1];
  third[1] = 12, third[2] = 13, third[5] = 14, third[6] = 15;
  three.cells.push_back(third);
  EXPECT_THAT(message(three), HasSubstr("share their face"));
  QuadraticTetMesh tets = quadratic_mesh(kuhn_box(1, 1, 1, 1));
  EXPECT_EQ(message(tets), "");
  tets.nodes.conservativeResize(tets.num_nodes() + 1, 3);  // its own node amid the diagonal, which all six share
  Index at = 0;
  for (int k = 4; k < 10; ++k)
    if ((tets.nodes.row(tets.cells[0][k]).array() == 0.5).all()) at = k;
  ASSERT_GE(at, 4);
  tets.nodes.bottomRows(1).setConstant(0.5);
  tets.cells[0][at] = tets.num_nodes() - 1;
  EXPECT_THAT(message(tets), HasSubstr("have different nodes amid the edges of their common face"));
}

TEST(CellMesh, BoundaryIsAClosedSurfaceAroundTheVolume) {
  const auto expect_closed = [](const auto& mesh, Index num_triangles) {
    const std::vector<Triangle> faces = boundary_faces(mesh);
    EXPECT_EQ(static_cast<Index>(faces.size()), num_triangles);
    double around = 0, inside = 0;
    for (const auto& [a, b, c] : faces) {
      const Point x = mesh.nodes.row(a), y = mesh.nodes.row(b), z = mesh.nodes.row(c);
      around += x.cross(y).dot(z) / 6;
    }
    for (Index e = 0; e < mesh.num_cells(); ++e) inside += cell_volume(mesh, e);
    EXPECT_NEAR(around, inside, 1e-14);
    EXPECT_EQ(boundary_hinges(mesh).edges + boundary_hinges(mesh).nodes, 0);
    EXPECT_EQ(connected_components(mesh).count, 1);
  };
  expect_closed(hex_box(3, 2, 2, {0.3, 0.2, 0.2}), 2 * 2 * (6 + 6 + 4));
  expect_closed(quadratic_mesh(kuhn_box(2, 2, 1, 0.1)), 4 * 2 * 2 * (4 + 2 + 2));
}

TEST(CellMesh, ReversedCellsHaveTheOppositeVolume) {
  HexMesh hexes = irregular_box<TrilinearHex>({1, 1, 1}, 0.1);
  const double hex = cell_volume(hexes, 0);
  hexes.cells[0] = reversed(hexes.cells[0]);
  EXPECT_NEAR(cell_volume(hexes, 0), -hex, 1e-17);
  QuadraticTetMesh tets = irregular_box<QuadraticTet>({1, 1, 1}, 0.1);
  const double tet = cell_volume(tets, 3);
  tets.cells[3] = reversed(tets.cells[3]);
  EXPECT_NEAR(cell_volume(tets, 3), -tet, 1e-17);
}

TEST(CellMesh, ScaledJacobianIsOneForBricks) {
  HexMesh mesh = hex_box(1, 1, 1, {1, 7, 0.1});
  EXPECT_NEAR(scaled_jacobian(mesh, 0), 1, 1e-15);
  mesh.nodes.row(7) = mesh.nodes.row(0) + 1e-9 * mesh.nodes.row(7);
  EXPECT_LT(scaled_jacobian(mesh, 0), 0.1);
}

/// By name, a solid is the same force model as by type, whatever its components.
template <typename Mesh>
void expect_the_static_model(const Mesh& mesh) {
  SolidOf<Mesh> solid = isotropic_solid(mesh, {.young = 1e5, .poisson = 0.4}, {}, "neo-hookean");
  solid.parameters.conservativeResize(2, Eigen::NoChange);
  solid.parameters.row(1) = 3 * solid.parameters.row(0);
  for (Index e = 0; e < mesh.num_cells(); ++e) solid.material_of_cell.push_back(static_cast<std::int32_t>(e % 2));
  const auto expect_same = [&](const auto& expected) {
    with_force_model(solid, [&](const auto& model) {
      if constexpr (std::remove_cvref_t<decltype(*model)>::local_dofs ==
                    std::remove_cvref_t<decltype(expected)>::local_dofs) {
        constexpr int dofs = std::remove_cvref_t<decltype(expected)>::local_dofs;
        ASSERT_EQ(model->num_components(), expected.num_components());
        EXPECT_TRUE(model->has_jacobian());
        for (Index i = 0; i < expected.num_components(); ++i) {
          const Local<dofs> u = random_vector(dofs, 0.01, static_cast<std::uint64_t>(i));
          EXPECT_TRUE(std::ranges::equal(model->stencil(i), expected.stencil(i)));
          const Local<dofs> f = expected.force(i, u);
          const LocalMatrix<dofs> K = expected.stiffness(i, u);
          // both are compiled from one formula, whose sums a compiler may fuse differently
          EXPECT_NEAR(model->energy(i, u), expected.energy(i, u), 1e-13 * K.norm() * u.squaredNorm());
          EXPECT_TRUE(is_near(model->force(i, u), f, 1e-13 * K.norm() * u.norm()));
          EXPECT_TRUE(is_near(model->stiffness(i, u), K, 1e-13 * K.norm()));
        }
      } else {
        ADD_FAILURE() << "a model of other cells";
      }
    });
  };
  expect_same(make_model<NeoHookean>(solid));
  solid.component = SolidComponent::GaussPoint;
  expect_same(make_model<NeoHookean, SolidComponent::GaussPoint>(solid));
  EXPECT_EQ(component_name(solid), "Gauss points");
  EXPECT_EQ(num_cells(Body(solid)), mesh.num_cells());
  EXPECT_TRUE(is_same(nodal_mass(solid), lumped_mass<ElementOf<Mesh>>(mesh, 1000.0)));
}

TEST(SolidOfCells, IsByNameWhatItIsByType) {
  expect_the_static_model(irregular_box<TrilinearHex>({2, 1, 1}, 0.1));
  expect_the_static_model(irregular_box<QuadraticTet>({1, 1, 1}, 0.2));
}

TEST(SolidOfCells, NamesLawsThatAreElementsOfTets) {
  MaterialLaw own = material_law("stvk");
  own.name = "of-tets-only";
  own.hexahedra = nullptr;
  own.quadratic_tets = nullptr;
  add_material_law(own);
  const auto refused = [](const auto& mesh, const char* cells) {
    const auto solid = isotropic_solid(mesh, {.young = 1, .poisson = 0.3}, {}, "of-tets-only");
    EXPECT_THAT([&] { (void)force_model(solid); }, testing::ThrowsMessage<std::invalid_argument>(
                                                       testing::AllOf(HasSubstr("of-tets-only"), HasSubstr(cells))));
  };
  refused(hex_box(1, 1, 1, {1, 1, 1}), "hexahedra");
  refused(quadratic_mesh(kuhn_box(1, 1, 1, 1)), "quadratic tets");
  EXPECT_NO_THROW(
      (void)force_model(isotropic_solid(kuhn_box(1, 1, 1, 1), {.young = 1, .poisson = 0.3}, {}, "of-tets-only")));
}

}  // namespace
}  // namespace supple::test

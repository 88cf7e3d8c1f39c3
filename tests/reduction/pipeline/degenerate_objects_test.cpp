// Objects at the edge of what numbers can tell: slivers, mechanisms, stiff parts beside soft ones, any unit and place.

#include <core/check.hpp>
#include <physics/body/body_system.hpp>
#include <physics/body/force_models.hpp>
#include <physics/body/material_law.hpp>
#include <physics/time/average_vector_field.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <testing/near.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/solids.hpp>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace supple::test {
namespace {

ReduceOptions quick() {
  ReduceOptions options;
  options.modes = 5;
  options.poses.count = 24;
  options.held_out_poses = 8;
  options.equilibria = 0;
  options.full_loads = 0;
  options.points = 60;
  options.selector = "nn-sp:max_iterations=12";
  return options;
}

Solid solid_of(const TetMesh& mesh, bool held = true) {
  return isotropic_solid(mesh, rubber, held ? bar_end(mesh) : std::vector<Index>{});
}

Vector frequencies(const Solid& solid, Index count) {
  const auto model = force_model(solid);
  const FullSystem<AnyModel<4>> system(model, solid.nodal_mass(), solid.fixed_nodes);
  return vibration_modes(system.rest_state(), {.num_modes = count}).omega;
}

Point centre_of(const TetMesh& mesh, const std::vector<Index>& nodes) {
  Point sum = Point::Zero();
  for (const Index v : nodes) sum += mesh.nodes.row(v).transpose();
  return sum / static_cast<double>(nodes.size());
}

Index append_node(TetMesh& mesh, const Point& x) {
  mesh.nodes.conservativeResize(mesh.num_nodes() + 1, 3);
  mesh.nodes.row(mesh.num_nodes() - 1) = x;
  return mesh.num_nodes() - 1;
}

/// A tet cut in four by a node inside, `flat` of its height over one face: the tet on that face is a sliver.
TetMesh with_flat_part(TetMesh mesh, Index e, double flat) {
  const auto [a, b, c, d] = mesh.cells[e];
  const Point base = centre_of(mesh, {b, c, d}), apex = mesh.nodes.row(a);
  const Index p = append_node(mesh, base + flat * (apex - base));
  mesh.cells[e] = {p, b, c, d};
  mesh.cells.insert(mesh.cells.end(), {{a, p, c, d}, {a, b, p, d}, {a, b, c, p}});
  return mesh;
}

/// A flat tet on a face of the boundary: its tip has almost no mass.
TetMesh with_flat_tip(TetMesh mesh, double flat) {
  const Triangle face = boundary_faces(mesh)[25];
  const Point base = centre_of(mesh, {face[0], face[1], face[2]});
  const Point ab = (mesh.nodes.row(face[1]) - mesh.nodes.row(face[0])).transpose();
  const Point ac = (mesh.nodes.row(face[2]) - mesh.nodes.row(face[0])).transpose();
  const Index p = append_node(mesh, base + flat * 0.1 * ab.cross(ac).normalized());
  mesh.cells.push_back({face[0], face[1], face[2], p});
  return mesh;
}

constexpr Index cut = 70;

// What a sliver adds to an object is nothing, and so is what it does to its motions: 1e-4 is about what a node in place of
// none does to this coarse bar.
TEST(Slivers, ChangeNoFrequency) {
  const TetMesh bar = bar_mesh();
  const Vector expected = frequencies(solid_of(bar), 5);
  for (const double flat : {1e-4, 1e-6, 1e-8, 1e-9, 1e-10}) {
    SCOPED_TRACE(flat);
    const Vector part = frequencies(solid_of(with_flat_part(bar, cut, flat)), 5);
    const Vector tip = frequencies(solid_of(with_flat_tip(bar, flat)), 5);
    EXPECT_LT((part - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff(), 3e-3);
    EXPECT_LT((tip - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff(), 2 * flat + 1e-15 / flat);
  }
}

TEST(Slivers, OfDifferentHeightsAreAlike) {
  const TetMesh bar = bar_mesh();
  const Vector expected = frequencies(solid_of(with_flat_part(bar, cut, 1e-6)), 5);
  for (const double flat : {1e-7, 1e-8, 1e-9, 1e-10}) {
    const Vector omega = frequencies(solid_of(with_flat_part(bar, cut, flat)), 5);
    EXPECT_LT((omega - expected).cwiseQuotient(expected).cwiseAbs().maxCoeff(), 1e-5 + 1e-15 / flat) << flat;
  }
}

TEST(Slivers, LeaveReducedModelsAsGoodAsTheyAre) {
  const TetMesh bar = bar_mesh();
  ReduceReport plain;
  (void)reduce(solid_of(bar), quick(), &plain);
  for (const bool held : {true, false})
    for (const double flat : {1e-4, 1e-8, 1e-10})
      for (const TetMesh& mesh : {with_flat_part(bar, cut, flat), with_flat_tip(bar, flat)}) {
        SCOPED_TRACE(flat);
        ReduceOptions options = quick();
        if (!held) options.modes = 10;
        ReduceReport report;
        const ReducedModel model = reduce(solid_of(mesh, held), options, &report);
        EXPECT_LT(report.held_out_error, 2 * plain.held_out_error);
        EXPECT_TRUE(model.weights.allFinite());
        EXPECT_FALSE(report.rest_stiffness.is_weak());
        EXPECT_TRUE(report.notes.empty()) << report.notes[0];
      }
}

// Steps of the full object end at their tolerance, with the motion of the object without the sliver.
TEST(Slivers, LetTheFullObjectMove) {
  const TetMesh bar = bar_mesh();
  const auto tip_after = [&](const TetMesh& mesh) {
    const AnySystem<SparseMatrix> system = full_system(solid_of(mesh));
    AverageVectorField integrator(system, 0.02, {.tolerance = 1e-8});
    State state = integrator.at_rest();
    const auto load = system.project({.gravity = {0, -3, 0}});
    for (int step = 0; step < 8; ++step) {
      EXPECT_EQ(integrator.step(load, state).status, Status::Converged);
    }
    return Point(system.expand(state.u).segment<3>(3 * (bar.num_nodes() - 1)));
  };
  const Point expected = tip_after(bar);
  ASSERT_GT(expected.norm(), 0.02);
  for (const double flat : {1e-4, 1e-6, 1e-8}) {
    SCOPED_TRACE(flat);
    EXPECT_LT((tip_after(with_flat_part(bar, cut, flat)) - expected).norm(), 0.01 * expected.norm());
    EXPECT_LT((tip_after(with_flat_tip(bar, flat)) - expected).norm(), 1e-4 * expected.norm());
  }
}

TEST(Slivers, WithoutVolumeOrInvertedAreRefusedByName) {
  const TetMesh bar = bar_mesh();
  std::vector<TetMesh> meshes{with_flat_part(bar, cut, -1e-6), with_flat_part(bar, cut, -0.1), bar};
  const Index copy = append_node(meshes.back(), bar.nodes.row(bar.cells[cut][1]).transpose());
  meshes.back().cells[cut][0] = copy;  // two of its nodes are in one place
  for (const TetMesh& mesh : meshes) {
    const Solid solid = solid_of(mesh);
    EXPECT_THAT([&] { (void)reduce(solid, quick()); },
                testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("tet " + std::to_string(cut))));
    EXPECT_THAT([&] { (void)full_system(solid); },
                testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("tet " + std::to_string(cut))));
  }
}

TEST(MasslessNodes, AreRefusedByName) {
  Solid solid = solid_of(bar_mesh());
  const Index lonely = append_node(solid.mesh, {3, 3, 3});
  EXPECT_THAT([&] { (void)reduce(solid, quick()); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("node " + std::to_string(lonely))));
  solid = solid_of(bar_mesh());
  solid.density = Vector::Constant(solid.mesh.num_cells(), 1000);
  solid.density[31] = 0;
  EXPECT_THAT([&] { (void)reduce(solid, quick()); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("density of tet 31 is 0")));
}

/// Two meshes as one, with the nodes of `second` that lie on nodes of `first` identified.
TetMesh glued(TetMesh first, const TetMesh& second) {
  std::vector<Index> number;
  const Index n = first.num_nodes();
  for (Index v = 0; v < second.num_nodes(); ++v) {
    Index same = 0;
    while (same < n && (first.nodes.row(same) - second.nodes.row(v)).norm() > 1e-9) ++same;
    number.push_back(same < n ? same : append_node(first, second.nodes.row(v)));
  }
  for (Tet tet : second.cells) {
    for (Index& v : tet) v = number[v];
    first.cells.push_back(tet);
  }
  return first;
}
TetMesh moved(TetMesh mesh, const Point& by) {
  mesh.nodes.rowwise() += by.transpose();
  return mesh;
}

// Motions without energy beside the rigid ones: three about a common node, one about a common edge, and of tets in a chain,
// joined at vertices, three a joint.
TEST(Mechanisms, HaveAsManyZeroModesAsTheyHaveJoints) {
  const TetMesh block = kuhn_box(2, 2, 2, 0.1);
  TetMesh chain = single_tet(0.1);
  for (int k = 1; k < 6; ++k) chain = glued(chain, moved(single_tet(0.1), {0.1 * k, 0, 0}));
  struct Joined {
    std::string name;
    TetMesh mesh;
    Index motions;
  };
  for (const auto& [name, mesh, motions] :
       {Joined{"a node", glued(block, moved(block, {0.2, 0.2, 0.2})), 3},
        Joined{"an edge", glued(block, moved(block, {0.2, 0.2, 0})), 1}, Joined{"tets at vertices", chain, 15},
        Joined{"a single tet", single_tet(0.1), 0}}) {
    SCOPED_TRACE(name);
    const Solid solid = solid_of(mesh, false);
    const auto model = force_model(solid);
    const FullSystem<AnyModel<4>> system(model, solid.nodal_mass());
    const Matrix K = system.rest_stiffness();
    const Vector exact =
        Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(K, Matrix(system.mass().asDiagonal()), Eigen::EigenvaluesOnly)
            .eigenvalues();
    const Index zero = 6 + motions, count = std::min<Index>(system.dim(), zero + 4);
    ASSERT_LT(exact[zero - 1], 1e-9 * exact[zero]);
    const VibrationModes modes = vibration_modes(system.rest_state(), {.num_modes = count});
    EXPECT_EQ(modes.num_rigid, 6);
    EXPECT_EQ(modes.num_zero, zero);
    for (Index k = zero; k < count; ++k) EXPECT_NEAR(modes.omega[k], std::sqrt(exact[k]), 1e-7 * modes.omega[k]);

    ReduceOptions options = quick();
    options.subspace = "modal";
    options.modes = count;
    ReduceReport report;
    const ReducedModel reduced = reduce(solid, options, &report);
    EXPECT_TRUE(reduced.weights.allFinite());
    EXPECT_LT(report.training_error, 0.5);
    if (motions > 0) {
      EXPECT_THAT(report.notes,
                  testing::Contains(testing::HasSubstr(std::to_string(zero) + " motions cost no energy")));
    }
  }
}

// ω(c L) = ω / c, ω ~ √(E / ρ), and nothing else: powers of two change no digit, other factors only the last.
TEST(Units, ScaleFrequenciesAsDimensionsSay) {
  const TetMesh bar = bar_mesh();
  const Vector plain = frequencies(solid_of(bar), 6);
  for (const double length : {1e-6, 1.0, 1e6})
    for (const double young : {1e-6, 1.0, 1e6})
      for (const double density : {1e-6, 1.0, 1e6}) {
        Solid solid = solid_of(bar);
        solid.mesh.nodes *= length;
        solid.parameters *= young;
        solid.density *= density;
        const Vector omega = frequencies(solid, 6) * (length * std::sqrt(density / young));
        EXPECT_LT((omega - plain).cwiseQuotient(plain).cwiseAbs().maxCoeff(), 1e-9)
            << length << " m, " << young << " Pa, " << density << " kg/m^3";
      }
}

TEST(Units, DoNotChangeWhatIsSelected) {
  const TetMesh bar = bar_mesh();
  ReduceReport plain;
  const ReducedModel model = reduce(solid_of(bar), quick(), &plain);
  const auto expect_alike = [&](const Solid& solid, double tolerance) {
    ReduceReport report;
    const ReducedModel other = reduce(solid, quick(), &report);
    EXPECT_EQ(other.dim(), model.dim());
    EXPECT_NEAR(report.training_error, plain.training_error, tolerance * plain.training_error);
    EXPECT_NEAR(report.held_out_error, plain.held_out_error, tolerance * plain.held_out_error);
  };
  for (const double unit : {std::ldexp(1.0, -20), std::ldexp(1.0, 20)}) {
    Solid solid = solid_of(bar);
    solid.mesh.nodes *= unit;
    expect_alike(solid, 0.5);
    solid = solid_of(bar);
    solid.parameters *= unit;
    expect_alike(solid, 0.5);
    solid = solid_of(bar);
    solid.density *= unit;
    expect_alike(solid, 0.5);
  }
  Solid far = solid_of(bar);  // coordinates have ten digits of the bar left there
  far.mesh.nodes.rowwise() += Eigen::RowVector3d(1e6, -1e6, 1e6);
  expect_alike(far, 0.5);
  const Vector here = frequencies(solid_of(bar), 6), there = frequencies(far, 6);
  EXPECT_LT((here - there).cwiseQuotient(here).cwiseAbs().maxCoeff(), 1e-8);
}

// A soft half and a stiff one: the bar moves in its soft half, the longer the stiffer the other is.
TEST(Contrast, WithinAnObjectKeepsTheSoftModes) {
  const TetMesh bar = bar_mesh();
  const auto contrasted = [&](double contrast) {
    Solid solid = solid_of(bar);
    solid.parameters.conservativeResize(2, Eigen::NoChange);
    solid.parameters.row(1) = contrast * solid.parameters.row(0);
    for (const Tet& tet : bar.cells)
      solid.material_of_cell.push_back(centre_of(bar, {tet[0], tet[1], tet[2], tet[3]})[0] > 0.3 ? 1 : 0);
    return solid;
  };
  // in the limit the stiff half is rigid
  const Vector limit = frequencies(contrasted(1e6), 3);
  for (const double contrast : {1.0, 1e2, 1e4, 1e6, 1e8}) {
    SCOPED_TRACE(contrast);
    const Solid solid = contrasted(contrast);
    const Vector omega = frequencies(solid, 3);
    if (contrast >= 1e4) {
      EXPECT_LT((omega - limit).cwiseQuotient(limit).cwiseAbs().maxCoeff(), 10 / contrast + 2e-5);
    }
    ReduceReport report;
    const ReducedModel model = reduce(solid, quick(), &report);
    EXPECT_LT(report.held_out_error, 0.3);
    EXPECT_EQ(report.rigid_modes, 0);
    EXPECT_FALSE(report.rest_stiffness.is_singular());
    const double softest = report.exact_eigenvalues[0];
    EXPECT_NEAR(std::sqrt(softest), omega[0], 1e-3 * omega[0]);
  }
}

TEST(Contrast, OfShapeAndVolumeIsBorne) {
  const TetMesh bar = bar_mesh();
  for (const double poisson : {0.49, 0.4999, 0.499999}) {
    SCOPED_TRACE(poisson);
    const Solid solid = isotropic_solid(bar, {.young = 1e5, .poisson = poisson}, bar_end(bar));
    const auto model = force_model(solid);
    const FullSystem<AnyModel<4>> system(model, solid.nodal_mass(), solid.fixed_nodes);
    const Vector exact =
        Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(Matrix(system.rest_stiffness()),
                                                         Matrix(system.mass().asDiagonal()), Eigen::EigenvaluesOnly)
            .eigenvalues()
            .head(5)
            .cwiseSqrt();
    EXPECT_LT((frequencies(solid, 5) - exact).cwiseQuotient(exact).cwiseAbs().maxCoeff(), 1e-7);
    ReduceReport report;
    (void)reduce(solid, quick(), &report);
    EXPECT_LT(report.held_out_error, 0.3);
  }
}

}  // namespace
}  // namespace supple::test

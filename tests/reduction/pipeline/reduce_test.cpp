#include <core/check.hpp>
#include <core/output_file.hpp>
#include <core/parallel.hpp>
#include <core/tensor_file.hpp>
#include <physics/body/material_law.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/model/with_reduced_system.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <reduction/pipeline/reduction.hpp>
#include <reduction/system/error_estimator.hpp>
#include <reduction/system/galerkin_system.hpp>
#include <sparse/selectors/selector_library.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/test_folder.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

namespace supple::test {
namespace {

Solid bar_solid(const std::string& law = "stvk", bool held = true) {
  Solid solid;
  solid.mesh = bar_mesh();
  solid.law = law;
  const std::vector<double> parameters = material_law(law).values({.young = 1e5, .poisson = 0.35});
  solid.parameters = Eigen::Map<const Eigen::RowVectorXd>(parameters.data(), static_cast<Index>(parameters.size()));
  if (held) solid.fixed_nodes = bar_end(solid.mesh);
  return solid;
}

/// Seconds for the lot: few modes, few poses.
ReduceOptions quick(Index points = 40) {
  ReduceOptions options;
  options.modes = 4;
  options.poses.count = 48;
  options.held_out_poses = 16;
  options.points = points;
  return options;
}

/// Nodes with x below a bound [m].
std::vector<Index> select_below(const Points& nodes, double bound) {
  std::vector<Index> selected;
  for (Index v = 0; v < nodes.rows(); ++v)
    if (nodes(v, 0) < bound) selected.push_back(v);
  return selected;
}

const RowMatrix& fields(const ReducedModel& model) {
  return std::visit([](const auto& basis) -> const RowMatrix& { return basis->W; }, model.subspace);
}

/// What holds for the model and the report of any reduction.
void expect_sound(const ReducedModel& model, const ReduceReport& report, const ReduceOptions& options) {
  ASSERT_FALSE(model.indices.empty());
  EXPECT_LE(static_cast<Index>(model.indices.size()), options.points);
  EXPECT_EQ(report.points, static_cast<Index>(model.indices.size()));
  EXPECT_EQ(model.weights.size(), report.points);
  EXPECT_GT(model.weights.minCoeff(), 0);
  EXPECT_THAT(model.indices, testing::Each(testing::AllOf(testing::Ge(0), testing::Lt(report.components))));
  EXPECT_TRUE(std::adjacent_find(model.indices.begin(), model.indices.end(), std::greater_equal<>()) ==
              model.indices.end())
      << "ascending, each once";
  EXPECT_EQ(report.dimension, model.dim());
  EXPECT_EQ(report.nodes, std::get<Solid>(model.body).mesh.num_nodes());
  EXPECT_EQ(report.components, std::get<Solid>(model.body).mesh.num_cells());
  EXPECT_EQ(report.omega.size(), options.modes);
  EXPECT_TRUE(model.rest_stiffness.rows() == model.dim() && model.rest_stiffness.allFinite());
  EXPECT_GE(report.training_error, 0);
  EXPECT_LT(report.training_error, 1);
  if (options.held_out_poses > 0) {
    ASSERT_EQ(report.held_out.size(), 3u);
    EXPECT_EQ(report.held_out[0].first, 1);
    EXPECT_EQ(report.held_out[0].second, report.held_out_error);
    for (const auto& [share, error] : report.held_out) EXPECT_TRUE(error >= 0 && error < 1) << share;
  } else {
    EXPECT_TRUE(std::isnan(report.held_out_error) && report.held_out.empty());
  }
  double stages = 0;
  for (const auto& [name, seconds] : report.seconds) stages += seconds;
  EXPECT_LE(stages, report.total_seconds);
  EXPECT_GT(report.peak_memory, 1e6);
  EXPECT_FALSE(report.selection.stop_reason.empty());
}

struct Reduced {
  explicit Reduced(const Solid& solid, const ReduceOptions& options) : model(reduce(solid, options, &report)) {
    expect_sound(model, report, options);
  }
  ReduceReport report;
  ReducedModel model;
};

TEST(Reduce, FitsBetterWithMorePoints) {
  const Solid solid = bar_solid();
  const Reduced few(solid, quick(12)), some(solid, quick(40)), many(solid, quick(100));
  EXPECT_EQ(some.model.dim(), 36);
  EXPECT_LT(some.report.training_error, 0.5 * few.report.training_error);
  EXPECT_LT(many.report.training_error, 0.5 * some.report.training_error);
  EXPECT_LT(some.report.training_error, 0.15);
  EXPECT_LT(some.report.held_out_error, 0.3);
  // the fitted stiffness at rest has the softest eigenvalues of the exact one
  ASSERT_EQ(many.report.fitted_eigenvalues.size(), 5);
  for (Index k = 0; k < 5; ++k)
    EXPECT_NEAR(many.report.fitted_eigenvalues[k] / many.report.exact_eigenvalues[k], 1, 0.1) << k;
}

TEST(Reduce, WithAllTetsReproducesTheForcesExactly) {
  ReduceOptions options = quick(144);
  options.modes = 2;
  options.poses.count = 160;  // more equations than tets: weights of one are the only answer
  options.poses.amplitudes = {0.1};
  const Reduced all(bar_solid(), options);
  EXPECT_LT(all.report.training_error, 1e-6);
  EXPECT_LT(all.report.held_out_error, 1e-4);
  EXPECT_LT((all.report.fitted_eigenvalues - all.report.exact_eigenvalues).norm(),
            1e-3 * all.report.exact_eigenvalues.norm());
}

TEST(Reduce, StopsAtTheTargetError) {
  ReduceOptions options = quick(144);
  options.target_error = 0.2;
  const Reduced reduced(bar_solid(), options);
  EXPECT_LE(reduced.report.training_error, 0.2);
  EXPECT_EQ(reduced.report.selection.status, Status::Converged) << reduced.report.selection.stop_reason;
  options.points = 3;
  options.target_error = 1e-4;
  const Reduced missed(bar_solid(), options);
  EXPECT_GT(missed.report.training_error, 1e-4);
  EXPECT_NE(missed.report.selection.status, Status::Converged) << missed.report.selection.stop_reason;
}

TEST(Reduce, FollowsTheSeedWhateverTheNumberOfThreads) {
  const Solid solid = bar_solid();
  for (const std::string selector : {"nn-sp", "nn-htp"}) {
    SCOPED_TRACE(selector);
    ReduceOptions options = quick(25);
    options.selector = selector;
    set_num_threads(1);
    const Reduced one(solid, options);
    set_num_threads(2);
    const Reduced two(solid, options);
    set_num_threads(0);
    EXPECT_EQ(one.model.indices, two.model.indices);
    EXPECT_TRUE(is_same(one.model.weights, two.model.weights));
    EXPECT_TRUE(is_same(fields(one.model), fields(two.model)));
    EXPECT_TRUE(is_same(one.model.rest_stiffness, two.model.rest_stiffness));
    EXPECT_EQ(one.report.held_out_error, two.report.held_out_error);
    options.seed = 2;
    const Reduced other(solid, options);
    EXPECT_FALSE(other.model.indices == one.model.indices && other.model.weights == one.model.weights);
  }
}

TEST(Reduce, WorksAsInThePaper) {
  ReduceOptions options = ReduceOptions::paper();
  EXPECT_EQ(options.poses.count, 1000);
  EXPECT_EQ(options.poses.omega_exponent, 1);
  options.modes = 4;
  options.poses.count = 48;
  options.points = 40;
  options.held_out_poses = 16;
  const Reduced reduced(bar_solid(), options);
  EXPECT_LT(reduced.report.training_error, 0.3);
}

TEST(Reduce, HandlesAMaterialThatIsUndefinedForInvertedTets) {
  ReduceOptions options = quick();
  options.poses.amplitudes = {0.3, 0.02};
  options.poses.omega_exponent = 1;
  const Reduced reduced(bar_solid("mooney-rivlin"), options);
  EXPECT_GT(reduced.report.inverted_poses, 0);
  EXPECT_EQ(reduced.report.shrunk_poses, reduced.report.inverted_poses);
  EXPECT_THAT(reduced.report.notes, testing::Contains(testing::HasSubstr("inverted tets")));
  EXPECT_LT(reduced.report.training_error, 0.4);
  // poses that somebody brings along, too; but there is nothing to draw in their place
  options.given_poses = Matrix::Zero(36, 3);
  options.given_poses.row(5).setLinSpaced(1, 1000);
  options.poses.inverted = InvertedPoses::Redraw;
  const Reduced given(bar_solid("mooney-rivlin"), options);
  EXPECT_GE(given.report.shrunk_poses, 2);
  EXPECT_EQ(given.report.redrawn_poses, 0);
  options.poses.inverted = InvertedPoses::Keep;
  EXPECT_THROW((void)reduce(bar_solid("mooney-rivlin"), options), std::invalid_argument);
}

TEST(Reduce, HandlesTwoMaterials) {
  Solid solid = bar_solid();
  solid.parameters.conservativeResize(2, 2);
  solid.parameters.row(1) = 100 * solid.parameters.row(0);
  solid.density = Vector::Constant(solid.mesh.num_cells(), 1000);
  for (Index e = 0; e < solid.mesh.num_cells(); ++e) {
    solid.material_of_cell.push_back(e % 72 < 36);  // stiff and soft thirds
    if (solid.material_of_cell.back()) solid.density[e] = 3000;
  }
  const Reduced reduced(solid, quick());
  EXPECT_LT(reduced.report.training_error, 0.3);
  const Reduced plain(bar_solid(), quick());
  EXPECT_GT(reduced.report.omega[0], plain.report.omega[0]) << "the materials made no difference";
}

TEST(Reduce, HandlesFreeObjectsAndTheModesAlone) {
  ReduceOptions options = quick();
  options.modes = 9;
  const Reduced free(bar_solid("stvk", false), options);
  EXPECT_EQ(free.model.dim(), 9 * 3 + 12);
  EXPECT_EQ(free.report.rigid_modes, 6);
  EXPECT_LT(free.report.training_error, 0.2);
  EXPECT_GT(free.report.exact_eigenvalues[0], 1) << "rigid motions are not listed";

  options.subspace = "modal";
  options.poses.count = 100;
  options.held_out_poses = 0;
  const Reduced modal(bar_solid("stvk", true), options);
  EXPECT_EQ(modal.model.dim(), 9);
  EXPECT_LT(modal.report.training_error, 0.2);
}

TEST(Reduce, TakesPosesAsCoordinatesOrAsDisplacements) {
  const Solid solid = bar_solid();
  ReduceOptions options = quick(30);
  options.given_poses = random_matrix(36, 20, 0.1, 4);
  const Reduced by_coordinates(solid, options);
  EXPECT_EQ(by_coordinates.report.poses, 20);
  const auto& basis = *std::get<std::shared_ptr<const NodalBasis>>(by_coordinates.model.subspace);
  Matrix U(basis.full_dim(), 20);
  for (Index t = 0; t < 20; ++t) U.col(t) = basis.reconstruct(options.given_poses.col(t));
  options.given_poses = U;
  const Reduced by_displacements(solid, options);
  EXPECT_NEAR(by_displacements.report.training_error, by_coordinates.report.training_error,
              1e-6 * by_coordinates.report.training_error);
  EXPECT_EQ(by_displacements.model.indices, by_coordinates.model.indices);
}

TEST(Reduce, NamesImpossibleOptions) {
  const auto message = [](auto&& change) -> std::string {
    ReduceOptions options = quick();
    change(options);
    try {
      (void)reduce(bar_solid(), options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no exception";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message([](auto& o) { o.points = -1; }), HasSubstr("number of points is -1"));
  EXPECT_THAT(message([](auto& o) { o.target_error = -1; }), HasSubstr("target error"));
  EXPECT_THAT(message([](auto& o) { o.target_error = std::nan(""); }), HasSubstr("target error"));
  EXPECT_THAT(message([](auto& o) { o.held_out_poses = -1; }), HasSubstr("held-out poses"));
  EXPECT_THAT(message([](auto& o) { o.subspace = "wavelets"; }), HasSubstr("subspace 'wavelets'"));
  EXPECT_THAT(message([](auto& o) { o.selector = "best"; }), HasSubstr("selector 'best'"));
  EXPECT_THAT(message([](auto& o) { o.modes = 0; }), HasSubstr("number of modes is 0"));
  EXPECT_THAT(message([](auto& o) { o.poses.count = 0; }), HasSubstr("number of poses is 0"));
  EXPECT_THAT(message([](auto& o) { o.poses.amplitudes = {-1}; }), HasSubstr("amplitude"));
  EXPECT_THAT(message([](auto& o) { o.given_poses = Matrix::Ones(7, 2); }), HasSubstr("given_poses.rows()"));
}

/// A folder of its own that goes away with the test.
struct ModelFile : testing::Test {
  ModelFile() { std::filesystem::create_directories(folder); }
  ~ModelFile() override { std::filesystem::remove_all(folder); }

  static std::string message(const std::filesystem::path& path) {
    try {
      (void)load_model(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no exception";
  }

  const std::filesystem::path folder = test_folder();
  const std::filesystem::path path = folder / "bar.supple";
};

TEST_F(ModelFile, GivesBackTheSameBits) {
  for (const std::string subspace : {"extended", "modal"}) {
    SCOPED_TRACE(subspace);
    Solid solid = bar_solid();
    solid.parameters.conservativeResize(2, 2);
    solid.parameters.row(1) = 3 * solid.parameters.row(0);
    solid.material_of_cell.assign(144, 1);
    solid.material_of_cell[7] = 0;
    solid.mesh.region.assign(144, 4);
    solid.mesh.region_names[4] = "trunk – β";
    solid.damping = {0.1, 1e-3};
    ReduceOptions options = quick(15);
    options.subspace = subspace;
    options.held_out_poses = 0;
    ReducedModel model = reduce(solid, options);
    model.provenance["seed"] = "1";
    save_model(path, model);
    const ReducedModel loaded = load_model(path);

    EXPECT_TRUE(is_same(std::get<Solid>(loaded.body).mesh.nodes, solid.mesh.nodes));
    EXPECT_EQ(std::get<Solid>(loaded.body).mesh.cells, solid.mesh.cells);
    EXPECT_EQ(std::get<Solid>(loaded.body).mesh.region, solid.mesh.region);
    EXPECT_EQ(std::get<Solid>(loaded.body).mesh.region_names, solid.mesh.region_names);
    EXPECT_EQ(std::get<Solid>(loaded.body).law, solid.law);
    EXPECT_TRUE(is_same(std::get<Solid>(loaded.body).parameters, solid.parameters));
    EXPECT_EQ(std::get<Solid>(loaded.body).material_of_cell, solid.material_of_cell);
    EXPECT_TRUE(is_same(std::get<Solid>(loaded.body).density, solid.density));
    EXPECT_EQ(std::get<Solid>(loaded.body).fixed_nodes, solid.fixed_nodes);
    EXPECT_EQ(std::get<Solid>(loaded.body).damping.alpha, 0.1);
    EXPECT_EQ(std::get<Solid>(loaded.body).damping.beta, 1e-3);
    EXPECT_EQ(loaded.subspace.index(), model.subspace.index());
    EXPECT_TRUE(is_same(fields(loaded), fields(model)));
    EXPECT_TRUE(is_same(loaded.omega(), model.omega()));
    EXPECT_EQ(loaded.indices, model.indices);
    EXPECT_TRUE(is_same(loaded.weights, model.weights));
    EXPECT_TRUE(is_same(loaded.rest_stiffness, model.rest_stiffness));
    EXPECT_EQ(loaded.provenance, model.provenance);

    const auto force = [](const ReducedModel& of) {
      return with_reduced_system(of,
                                 [](const auto& system) { return system.force(random_vector(system.dim(), 0.1, 1)); });
    };
    EXPECT_TRUE(is_same(force(loaded), force(model)));
    const std::string bytes = read_file(path);
    save_model(path, loaded);
    EXPECT_EQ(read_file(path), bytes);
  }
}

TEST_F(ModelFile, KeepsTheIndicatorAndRefusesAWrongOne) {
  ReduceOptions options = ReduceOptions::relaxed_derivatives(6);
  options.points = 30;
  const ReducedModel model = reduce(bar_solid(), options);
  ASSERT_TRUE(model.indicator);
  save_model(path, model);
  const ReducedModel loaded = load_model(path);
  ASSERT_TRUE(loaded.indicator);
  EXPECT_EQ(loaded.indicator->indices, model.indicator->indices);
  EXPECT_TRUE(is_same(loaded.indicator->weights, model.indicator->weights));
  EXPECT_TRUE(is_same(loaded.indicator->rows, model.indicator->rows));
  EXPECT_TRUE(is_same(loaded.indicator->outside_stiffness, model.indicator->outside_stiffness));
  EXPECT_EQ(loaded.indicator->scale, model.indicator->scale);
  EXPECT_EQ(loaded.indicator->trained_size, model.indicator->trained_size);

  const auto changed = [&](auto&& change) {
    ReducedModel other = model;
    change(*other.indicator);
    save_model(path, other);
    return message(path);
  };
  EXPECT_THAT(changed([&](auto& i) { i.indices.front() = model.indices.front(); }), testing::HasSubstr("indicator"));
  EXPECT_THAT(changed([](auto& i) { i.indices.back() = 144; }), testing::HasSubstr("names component 144"));
  EXPECT_THAT(changed([](auto& i) { i.weights[0] = 0; }), testing::HasSubstr("indicator.weights are not all positive"));
  EXPECT_THAT(changed([](auto& i) { i.rows.conservativeResize(i.rows.rows() - 9, Eigen::NoChange); }),
              testing::HasSubstr("indicator.rows"));
  EXPECT_THAT(changed([](auto& i) { i.rows(0, 0) = std::nan(""); }), testing::HasSubstr("not finite"));
  EXPECT_THAT(changed([](auto& i) { i.outside_stiffness[0] = -1; }), testing::HasSubstr("outside_stiffness"));
  EXPECT_THAT(changed([](auto& i) { i.scale = 0; }), testing::HasSubstr("indicator.calibration"));
}

TEST_F(ModelFile, IsRefusedIfAnythingIsWrongWithIt) {
  ReduceOptions options = quick(10);
  options.modes = 1;
  options.held_out_poses = 0;
  ReducedModel model = reduce(bar_solid(), options);
  save_model(path, model);
  const std::string bytes = read_file(path);
  ASSERT_EQ(message(path), "no exception");

  EXPECT_THAT(message(folder / "absent"), testing::HasSubstr("absent"));
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{7}, std::size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
    write_file(path, std::string_view(bytes).substr(0, size));
    EXPECT_THAT(message(path), testing::HasSubstr("bar.supple")) << size << " bytes";
  }
  write_file(path, "solid bar\n  facet normal 0 0 1\n this is another kind of file altogether\n");
  EXPECT_THAT(message(path), testing::HasSubstr("bar.supple"));
  std::string flipped = bytes;
  flipped[bytes.size() - 100] ^= 1;
  write_file(path, flipped);
  EXPECT_THAT(message(path), testing::HasSubstr("bar.supple"));

  // inconsistent contents under valid checksums
  const auto changed = [&](auto&& change) {
    ReducedModel other = model;
    change(other);
    save_model(path, other);
    return message(path);
  };
  EXPECT_THAT(changed([](auto& m) { m.indices.back() = 144; }), testing::HasSubstr("names component 144"));
  EXPECT_THAT(changed([](auto& m) { m.indices.pop_back(); }), testing::HasSubstr("selection.weights"));
  EXPECT_THAT(changed([](auto& m) { m.indices[1] = m.indices[0]; }), testing::HasSubstr("not ascending"));
  EXPECT_THAT(changed([](auto& m) { m.weights[0] = -1; }), testing::HasSubstr("not all positive"));
  EXPECT_THAT(changed([](auto& m) { m.weights[0] = std::nan(""); }), testing::HasSubstr("not finite"));
  EXPECT_THAT(changed([](auto& m) { std::get<Solid>(m.body).mesh.cells[3][1] = -2; }),
              testing::HasSubstr("names node -2"));
  EXPECT_THAT(changed([](auto& m) { std::get<Solid>(m.body).fixed_nodes = {63}; }),
              testing::HasSubstr("names node 63"));
  EXPECT_THAT(changed([](auto& m) { std::ranges::reverse(std::get<Solid>(m.body).fixed_nodes); }),
              testing::HasSubstr("fixed_nodes are not ascending"));
  EXPECT_THAT(changed([](auto& m) { std::get<Solid>(m.body).law = "jelly"; }), testing::HasSubstr("jelly"));
  EXPECT_THAT(changed([](auto& m) { std::get<Solid>(m.body).density = Vector::Ones(5); }),
              testing::HasSubstr("bar.supple"));
  EXPECT_THAT(changed([](auto& m) { m.rest_stiffness.setZero(8, 9); }), testing::HasSubstr("rest_stiffness"));
  EXPECT_THAT(changed([](auto& m) { m.rest_stiffness(0, 1) *= 2; }), testing::HasSubstr("not symmetric"));
  EXPECT_THAT(changed([](auto& m) { m.indices.clear(), m.weights.resize(0); }), testing::HasSubstr("is empty"));
  EXPECT_THAT(changed([](auto& m) { std::get<Solid>(m.body).fixed_nodes.push_back(62); }),
              testing::HasSubstr("moves node 62, which is fixed"));
  EXPECT_THAT(changed([](auto& m) { std::get<Solid>(m.body).density *= 4; }), testing::HasSubstr("not orthonormal"));
  EXPECT_THAT(changed([](auto& m) {
                NodalBasis none = *std::get<std::shared_ptr<const NodalBasis>>(m.subspace);
                none.W.conservativeResize(Eigen::NoChange, 0);
                m.subspace = std::make_shared<const NodalBasis>(std::move(none));
                m.rest_stiffness.resize(0, 0);
              }),
              testing::HasSubstr("subspace.W has no columns"));
  EXPECT_THAT(changed([](auto& m) {
                NodalBasis more = *std::get<std::shared_ptr<const NodalBasis>>(m.subspace);
                more.report.zero_modes = 2;
                m.subspace = std::make_shared<const NodalBasis>(std::move(more));
              }),
              testing::HasSubstr("subspace.zero_modes is 2, expected 0 to 1"));
  EXPECT_THAT(changed([](auto& m) {
                std::swap(std::get<Solid>(m.body).mesh.cells[0][0], std::get<Solid>(m.body).mesh.cells[0][1]);
              }),
              testing::HasSubstr("tet 0 has det J"));
}

TEST(Reduce, ReducesAShellAndKeepsIt) {
  const TriangleMesh mesh = equilateral_grid(8, 4, 0.1);
  Shell shell = isotropic_shell(mesh, {.young = 1e6, .poisson = 0.4}, 0.02, {0, 1, 2, 3, 4}, 700);
  shell.damping = {0.1, 1e-3};
  ReduceOptions options = quick(60);
  ReduceReport report;
  const ReducedModel model = reduce(shell, options, &report);
  EXPECT_EQ(report.components, static_cast<Index>(interior_edges(mesh).size()));
  EXPECT_LT(report.training_error, 0.3);
  const std::filesystem::path path = test_folder() / "shell.supple";
  save_model(path, model);
  const ReducedModel loaded = load_model(path);
  const Shell& kept = std::get<Shell>(loaded.body);
  EXPECT_EQ(kept.mesh.triangles, mesh.triangles);
  EXPECT_TRUE(is_same(kept.mesh.nodes, mesh.nodes));
  EXPECT_EQ(kept.materials[0].bending, shell.materials[0].bending);
  EXPECT_EQ(kept.materials[0].stretch, shell.materials[0].stretch);
  EXPECT_EQ(kept.materials[0].area, shell.materials[0].area);
  EXPECT_EQ(kept.thickness, shell.thickness);
  EXPECT_EQ(kept.fixed_nodes, shell.fixed_nodes);
  const Vector q = random_vector(model.dim(), 1e-2, 3);
  const auto force = [&](const ReducedModel& some) {
    return with_reduced_system(some, [&](const auto& system) { return system.force(q); });
  };
  EXPECT_TRUE(is_same(force(loaded), force(model)));
}

TEST(Reduce, CountsTheMotionsOfAHingeWithoutEnergy) {
  // A thin plate held along one line of nodes turns about it; its other modes are soft beside the stiffness within it.
  const TriangleMesh mesh = equilateral_grid(8, 6, 0.1);
  for (const double thickness : {0.02, 1e-3, 3e-4}) {
    SCOPED_TRACE(thickness);
    const std::vector<Index> line = nodes_where(mesh, [](const Point& x) { return x[1] < 1e-6; });
    const Shell shell = isotropic_shell(mesh, {.young = 1e6, .poisson = 0.4}, thickness, line, 700);
    for (const std::string subspace : {"extended", "derivatives"}) {
      SCOPED_TRACE(subspace);
      ReduceOptions options = quick(60);
      options.subspace = subspace;
      ReduceReport report;
      const ReducedModel model = reduce(shell, options, &report);
      const ReducedModes modes = reduced_modes(model);
      EXPECT_EQ(modes.num_zero, 1);
      EXPECT_EQ(report.rigid_modes, 0);
      const double softest = modes.omega[1] * modes.omega[1];
      EXPECT_NEAR(report.exact_eigenvalues[0], softest, 1e-6 * softest);
      EXPECT_GT(softest, 1e3 * std::pow(modes.omega[0], 2));
      EXPECT_LT(report.training_error, 0.3);
      EXPECT_LT(report.held_out_error, 0.3);
      const std::filesystem::path path = test_folder() / "hinge.supple";
      save_model(path, model);
      EXPECT_EQ(reduced_modes(load_model(path)).num_zero, 1);
    }
  }
}

/// Reduced, kept and loaded again, an object of other cells has the same forces, to the bit.
template <typename Mesh>
void expect_kept(const Mesh& mesh, const char* array) {
  auto solid =
      isotropic_solid(mesh, {.young = 1e5, .poisson = 0.35}, select_below(mesh.nodes, 0.02), "neo-hookean", 900);
  solid.damping = {0.1, 1e-3};
  solid.mesh.region.assign(mesh.num_cells(), 2);
  solid.mesh.region_names[2] = "all";
  solid.parameters.conservativeResize(2, Eigen::NoChange);
  solid.parameters.row(1) = 3 * solid.parameters.row(0);
  for (Index e = 0; e < mesh.num_cells(); ++e) solid.material_of_cell.push_back(static_cast<std::int32_t>(e % 2));
  for (const SolidComponent component : {SolidComponent::Element, SolidComponent::GaussPoint}) {
    SCOPED_TRACE(static_cast<int>(component));
    solid.component = component;
    ReduceReport report;
    const ReducedModel model = reduce(solid, quick(40), &report);
    using Element = ElementOf<Mesh>;
    const Index per_cell = component == SolidComponent::Element ? 1 : static_cast<Index>(Element::gauss_points.size());
    EXPECT_EQ(report.components, per_cell * mesh.num_cells());
    EXPECT_LT(report.training_error, 0.4);
    const std::filesystem::path path = test_folder() / "cells.supple";
    save_model(path, model);
    EXPECT_TRUE(TensorFile(path).contains(array));
    const ReducedModel loaded = load_model(path);
    const auto& kept = std::get<SolidOf<Mesh>>(loaded.body);
    EXPECT_EQ(kept.mesh.cells, mesh.cells);
    EXPECT_EQ(kept.mesh.region, solid.mesh.region);
    EXPECT_EQ(kept.mesh.region_names, solid.mesh.region_names);
    EXPECT_EQ(kept.material_of_cell, solid.material_of_cell);
    EXPECT_EQ(kept.component, component);
    const Vector q = random_vector(model.dim(), 1e-2, 3);
    const auto force = [&](const ReducedModel& some) {
      return with_reduced_system(some, [&](const auto& system) { return system.force(q); });
    };
    EXPECT_TRUE(is_same(force(loaded), force(model)));
    const std::string bytes = read_file(path);
    save_model(path, loaded);
    EXPECT_EQ(read_file(path), bytes);
  }
}

TEST(Reduce, ReducesHexahedraAndKeepsThem) {
  expect_kept(perturbed(hex_box(6, 2, 2, {0.6, 0.2, 0.2}), 0.005, 3), "mesh.hexahedra");
}
TEST(Reduce, ReducesQuadraticTetsAndKeepsThem) {
  expect_kept(quadratic_mesh(kuhn_box(4, 1, 1, 0.1)), "mesh.quadratic_tets");
}

TEST(Reduce, ComparesItsEquilibriaWithTheFullObject) {
  for (const bool held : {true, false}) {
    SCOPED_TRACE(held);
    ReduceOptions options = quick(80);
    options.modes = held ? 4 : 10;
    options.full_loads = 5;
    ReduceReport report;
    (void)reduce(bar_solid("stvk", held), options, &report);
    const FullError& full = report.full_error;
    EXPECT_EQ(full.loads + full.unfinished, 5);
    EXPECT_GE(full.loads, 4);
    EXPECT_LE(full.halved, full.loads);
    EXPECT_NEAR(std::pow(full.total, 2), std::pow(full.outside, 2) + std::pow(full.inside, 2), 1e-12);
    EXPECT_GT(full.outside, 1e-4);
    EXPECT_GT(full.inside, 1e-4);
    EXPECT_LT(full.total, 0.2);
    EXPECT_GE(full.worst, full.total);
    EXPECT_LE(full.worst, full.total * std::sqrt(static_cast<double>(full.loads)) * (1 + 1e-12));
    ReduceReport again;
    set_num_threads(1);
    (void)reduce(bar_solid("stvk", held), options, &again);
    set_num_threads(0);
    EXPECT_EQ(again.full_error.total, full.total);
  }
  ReduceReport report;
  (void)reduce(bar_solid(), quick(80), &report);
  EXPECT_EQ(report.full_error.loads, 0);
  EXPECT_TRUE(std::isnan(report.full_error.total));
}

// Nothing is outside of a subspace of everything, and all components in it are the full object.
TEST(Reduce, IsTheFullObjectWhereNothingIsReduced) {
  const auto full = std::make_shared<const StvkBar>(clamped_bar());
  DenseBasis everything{full->rest_state().expand(Matrix(full->mass().cwiseSqrt().cwiseInverse().asDiagonal())), {}};
  ReduceOptions options = quick(full->model().num_components());
  options.selector = "all";
  options.full_loads = 3;
  const auto reduced =
      reduce(full, std::make_shared<const DenseBasis>(std::move(everything)), AnySelector(options.selector), options);
  EXPECT_EQ(reduced.report.full_error.loads, 3);
  EXPECT_LT(reduced.report.full_error.total, 1e-4);
  EXPECT_EQ(reduced.report.equilibrium_loads, 24);
  EXPECT_LT(reduced.report.equilibrium_error, 1e-4);
  EXPECT_NEAR(reduced.report.rest_stiffness.smallest, 1, 1e-4);
  EXPECT_NEAR(reduced.report.rest_stiffness.largest, 1, 1e-4);
}

// Thirty further loads, by Newton's method on all components, say the same to within a factor of 1.5.
TEST(Reduce, MeasuresEquilibriaUnderFreshLoads) {
  const auto full = std::make_shared<const StvkBar>(clamped_bar());
  const auto basis = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 4}(*full));
  ReduceOptions options = quick(24);
  options.equilibria = 16;
  const auto reduced = reduce(full, basis, NnSp{}, options);
  const ReduceReport& report = reduced.report;
  EXPECT_EQ(report.equilibrium_loads, 24);
  EXPECT_GT(report.equilibrium_training_error, 0);

  const auto fitted = reduced.system();
  const GalerkinSystem exact(full, basis);
  const ReducedModes modes = reduced_modes(reduced.rest_stiffness);
  const double diagonal = bounding_box(full->model().rest_positions()).diagonal();
  const Matrix linear = sample_poses(full->shared_model(), *basis, modes, full->nodal_mass().sum(), diagonal,
                                     {.count = 30, .amplitudes = {0.15, 0.05, 0.015}, .seed = 12345})
                            .Q;
  double sum = 0;
  for (Index t = 0; t < 30; ++t) {
    const Vector load = reduced.rest_stiffness * linear.col(t);
    Vector q = Vector::Zero(basis->dim());
    ASSERT_EQ(StaticSolver(fitted).solve({load, {}}, q).status, Status::Converged);
    Vector q_exact = q;
    ASSERT_EQ(StaticSolver(exact).solve({load, {}}, q_exact).status, Status::Converged);
    sum += (q_exact - q).squaredNorm() / q_exact.squaredNorm();
  }
  const double expected = std::sqrt(sum / 30);
  EXPECT_GT(expected, 0.01);
  EXPECT_LT(report.equilibrium_error, 1.5 * expected);
  EXPECT_GT(report.equilibrium_error, expected / 1.5);
}

TEST(Reduce, MeasuresRelaxedEquilibriaAgainstTheFullObject) {
  ReduceOptions options = ReduceOptions::relaxed_derivatives(8);
  ReduceReport report;
  (void)reduce(bar_solid(), options, &report);
  EXPECT_EQ(report.equilibrium_loads + report.equilibrium_unfinished, 8);
  EXPECT_EQ(report.equilibrium_error, report.full_error.inside);
  options.full_loads = 0;
  (void)reduce(bar_solid(), options, &report);
  EXPECT_TRUE(std::isnan(report.equilibrium_error));
}

TEST(Reduce, SaysAboutHowManyPointsTheStiffnessAtRestTakes) {
  ReduceReport few, about, more;
  (void)reduce(bar_solid(), quick(30), &few);
  const Index points = few.points_for_sound_stiffness;
  ASSERT_FALSE(few.rest_stiffness.is_sound());
  ASSERT_GT(points, 30);
  ASSERT_LT(3 * points / 2, few.components);
  (void)reduce(bar_solid(), quick(points), &about);
  EXPECT_LT(about.rest_stiffness.deviation(), 0.4);
  (void)reduce(bar_solid(), quick(3 * points / 2), &more);
  EXPECT_TRUE(more.rest_stiffness.is_sound());
  EXPECT_EQ(more.points_for_sound_stiffness, 0);
}

// Linear modes alone hold an object tightest: a bar that bends must stretch in them.
TEST(Reduce, ForcesThatRelaxBringItNearerToTheFullObject) {
  for (const std::string law : {"stvk", "neo-hookean"}) {
    SCOPED_TRACE(law);
    ReduceOptions options = ReduceOptions::relaxed_derivatives(12);
    options.subspace = "modal";
    options.points = 60;
    ReduceReport relaxed, locked;
    (void)reduce(bar_solid(law), options, &relaxed);
    options.relaxed = false;
    (void)reduce(bar_solid(law), options, &locked);
    EXPECT_LT(relaxed.full_error.total, 0.6 * locked.full_error.total);
    EXPECT_NEAR(relaxed.full_error.outside, locked.full_error.outside, 0.2 * locked.full_error.outside);
  }
}

TEST(Reduce, KnowsItsErrorUnderLoads) {
  ReduceOptions options = ReduceOptions::relaxed_derivatives(8);
  options.points = 40;
  ReduceReport report;
  const ReducedModel model = reduce(bar_solid(), options, &report);
  ASSERT_TRUE(model.indicator);
  const ErrorIndicator& indicator = *model.indicator;
  for (const Index i : indicator.indices)
    EXPECT_FALSE(std::binary_search(model.indices.begin(), model.indices.end(), i))
        << "component " << i << " is in both";
  EXPECT_TRUE((indicator.weights.array() > 0).all());
  const std::optional<ErrorEstimator> estimate = error_estimator(model);
  ASSERT_TRUE(estimate);
  const AnySystem<Matrix> system = model.system();
  const auto error_along = [&](double size) {
    const Vector q = size * indicator.trained_size * reduced_modes(model).Phi.col(0);
    return (*estimate)(q, system.force(q));
  };
  EXPECT_LT(error_along(0.1).outside, 0.05 * error_along(1).outside) << "what a subspace lacks grows with the square";
  EXPECT_FALSE(error_along(0.99).beyond_training);
  EXPECT_TRUE(error_along(1.01).beyond_training);

  options.full_loads = 0;  // nothing to calibrate it by
  EXPECT_FALSE(reduce(bar_solid(), options).indicator);
  EXPECT_FALSE(error_estimator(reduce(bar_solid(), quick())));
}

// A motion that is late is wrong: weights are fitted to the frequencies, too.
TEST(Reduce, RelaxedForcesKeepTheFrequenciesAtRest) {
  ReduceOptions options = ReduceOptions::relaxed_derivatives(8);
  options.points = 60;
  const ReducedModel model = reduce(bar_solid(), options);
  const auto count = model.omega().size();
  const ReducedModes exact = reduced_modes(model),
                     fitted = reduced_modes(model.system().stiffness(Vector::Zero(model.dim())), Index{0});
  for (Index k = 0; k < count; ++k) EXPECT_NEAR(fitted.omega[k] / exact.omega[k], 1, 0.01) << "mode " << k;
}

TEST(Reduce, TakesAsFewComponentsAsATargetErrorNeeds) {
  ReduceOptions options = quick(100);
  options.held_out_poses = 0;
  options.target_error = 0.1;
  ReduceReport few, all;
  (void)reduce(bar_solid(), options, &few);
  EXPECT_LE(few.training_error, 0.1);
  EXPECT_LT(few.points, 100);
  options.points = few.points * 9 / 10 - 1;
  options.target_error = 0;
  (void)reduce(bar_solid(), options, &all);
  EXPECT_GT(all.training_error, 0.1);
}

}  // namespace
}  // namespace supple::test

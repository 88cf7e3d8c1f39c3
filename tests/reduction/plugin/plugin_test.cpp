#include <physics/body/solid.hpp>
#include <reduction/plugin/plugin.hpp>
#include <testing/force_model_conformance.hpp>
#include <tests/support/meshes.hpp>

#include <gmock/gmock.h>

#include <fstream>

namespace supple::test {

/// An element that comes from a plug-in.
struct PluginElement {
  static constexpr double length = 0.1;
  static AnyModel<4> make() {
    load_plugin(SUPPLE_PLUGINS "/libspring_tets_plugin.so");
    return *material_law("spring-tets").tets(kuhn_box(2, 1, 1, length), RowMatrix::Constant(1, 1, 1e5), {});
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(OfAPlugin, ForceModelConformance, PluginElement);

namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

const std::filesystem::path folder = SUPPLE_PLUGINS;

TEST(Plugin, AddsItsLawOnce) {
  const auto plugin = folder / "libgent_plugin.so";
  EXPECT_THAT(material_laws(), Not(Contains("gent")));
  load_plugin(plugin);
  load_plugin(plugin);
  EXPECT_THAT(material_laws(), Contains("gent"));
  const MaterialLaw& gent = material_law("gent");
  EXPECT_EQ(gent.parameters, (std::vector<std::string>{"mu", "limit", "bulk"}));
  EXPECT_FALSE(gent.finite_when_inverted);

  // its formulas: far from the limit it is nearly the isochoric neo-Hookean solid, Mooney–Rivlin without c01
  const TetMesh mesh = kuhn_box(1, 1, 1, 0.1);
  const IsotropicModuli moduli{.young = 1e5, .poisson = 0.4};
  const auto model = [&](const char* law, const MaterialLaw::Named& parameters) {
    const std::vector<double> values = material_law(law).values(moduli, parameters);
    return material_law(law).tets(mesh,
                                  Eigen::Map<const RowMatrix>(values.data(), 1, static_cast<Index>(values.size())), {});
  };
  const auto soft = model("gent", {{"limit", 1e7}});
  const auto mooney = model("mooney-rivlin", {{"c10", moduli.shear() / 2}, {"c01", 0}});
  Local<12> u;
  for (int k = 0; k < 12; ++k) u[k] = 0.002 * ((5 * k) % 7 - 3);
  EXPECT_NEAR(soft->energy(0, u) / mooney->energy(0, u), 1, 1e-6);
  EXPECT_LT((soft->force(0, u) - mooney->force(0, u)).norm(), 1e-6 * mooney->force(0, u).norm());
  EXPECT_LT((soft->stiffness(0, u) - mooney->stiffness(0, u)).norm(), 1e-6 * mooney->stiffness(0, u).norm());
}

TEST(Plugin, IsRefusedWithItsNameAndTheReason) {
  const auto refused = [](const std::filesystem::path& file, const auto& reason) {
    EXPECT_THAT([&] { load_plugin(file); }, ThrowsMessage<InputError>(AllOf(HasSubstr(file.string()), reason)));
  };
  refused(folder / "nowhere.so", HasSubstr("no such file"));
  refused(folder / "libno_plugin.so", HasSubstr("not a plug-in of Supple"));
  refused(folder / "libother_version.so",
          AllOf(HasSubstr("Supple 0.0.9"), HasSubstr("expected Supple " SUPPLE_VERSION)));
  const auto text = std::filesystem::temp_directory_path() / "supple_no_library.so";
  std::ofstream(text) << "not a library";
  refused(text, HasSubstr("not a shared library"));
  std::filesystem::remove(text);
  const auto part = std::filesystem::temp_directory_path() / "supple_cut_short.so";
  std::filesystem::copy_file(folder / "libgent_plugin.so", part, std::filesystem::copy_options::overwrite_existing);
  for (const std::uintmax_t size : {std::filesystem::file_size(part) / 2, std::uintmax_t{100}, std::uintmax_t{20}}) {
    std::filesystem::resize_file(part, size);
    refused(part, HasSubstr("cut short"));
  }
  std::filesystem::remove(part);
}

TEST(Plugin, ThatFailsHalfWayLeavesNothing) {
  const std::vector<std::string> before = material_laws();
  EXPECT_THAT([] { load_plugin(folder / "libtwice.so"); },
              ThrowsMessage<InputError>(HasSubstr("there is a material law 'stvk' already")));
  EXPECT_EQ(material_laws(), before);
}

TEST(MaterialLaws, NameWhatTheyDoNotKnow) {
  EXPECT_THAT([] { material_law("rubber"); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("'rubber'"), HasSubstr("stvk, mooney-rivlin"))));
  EXPECT_THAT(
      [] {
        material_law("ogden").values({}, {{"mu4", 1}});
      },
      ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("'mu4'"), HasSubstr("mu1, alpha1"))));
  EXPECT_EQ(material_law("stvk").values({.young = 2, .poisson = 0}, {{"lambda", 7}}), (std::vector<double>{7, 1}));
}

TEST(MaterialLaws, RefuseParametersOfWhichRestIsNoStableEquilibrium) {
  const auto refused = [](const char* law, const MaterialLaw::Named& parameters, const char* reason) {
    EXPECT_THAT([&] { material_law(law).values({}, parameters); },
                ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr(law), HasSubstr(reason))));
  };
  refused("stvk", {{"mu", -5}}, "not stable");
  refused("stvk", {{"mu", 0}, {"lambda", 0}}, "resists nothing");
  refused("ogden", {{"alpha1", 0}}, "energy at rest is not finite");
  refused("neo-hookean", {{"lambda", -1e9}}, "not stable");
  refused("corotational", {{"mu", std::numeric_limits<double>::quiet_NaN()}}, "not finite");
  for (const std::string& law : material_laws())
    EXPECT_NO_THROW((void)material_law(law).values({.young = 7, .poisson = 0.2}));
}

TEST(MaterialLaws, GiveTheModelsOfTheirTemplates) {
  TetMesh mesh = kuhn_box(2, 1, 1, 0.1);
  Solid solid = isotropic_solid(mesh, {.young = 1e5, .poisson = 0.4}, {}, "neo-hookean");
  EXPECT_EQ(solid.parameters.cols(), 2);
  solid.parameters.conservativeResize(2, Eigen::NoChange);
  solid.parameters.row(1) = 3 * solid.parameters.row(0);
  for (Index e = 0; e < mesh.num_cells(); ++e) solid.material_of_cell.push_back(static_cast<std::int32_t>(e % 2));
  const auto model = material_law("neo-hookean").tets(mesh, solid.parameters, solid.material_of_cell);
  EXPECT_TRUE(model->has_jacobian());
  EXPECT_EQ(model->rest_positions(), mesh.nodes);
  Local<12> u;
  for (int k = 0; k < 12; ++k) u[k] = 0.002 * ((5 * k) % 7 - 3);
  EXPECT_THROW(material_law("stvk").tets(mesh, RowMatrix::Ones(1, 3), {}), std::invalid_argument);
  EXPECT_THROW(material_law("stvk").tets(mesh, RowMatrix::Ones(2, 2), {}), std::invalid_argument);
  solid.material_of_cell[0] = 2;
  EXPECT_THROW(material_law("stvk").tets(mesh, RowMatrix::Ones(2, 2), solid.material_of_cell), std::invalid_argument);
  EXPECT_GT(model->energy(1, u), model->energy(0, u));
}

}  // namespace
}  // namespace supple::test

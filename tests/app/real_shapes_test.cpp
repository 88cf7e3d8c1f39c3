// Real surfaces through reduce, simulate and edit as a user runs them.
#include <tests/app/supple_process.hpp>
#include <tests/support/shared_meshes.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <ostream>

namespace supple::test {

namespace {

using nlohmann::json;

struct Shape {
  std::string name, mesh;
  json root, hand, move;  // handles, and the motion of the second

  friend void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.mesh; }
};

/// A shape of Botsch & Sorkine 2008 with its own handles: nodes of label 0 stay, those of label 2 move rigidly.
Shape labelled(const std::string& name, const json& matrix) {
  const std::string labels = (meshes() / "botsch_sorkine" / (name + ".sel")).string();
  return {name,
          "botsch_sorkine/" + name + ".off",
          {{"file", labels}, {"label", 0}},
          {{"file", labels}, {"label", 2}},
          {{"matrix", matrix}}};
}

std::vector<Shape> shapes() {
  const double s = std::sqrt(0.5), c = std::sqrt(0.75);
  return {labelled("bar", {-s, -s, 0, 0, s, -s, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}),
          labelled("cactus", {0.999641, 0.021031, 0.016579, -0.019322, -0.022776, 0.342021, 0.939416, -0.134331,
                              0.014087, -0.939457, 0.342378, 0.821073, 0, 0, 0, 1}),
          labelled("cylinder", {-0.5, 0, -c, 5.196152, 0, 1, 0, 0, c, 0, -0.5, 9, 0, 0, 0, 1}),
          labelled("plane", {1, 0, 0, -32.299956, 0, 1, 0, 0, 0, 0, 1, 56.703263, 0, 0, 0, 1}),
          {"bunny",
           "shell/bunny_35k.ply",
           {{"nodes", "y<10%"}},
           {{"nodes", "y>90%"}},
           {{"axis", {0, 0, 1}}, {"angle", "20 deg"}}},
          {"dinosaur",
           "shell/dinosaur_56k.ply",
           {{"nodes", "y<10%"}},
           {{"nodes", "y>90%"}},
           {{"axis", {0, 0, 1}}, {"angle", "15 deg"}}},
          {"chinese_dragon",
           "shell/chinese_dragon_130k.ply",
           {{"nodes", "x<10%"}},
           {{"nodes", "x>90%"}},
           {{"axis", {0, 0, 1}}, {"angle", "15 deg"}}},
          {"beetle",
           "shell/vw_beetle_20k.off",
           {{"nodes", "x<10%"}},
           {{"nodes", "x>90%"}},
           {{"axis", {0, 0, 1}}, {"angle", "5 deg"}}}};
}

class RealShapeTest : public SuppleProcess, public testing::WithParamInterface<Shape> {};

TEST_P(RealShapeTest, IsReducedSimulatedAndEdited) {
  SKIP_WITHOUT_MESHES();
  const auto [name, mesh, root, hand, move] = GetParam();
  const auto file = meshes() / mesh;
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const Outcome made = supple({"reduce", file.string(), "-o", "shape.supple", "--poses", "100", "--points", "200",
                               "--recipe", "subspace", "--full-loads", "0", "--held-out", "20", "--json", "-"});
  ASSERT_EQ(made.exit_code, 0) << made.err;  // which may warn of the mesh
  const json reduced = made.json();
  EXPECT_LT(reduced["training_error"], 0.2);
  EXPECT_LT(reduced["held_out_error"], 0.2);

  const json motion = report({"simulate", "shape.supple"});  // bent along its softest mode and released
  EXPECT_EQ(motion["missed_steps"], 0);

  json scene{{"handles", {{{"name", "root"}}, {{"name", "hand"}}}},
             {"edits", {{{"increments", 10}, {"moves", {move}}}}}};
  scene["handles"][0].update(root);
  scene["handles"][1].update(hand);
  scene["edits"][0]["moves"][0]["handle"] = "hand";
  write("scene.json", scene.dump());
  for (const char* solver : {"newton", "bfgs"}) {
    const Outcome edit = supple({"edit", "shape.supple", "--scene", "scene.json", "--solver", solver, "--json", "-"});
    ASSERT_EQ(edit.exit_code, 0) << edit.err;  // which may warn of the subspace
    const json edited = edit.json();
    EXPECT_EQ(edited["missed_solves"], 0) << solver;
    EXPECT_GT(edited["elastic_energy"], 0) << solver;
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, RealShapeTest, testing::ValuesIn(shapes()),
                         [](const auto& test) { return test.param.name; });

}  // namespace

}  // namespace supple::test

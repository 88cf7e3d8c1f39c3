#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <csignal>

namespace supple::test {

namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

class ViewCommandTest : public SuppleProcess {
 protected:
  ViewCommandTest() {
    std::filesystem::create_directory(folder / "page");
    write("page/index.html", "<html>");
  }
  const Arguments small_mesh{"view",         "bar:3x1x1", "--fix",        "x<5%",     "--modes",    "6",
                             "--poses",      "15",        "--equilibria", "0",        "--held-out", "0",
                             "--full-loads", "0",         "--recipe",     "subspace", "--page",     "page"};
};

TEST_F(ViewCommandTest, PrintsItsAddressAndServesUntilASignal) {
  const auto begin = std::chrono::steady_clock::now();
  const Outcome outcome = run_supple_until_signal_once_it_prints(small_mesh, folder, SIGTERM);
  EXPECT_EQ(outcome.exit_code, 128 + SIGTERM);
  EXPECT_THAT(outcome.out, StartsWith("http://127.0.0.1:"));
  EXPECT_EQ(outcome.err, "");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 60s);  // it does end
}

TEST_F(ViewCommandTest, EndsWhileItStillReduces) {
  Arguments large = small_mesh;
  large[1] = "bar:40x10x10";
  // METIS, which orders its matrix somewhere here, takes signals for itself
  for (std::chrono::milliseconds after = 200ms; after <= 440ms; after += 20ms)
    EXPECT_EQ(run_supple_until_signal(large, folder, SIGTERM, after).exit_code, 128 + SIGTERM) << after.count();
}

TEST_F(ViewCommandTest, PrintsTheTokenWhereItListensToOthers) {
  Arguments open = small_mesh;
  open.insert(open.end(), {"--listen", "0.0.0.0"});
  EXPECT_THAT(run_supple_until_signal_once_it_prints(open, folder, SIGTERM).out, HasSubstr("/?token="));
}

TEST_F(ViewCommandTest, RefusesWhatItCannotServe) {
  expect_refusal({"view"}, {"MESH"});
  expect_refusal({"view", "nothing.msh", "--page", "page"}, {"nothing.msh"});
  expect_refusal({"view", "bar:2x1x1", "--page", "nowhere"}, {"nowhere"});
  expect_refusal({"view", "bar:2x1x1", "--page", "page", "--listen", "everywhere"}, {"everywhere", "IP address"});
  expect_refusal({"view", "bar:2x1x1", "--page", "page", "--listen", "192.0.2.1"},
                 {"192.0.2.1", "cannot be listened on"});
  expect_refusal({"view", "bar:2x1x1", "--port", "70000"}, {"--port"});
}

TEST_F(ViewCommandTest, TakesOptionsOfMeshesForMeshesAlone) {
  ASSERT_EQ(supple({"reduce", "bar:3x1x1", "--fix", "x<5%", "--modes", "6", "--poses", "15", "--equilibria", "0",
                    "--held-out", "0", "--full-loads", "0", "--recipe", "subspace", "-o", "bar.supple"})
                .exit_code,
            0);
  expect_refusal({"view", "bar.supple", "--page", "page", "--young", "1e6"}, {"--young", "for meshes"});
  const Outcome outcome =
      run_supple_until_signal_once_it_prints({"view", "bar.supple", "--page", "page"}, folder, SIGTERM);
  EXPECT_EQ(outcome.exit_code, 128 + SIGTERM);
  EXPECT_EQ(outcome.err, "");
}

}  // namespace

}  // namespace supple::test

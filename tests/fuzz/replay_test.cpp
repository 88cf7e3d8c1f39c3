/// \file Every reader on the files of the corpus, on its seeds, and on some hundred damaged ones: a sound value or an InputError
/// that names the file, and no more memory than the file can justify. scripts/fuzz does this for hours, guided by coverage.

#include <core/output_file.hpp>
#include <core/random.hpp>
#include <tests/fuzz/fuzz_target.hpp>
#include <tests/io/damage.hpp>
#include <tests/support/long_run.hpp>
#include <tests/support/test_folder.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace supple::fuzz {

namespace {

namespace fs = std::filesystem;

std::vector<Target> all_targets() {
  std::vector<Target> targets = reader_targets();
  std::ranges::move(model_targets(), std::back_inserter(targets));
  return targets;
}

class Reader : public testing::TestWithParam<Target> {
 protected:
  Answer read(const std::string& bytes, const std::string& what) const {
    test::forget_requests();
    try {
      const Answer answer = GetParam().read(bytes, folder_);
      EXPECT_LT(test::largest_request(), GetParam().memory_per_byte * bytes.size() + GetParam().memory) << what;
      return answer;
    } catch (const std::exception& error) {
      ADD_FAILURE() << what << ": " << error.what() << "\n" << testing::PrintToString(bytes);
      return Answer::Refused;
    }
  }

 private:
  const fs::path folder_ = test::test_folder();
};

TEST_P(Reader, TakesWhatIsSound) {
  const std::vector<std::string> seeds = GetParam().seeds();
  ASSERT_FALSE(seeds.empty());
  if (!GetParam().seeds_are_sound) GTEST_SKIP() << "seeds are scripts of damage";
  for (std::size_t k = 0; k < seeds.size(); ++k)
    EXPECT_EQ(read(seeds[k], "seed " + std::to_string(k)), Answer::Sound) << seeds[k];
}

TEST_P(Reader, RefusesWhatWasFoundToBreakIt) {
  const fs::path corpus = fs::path(SUPPLE_FUZZ_CORPUS) / GetParam().name;
  if (!fs::exists(corpus)) GTEST_SKIP() << "nothing was";
  for (const auto& entry : fs::directory_iterator(corpus)) read(read_file(entry.path()), entry.path().string());
}

TEST_P(Reader, GivesASoundValueOrAnInputErrorForDamagedFiles) {
  const std::vector<std::string> seeds = GetParam().seeds();
  const int num_files = test::repetitions(400, 40000);
  Random random(7);
  int num_refused = 0;
  for (int k = 0; k < num_files && !HasFailure(); ++k) {
    const std::string& seed = seeds[static_cast<std::size_t>(k) % seeds.size()];
    num_refused += read(test::damaged(seed, random), "file " + std::to_string(k)) == Answer::Refused;
  }
  EXPECT_GT(num_refused, num_files / 20);  // the damage does damage
  EXPECT_LT(num_refused, num_files);       // and not only at the door
}

INSTANTIATE_TEST_SUITE_P(All, Reader, testing::ValuesIn(all_targets()),
                         [](const auto& test) { return test.param.name; });

}  // namespace

void PrintTo(const Target& target, std::ostream* out) {
  *out << target.name;
}

}  // namespace supple::fuzz

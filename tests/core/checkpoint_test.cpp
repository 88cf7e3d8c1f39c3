#include <core/check.hpp>
#include <core/checkpoint.hpp>
#include <core/output_file.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <unistd.h>

namespace supple {

struct Answer {
  Matrix values;
};
static void store(TensorFileWriter& file, const Answer& answer) {
  file.add("values", answer.values);
}
static void restore(const TensorFile& file, Answer& answer) {
  answer.values = file.matrix("values");
}

namespace {

class CheckpointTest : public testing::Test {
 protected:
  CheckpointTest()
      : folder(std::filesystem::temp_directory_path() / ("supple-checkpoint-" + std::to_string(::getpid()))) {}
  ~CheckpointTest() override { std::filesystem::remove_all(folder); }

  Answer keep(const Checkpoint& checkpoint, const std::string& stage, const Vector& input) {
    return checkpoint.keep(
        stage, [&](Digest& digest) { digest.add(input); },
        [&] {
          ++calls;
          return Answer{input * input.transpose() / 3};
        });
  }

  std::filesystem::path folder;
  int calls = 0;
  const Vector a = (Vector(3) << 1, -0.0, 1e-300).finished();
};

TEST_F(CheckpointTest, GivesTheSameBitsAgainWithoutWork) {
  const Matrix made = keep(Checkpoint(folder), "stage", a).values;
  const Matrix kept = keep(Checkpoint(folder), "stage", a).values;
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(Digest().add(kept).text(), Digest().add(made).text());  // −0 is another than 0
}

TEST_F(CheckpointTest, KnowsInputsAndStagesApart) {
  const Checkpoint checkpoint(folder);
  Vector b = a;
  b[1] = 0;  // equal in value to −0, not in its bits
  for (int round = 0; round < 2; ++round) {
    keep(checkpoint, "stage", a);
    keep(checkpoint, "stage", b);
    keep(checkpoint, "stage", a.head(2));
    keep(checkpoint, "other", a);
  }
  EXPECT_EQ(calls, 4);
}

TEST_F(CheckpointTest, KeepsNothingWithoutAFolder) {
  keep({}, "stage", a);
  keep({}, "stage", a);
  EXPECT_EQ(calls, 2);
}

TEST_F(CheckpointTest, KeepsNothingOfWorkThatFails) {
  const auto fail = [&]() -> Answer { throw SolverError("not found"); };
  EXPECT_THROW(Checkpoint(folder).keep(
                   "stage", [](Digest&) {}, fail),
               SolverError);
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST_F(CheckpointTest, RefusesADamagedFileByName) {
  keep(Checkpoint(folder), "stage", a);
  const std::filesystem::path path = std::filesystem::directory_iterator(folder)->path();
  std::string bytes = read_file(path);
  bytes[bytes.size() - 70] ^= 1;
  write_file(path, bytes);
  try {
    keep(Checkpoint(folder), "stage", a);
    FAIL() << "a damaged file was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
  }
}

TEST_F(CheckpointTest, RefusesAFolderThatCannotBe) {
  std::filesystem::create_directories(folder);
  write_file(folder / "file", "");
  EXPECT_THROW(Checkpoint(folder / "file" / "below").make_folder(), InputError);
}

TEST(Digest, DependsOnEveryPartAndItsPlace) {
  const Vector v = Vector::LinSpaced(4, 0, 1);
  const Matrix wide = v.transpose(), tall = v;
  EXPECT_NE(Digest().add(wide).text(), Digest().add(tall).text());
  EXPECT_NE(Digest().add("ab").add("c").text(), Digest().add("a").add("bc").text());
  EXPECT_NE(Digest().add(1).add(2).text(), Digest().add(2).add(1).text());
  EXPECT_EQ(Digest().add("abc").add(v).text(), Digest().add("abc").add(v).text());
  Matrix dense = Matrix::Identity(4, 4);
  const SparseMatrix one = dense.sparseView();
  dense(1, 1) = 1 + std::numeric_limits<double>::epsilon();
  EXPECT_NE(Digest().add(one).text(), Digest().add(SparseMatrix(dense.sparseView())).text());
}

TEST_F(CheckpointTest, AbandonedFilesLeaveNothing) {
  std::filesystem::create_directories(folder);
  EXPECT_EXIT(
      {
        OutputFile file(folder / "half");
        file.write("half of it");
        abandon_output_files();
        _exit(0);
      },
      testing::ExitedWithCode(0), "");
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace
}  // namespace supple

#include <core/check.hpp>
#include <core/random.hpp>
#include <core/tensor_file.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <unistd.h>

namespace supple {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_all(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

struct TensorFileTest : testing::Test {
  TensorFileTest() { fs::create_directories(folder); }
  ~TensorFileTest() override { fs::remove_all(folder); }

  TensorFileWriter sample() const {
    TensorFileWriter writer;
    writer.add("basis", basis);
    writer.add("omega", omega);
    writer.add("tets", tets);
    writer.add("fixed", std::vector<std::int32_t>{3, 1, 4});
    writer.add("flags", std::vector<std::uint8_t>{1, 0, 255, 7, 7});
    writer.add("none", std::vector<double>{});
    const std::vector<float> colours{0.5f, 1, 2, 3, 4, 5, 6, 7};
    writer.add("colours", std::span<const float>(colours), {2, 2, 2});
    writer.metadata["format"] = "supple";
    writer.metadata["naïve κ"] = "größer\n\"quoted\"";
    return writer;
  }

  /// The message of opening `bytes` as a file, or "" if it opens.
  std::string refusal(const std::string& bytes, Checksums checksums = Checksums::Verify) const {
    fs::remove(folder / "changed");  // truncating a file instead makes some file systems wait for the disk
    write_all(folder / "changed", bytes);
    try {
      TensorFile(folder / "changed", checksums);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  const fs::path folder = fs::temp_directory_path() / ("supple-tensor-file-" + std::to_string(::getpid()));
  const fs::path path = folder / "model.supple";
  const RowMatrix basis = RowMatrix::NullaryExpr(5, 3, [](Index i, Index j) { return i + 0.1 * j; });
  const Vector omega = Vector::LinSpaced(7, 1, 2);
  const std::vector<std::array<Index, 4>> tets{{0, 1, 2, 3}, {1, 2, 3, 4}};
};

TEST_F(TensorFileTest, ReturnsWhatWasWritten) {
  sample().write(path);
  const TensorFile file(path);
  EXPECT_EQ(RowMatrix(file.matrix("basis")), basis);
  EXPECT_EQ(RowMatrix(file.matrix("basis", 5, TensorFile::any)), basis);
  EXPECT_EQ(Vector(file.vector("omega", 7)), omega);
  EXPECT_THAT(file.integers("tets"), ElementsAre(0, 1, 2, 3, 1, 2, 3, 4));
  EXPECT_THAT(file.shape("tets"), ElementsAre(2, 4));
  EXPECT_THAT(file.values<std::int32_t>("fixed", {3}), ElementsAre(3, 1, 4));
  EXPECT_THAT(file.values<std::uint8_t>("flags"), ElementsAre(1, 0, 255, 7, 7));
  EXPECT_THAT(file.values<float>("colours", {2, TensorFile::any, 2}), ElementsAre(0.5f, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_EQ(file.vector("none").size(), 0);
  EXPECT_EQ(file.tensors().size(), 7u);
  EXPECT_EQ(file.metadata("format"), "supple");
  EXPECT_EQ(file.metadata("naïve κ"), "größer\n\"quoted\"");
  EXPECT_EQ(file.metadata().size(), 2u);
}

TEST_F(TensorFileTest, KeepsEveryBitOfSpecialNumbers) {
  using Limits = std::numeric_limits<double>;
  const std::vector<double> special{Limits::quiet_NaN(), Limits::infinity(), -0.0, Limits::denorm_min(), Limits::max()};
  TensorFileWriter writer;
  writer.add("special", special);
  writer.write(path);
  const TensorFile file(path);
  EXPECT_EQ(std::memcmp(file.values<double>("special").data(), special.data(), 5 * sizeof(double)), 0);
}

TEST_F(TensorFileTest, MatricesOfAnyStorageOrderAreWrittenByRows) {
  const Matrix by_columns = basis;
  const Points points = basis;
  TensorFileWriter writer;
  writer.add("columns", by_columns);
  writer.add("points", points);
  writer.add("expression", 2 * basis.topRows(2));
  writer.add("column", basis.col(1));
  writer.write(path);
  const TensorFile file(path);
  EXPECT_EQ(RowMatrix(file.matrix("columns", 5, 3)), basis);
  EXPECT_EQ(RowMatrix(file.matrix("points", 5, 3)), basis);
  EXPECT_EQ(RowMatrix(file.matrix("expression")), RowMatrix(2 * basis.topRows(2)));
  EXPECT_EQ(Vector(file.vector("column")), Vector(basis.col(1)));
}

TEST_F(TensorFileTest, ArraysAreAlignedTo64BytesInMemory) {
  sample().write(path);
  const TensorFile file(path);
  for (const auto& [name, tensor] : file.tensors())
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(tensor.bytes.data()) % 64, 0u) << name;
}

TEST_F(TensorFileTest, StaysReadableAfterBeingMovedAndReplaced) {
  sample().write(path);
  TensorFile first(path);
  const TensorFile file = std::move(first);
  TensorFileWriter other;
  other.add("basis", RowMatrix::Zero(1, 1));
  other.write(path);
  EXPECT_EQ(RowMatrix(file.matrix("basis")), basis);
  EXPECT_EQ(TensorFile(path).matrix("basis").size(), 1);
}

TEST_F(TensorFileTest, WritingTwiceGivesTheSameBytes) {
  sample().write(path);
  sample().write(folder / "again");
  EXPECT_EQ(read_all(path), read_all(folder / "again"));
}

TEST_F(TensorFileTest, IsReadByAnIndependentReaderOfThePublishedLayout) {
  if (std::system("python3 -c 'import json, struct' 2>/dev/null") != 0) GTEST_SKIP() << "python3 is not installed";
  sample().write(path);
  const std::string command = "python3 '" SUPPLE_TEST_SCRIPTS "/read_safetensors.py' '" + path.string() + "' 2>&1";
  FILE* pipe = ::popen(command.c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::string output;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0) << output;
  EXPECT_THAT(output,
              AllOf(HasSubstr("basis F64 5x3 0 31.5"), HasSubstr("omega F64 7 0 10.5"),
                    HasSubstr("tets I64 2x4 0 16.0"), HasSubstr("fixed I32 3 0 8.0"), HasSubstr("flags U8 5 0 270.0"),
                    HasSubstr("none F64 0 0 0.0"), HasSubstr("colours F32 2x2x2 0 28.5")));
}

TEST_F(TensorFileTest, AccessNamesFileArrayAndExpectation) {
  sample().write(path);
  const TensorFile file(path);
  EXPECT_THAT([&] { file.matrix("bases"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr(path.string()), HasSubstr("expected an array 'bases'"))));
  EXPECT_THAT([&] { file.integers("basis"); },
              ThrowsMessage<InputError>(HasSubstr("array 'basis' has type F64, expected I64")));
  EXPECT_THAT([&] { file.matrix("basis", TensorFile::any, 4); },
              ThrowsMessage<InputError>(HasSubstr("array 'basis' has shape [5, 3], expected [any, 4]")));
  EXPECT_THAT([&] { file.vector("basis"); },
              ThrowsMessage<InputError>(HasSubstr("array 'basis' has shape [5, 3], expected [any]")));
  EXPECT_THAT([&] { file.metadata("author"); }, ThrowsMessage<InputError>(HasSubstr("expected metadata 'author'")));
}

TEST_F(TensorFileTest, WriterRefusesWhatItCouldNotReadBack) {
  TensorFileWriter writer = sample();
  const std::vector<double> six(6);
  EXPECT_THAT(
      [&] {
        writer.add("w", std::span<const double>(six), {2, 2});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("array 'w' has shape [2, 2] and 6 values")));
  EXPECT_THROW(writer.add("w", std::span<const double>(six), {-2, -3}), std::invalid_argument);
  constexpr Index huge = std::numeric_limits<Index>::max();
  EXPECT_THROW(writer.add("w", std::span<const double>(six), {huge, huge, 6}), std::invalid_argument);
  EXPECT_THAT([&] { writer.add("omega", six); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("'omega' was added before")));
  for (const char* reserved : {"", "__metadata__", ".pad7"})
    EXPECT_THROW(writer.add(reserved, six), std::invalid_argument) << reserved;
  writer.metadata["supple.layout"] = "2";
  EXPECT_THROW(writer.write(path), std::invalid_argument);
  writer.metadata = {{"author", "\xff"}};
  EXPECT_THROW(writer.write(path), std::invalid_argument);
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(TensorFileTest, FailedWriteLeavesTheOldFileAndNothingElse) {
  sample().write(path);
  const std::string before = read_all(path);
  TensorFileWriter broken = sample();
  broken.metadata["bad"] = "\xc3\x28";
  EXPECT_THROW(broken.write(path), std::invalid_argument);
  EXPECT_EQ(read_all(path), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  EXPECT_THAT([&] { sample().write(folder / "missing" / "file"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("missing/file"), HasSubstr("No such file"))));
}

TEST_F(TensorFileTest, RefusesFilesThatAreNotThereOrNotFiles) {
  EXPECT_THAT([&] { TensorFile(folder / "nothing"); }, ThrowsMessage<InputError>(HasSubstr("No such file")));
  EXPECT_THAT([&] { TensorFile{folder}; }, ThrowsMessage<InputError>(HasSubstr("not a regular file")));
  EXPECT_THAT(refusal(""), HasSubstr("not a safetensors file"));
}

TEST_F(TensorFileTest, RefusesEveryTruncation) {
  sample().write(path);
  const std::string bytes = read_all(path);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_NE(refusal(bytes.substr(0, size), Checksums::Skip), "") << size << " of " << bytes.size() << " bytes";
  EXPECT_NE(refusal(bytes + '\0', Checksums::Skip), "");
}

TEST_F(TensorFileTest, DetectsEveryFlippedBit) {
  sample().write(path);
  const std::string bytes = read_all(path);
  Random random(7);
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    std::string changed = bytes;
    changed[k] = static_cast<char>(changed[k] ^ (1 << random.below(8)));
    ASSERT_NE(refusal(changed), "") << "byte " << k;
  }
}

TEST_F(TensorFileTest, RefusesAnotherSpellingOfTheSameHeader) {
  TensorFileWriter writer = sample();
  writer.metadata["escaped"] = "\x1f";
  writer.write(path);
  const std::string bytes = read_all(path);
  const std::size_t padding = bytes.find("}  ") + 1, escape = bytes.find("\\u001f") + 5;
  ASSERT_LT(padding, bytes.size());
  ASSERT_LT(escape, bytes.size());
  for (const auto& [at, other] : {std::pair(padding, '\n'), std::pair(padding, '\t'), std::pair(escape, 'F')}) {
    std::string changed = bytes;
    changed[at] = other;
    EXPECT_THAT(refusal(changed), HasSubstr("header does not match its checksum")) << at;
  }
}

TEST_F(TensorFileTest, RefusesAHeaderOfAnyDepthWithoutClimbingDown) {
  sample().write(path);
  constexpr std::size_t depth = 1'000'000;
  std::string changed = read_all(path);
  changed.insert(9, "\"deep\":" + std::string(depth, '[') + std::string(depth, ']') + ",");
  std::uint64_t length;
  std::memcpy(&length, changed.data(), 8);
  length += 2 * depth + 8;
  std::memcpy(changed.data(), &length, 8);
  EXPECT_THAT(refusal(changed), HasSubstr("nested too deeply"));
}

/// The file with its header edited, and no checksum repaired.
std::string with_header(const std::string& bytes, const std::function<void(nlohmann::json&)>& edit) {
  std::uint64_t length;
  std::memcpy(&length, bytes.data(), 8);
  nlohmann::json header = nlohmann::json::parse(bytes.substr(8, length));
  edit(header);
  const std::string head = header.dump(), data = bytes.substr(8 + length);
  length = head.size();
  return std::string(reinterpret_cast<const char*>(&length), 8) + head + data;
}

TEST_F(TensorFileTest, RefusesForeignNewerAndEditedHeaders) {
  sample().write(path);
  const std::string bytes = read_all(path);
  EXPECT_THAT(refusal(with_header(bytes, [](auto& header) { header.erase("__metadata__"); })),
              HasSubstr("not written by Supple"));
  EXPECT_THAT(refusal(with_header(bytes,
                                  [](auto& header) {
                                    header["__metadata__"] = {{"format", "pt"}};
                                  })),
              HasSubstr("not written by Supple"));
  EXPECT_THAT(refusal(with_header(bytes, [](auto& header) { header["__metadata__"]["supple.layout"] = "2"; })),
              AllOf(HasSubstr("layout '2'"), HasSubstr("reads layout 1")));
  EXPECT_THAT(refusal(with_header(bytes, [](auto& header) { header["__metadata__"]["format"] = "other"; })),
              HasSubstr("header does not match its checksum"));
  EXPECT_THAT(refusal(with_header(bytes,
                                  [](auto& header) {
                                    header["basis"]["shape"] = {3, 5};
                                  })),
              HasSubstr("header does not match its checksum"));
  EXPECT_THAT(refusal(std::string("\x11\0\0\0\0\0\0\0{\"a\":{},\"a\":{}}  ", 25)), HasSubstr("'a' appears twice"));
  EXPECT_THAT(refusal(std::string("\xff\xff\xff\xff\xff\xff\xff\x7f{}", 10)), HasSubstr("not a safetensors file"));
}

TEST_F(TensorFileTest, SkippingChecksumsOpensADamagedArray) {
  sample().write(path);
  std::string bytes = read_all(path);
  const double value = basis(4, 2);
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&value), 8));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  EXPECT_THAT(refusal(bytes), HasSubstr("damaged: array 'basis' does not match its checksum"));
  EXPECT_EQ(refusal(bytes, Checksums::Skip), "");
}

TEST_F(TensorFileTest, SeededMutationsAreRefusedAndNeverCrash) {
  sample().write(path);
  const std::string bytes = read_all(path);
  Random random(2024);
  constexpr std::string_view pieces[] = {"[",    "]", "{", "}", "\"", ",", "-1", "1e999", "18446744073709551615",
                                         "null", "9"};
  int refused = 0;
  constexpr int rounds = 3000;
  for (int round = 0; round < rounds; ++round) {
    std::string changed = bytes;
    for (Index edits = 1 + random.below(4); edits > 0; --edits) {
      const auto at = static_cast<std::size_t>(random.below(static_cast<Index>(changed.size())));
      switch (random.below(4)) {
        case 0:
          changed[at] = static_cast<char>(random.below(256));
          break;
        case 1:
          changed.erase(at, static_cast<std::size_t>(1 + random.below(40)));
          break;
        case 2:
          changed.insert(at, pieces[random.below(std::size(pieces))]);
          break;
        default:
          changed.replace(
              at, 1, changed.substr(static_cast<std::size_t>(random.below(static_cast<Index>(changed.size()))), 9));
      }
    }
    if (changed != bytes) refused += refusal(changed, random.below(2) ? Checksums::Verify : Checksums::Skip) != "";
  }
  // Without checksums a changed array may pass; it must never pass unnoticed in the header, nor crash.
  EXPECT_GT(refused, rounds * 9 / 10);
}

}  // namespace
}  // namespace supple

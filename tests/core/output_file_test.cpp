#include <core/check.hpp>
#include <core/output_file.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace supple {
namespace {

namespace fs = std::filesystem;

struct OutputFileTest : testing::Test {
  OutputFileTest() { fs::create_directories(folder); }
  ~OutputFileTest() override { fs::remove_all(folder); }

  std::string content() const {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  auto num_entries() const { return std::distance(fs::directory_iterator(folder), {}); }

  const fs::path folder = fs::temp_directory_path() / ("supple-output-file-" + std::to_string(::getpid()));
  const fs::path path = folder / "result.txt";
};

TEST_F(OutputFileTest, AppearsOnlyWhenCommitted) {
  OutputFile file(path);
  file.write("one ");
  file.write("two");
  EXPECT_FALSE(fs::exists(path));
  file.commit();
  EXPECT_EQ(content(), "one two");
  EXPECT_EQ(num_entries(), 1);
}

TEST_F(OutputFileTest, AbandonedOutputLeavesTheOldFile) {
  write_file(path, "old");
  { OutputFile(path).write("new"); }
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(num_entries(), 1);
}

TEST_F(OutputFileTest, TwoWritersOfOneFileDoNotMix) {
  OutputFile first(path), second(path);
  first.write("first");
  second.write("second");
  first.commit();
  second.commit();
  EXPECT_EQ(content(), "second");
  EXPECT_EQ(num_entries(), 1);
}

TEST_F(OutputFileTest, WritesIntoAPipeAndLeavesItOne) {
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  fs::create_symlink(path, folder / "link");
  for (const fs::path& target : {path, folder / "link"}) {
    std::string read;
    std::thread reader([&] { read = content(); });
    write_file(target, "through");
    reader.join();
    EXPECT_EQ(read, "through");
    EXPECT_TRUE(fs::is_fifo(path));
    EXPECT_EQ(num_entries(), 2);
  }
  EXPECT_TRUE(is_stream(path));
  EXPECT_TRUE(is_stream("/dev/null"));
  EXPECT_FALSE(is_stream(folder));
  EXPECT_FALSE(is_stream(folder / "none"));
}

TEST_F(OutputFileTest, FollowsSymbolicLinks) {
  write_file(path, "old");
  fs::create_symlink(path, folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(content(), "new");
}

TEST_F(OutputFileTest, LargeFilesAreReadBackWhole) {
  std::string large(1'000'003, '\0');
  for (std::size_t k = 0; k < large.size(); ++k) large[k] = static_cast<char>(k * k % 251);
  for (const std::string& text : {std::string(), std::string(1 << 16, 'x'), large}) {
    write_file(path, text);
    EXPECT_EQ(read_file(path), text);
  }
  EXPECT_THAT([&] { read_file(folder); }, testing::ThrowsMessage<InputError>(testing::HasSubstr("Is a directory")));
}

TEST_F(OutputFileTest, SaysWhyAFileCannotBeWritten) {
  using testing::HasSubstr;
  using testing::ThrowsMessage;
  EXPECT_THAT([&] { write_file(folder, ""); }, ThrowsMessage<InputError>(HasSubstr("it is a folder")));
  EXPECT_THAT([&] { write_file(folder / "no" / "file", ""); }, ThrowsMessage<InputError>(HasSubstr("No such file")));
  EXPECT_THAT([&] { write_file("", ""); }, ThrowsMessage<InputError>(HasSubstr("names no file")));
}

TEST_F(OutputFileTest, FullDiskIsReportedAndLeavesTheOldFile) {
  write_file(path, "old");
  rlimit limit;
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, limit.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_file(path, std::string(100000, 'x')), InputError);
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(num_entries(), 1);
}

}  // namespace
}  // namespace supple

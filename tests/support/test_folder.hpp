#pragma once
/// \file Folder for the files of one test.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace supple::test {

/// A folder of the running test's own, for tests run at the same time must not write to each other's files.
inline std::filesystem::path test_folder() {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  std::string name = std::string("supple_") + test.test_suite_name() + "_" + test.name();
  std::replace(name.begin(), name.end(), '/', '_');
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::create_directories(path);
  return path;
}

}  // namespace supple::test

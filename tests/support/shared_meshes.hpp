#pragma once
/// \file The optional collection of real and awkward meshes, which is no part of the project: tests skip without it.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace supple::test {

inline std::filesystem::path meshes() {
  const char* given = std::getenv("SUPPLE_SHARED_MESHES");
  return given ? given : SUPPLE_SHARED_MESHES;
}

#define SKIP_WITHOUT_MESHES() \
  if (!std::filesystem::exists(meshes())) GTEST_SKIP() << "no collection of meshes at " << meshes()

}  // namespace supple::test

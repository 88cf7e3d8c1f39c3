/// \file Models and trajectories with one byte changed: no change goes unnoticed, wherever it is.

#include <app/scene/trajectory.hpp>
#include <core/output_file.hpp>
#include <core/random.hpp>
#include <tests/fuzz/small_models.hpp>
#include <tests/support/long_run.hpp>
#include <tests/support/test_folder.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <functional>

namespace supple::fuzz {

namespace {

namespace fs = std::filesystem;

/// Changes one byte at a time, as often in the header's length, its text and its padding as in the arrays and their padding.
/// \param load  is to throw InputError for each.
void expect_detected(const fs::path& path, const std::function<void()>& load) {
  ASSERT_NO_THROW(load());
  const std::string bytes = read_file(path);
  std::uint64_t header = 0;
  std::memcpy(&header, bytes.data(), 8);
  const std::size_t text = bytes.find_last_not_of(' ', 8 + header - 1) + 1, arrays = 8 + header;
  std::vector<std::array<std::size_t, 2>> parts{{0, 8}, {8, text}, {arrays, bytes.size()}};
  if (text < arrays) parts.push_back({text, arrays});
  std::vector<std::size_t> padding;  // zeros between the arrays, mostly
  for (std::size_t k = arrays; k < bytes.size(); ++k)
    if (bytes[k] == '\0') padding.push_back(k);

  Random random(13);
  const auto below = [&](std::size_t count) {
    return static_cast<std::size_t>(random.below(static_cast<Index>(count)));
  };
  for (int k = 0, trials = test::repetitions(300, 10000); k < trials; ++k) {
    const std::size_t part = below(parts.size() + 1);
    const std::size_t at =
        part == parts.size() ? padding[below(padding.size())] : parts[part][0] + below(parts[part][1] - parts[part][0]);
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ static_cast<char>(1 + below(255)));
    write_file(path, changed);
    EXPECT_THROW(load(), InputError) << "byte " << at << ", 0x" << std::hex << static_cast<int>(changed[at]);
  }
}

TEST(Corruption, OfAnyByteOfAModelIsDetected) {
  const fs::path path = test::test_folder() / "model.supple";
  for (const Body& body : small_bodies()) {
    save_model(path, small_model(body, 3));
    expect_detected(path, [&] { (void)load_model(path); });
  }
}

TEST(Corruption, OfAnyByteOfATrajectoryIsDetected) {
  const fs::path model = test::test_folder() / "model.supple", path = test::test_folder() / "trajectory.safetensors";
  save_model(model, small_model(small_bodies().front(), 3));
  for (const bool reduced : {true, false}) {
    save_trajectory(path, small_trajectory(model, reduced));
    expect_detected(path, [&] { (void)load_trajectory(path); });
  }
}

}  // namespace

}  // namespace supple::fuzz

#pragma once
/// \file Readers of files as functions of bytes, for libFuzzer (fuzzer.cpp, scripts/fuzz) and for the short replay that is
/// one of the tests (replay_test.cpp).

#include <core/check.hpp>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace supple::fuzz {

/// A reader that broke its promise: whatever the bytes, it returns a sound value or throws an InputError that names the file,
/// and never asks for more memory than the bytes can justify.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

/// \throws Finding
inline void demand(bool sound, const std::string& what) {
  if (!sound) throw Finding(what);
}

enum class Answer { Sound, Refused };

/// Calls read(), which is to demand what a sound value is.
/// \throws Finding if it throws an InputError that does not name the file; other exceptions pass.
template <typename Read>
Answer answer_of(const std::filesystem::path& path, const Read& read) {
  try {
    read();
    return Answer::Sound;
  } catch (const InputError& error) {
    demand(std::string(error.what()).find(path.string()) != std::string::npos,
           "a message that does not name the file: " + std::string(error.what()));
    return Answer::Refused;
  }
}

struct Target {
  std::string name;
  std::function<std::vector<std::string>()> seeds;  ///< files as they should be, to be damaged
  /// Brings the bytes into files of the folder, which is empty but for those of earlier calls, and reads them.
  std::function<Answer(const std::string& bytes, const std::filesystem::path& folder)> read;
  std::size_t memory_per_byte = 100, memory = 200000;  ///< that the reader may ask for at once [bytes]
  bool seeds_are_sound = true;                         ///< else some may be refused
};

/// Meshes, surfaces, node sets, matrices, tables, JSON, pictures.
std::vector<Target> reader_targets();
/// Tensor files, models, trajectories, poses, scenes, edits, materials.
std::vector<Target> model_targets();

/// Replaces the file. \return its path.
inline std::filesystem::path put(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

}  // namespace supple::fuzz

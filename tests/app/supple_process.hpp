#pragma once
/// \file The built command as a process of its own.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace supple::test {

using Arguments = std::vector<std::string>;

struct Outcome {
  int exit_code = -1;  ///< −signal if a signal killed it
  std::string out, err;

  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// Runs `supple` in a folder, its stdout and stderr in pipes.
Outcome run_supple(const Arguments& arguments, const std::filesystem::path& folder);
/// The same with stderr on a terminal.
Outcome run_supple_on_terminal(const Arguments& arguments, const std::filesystem::path& folder);
/// The same with a stdout that takes nothing.
Outcome run_supple_on_full_disk(const Arguments& arguments, const std::filesystem::path& folder);
/// The same where no file may grow beyond so many bytes.
Outcome run_supple_with_largest_file(const Arguments& arguments, const std::filesystem::path& folder,
                                     std::size_t bytes);
/// The same, sent `signal` after a while.
Outcome run_supple_until_signal(const Arguments& arguments, const std::filesystem::path& folder, int signal,
                                std::chrono::microseconds after);
/// The same, sent `signal` as soon as it has opened a file to write.
Outcome run_supple_until_signal_while_writing(const Arguments& arguments, const std::filesystem::path& folder,
                                              int signal);

/// The same, sent `signal` as soon as it has printed something.
Outcome run_supple_until_signal_once_it_prints(const Arguments& arguments, const std::filesystem::path& folder,
                                               int signal);

/// A fresh folder for each test, removed afterwards.
class SuppleProcess : public testing::Test {
 protected:
  SuppleProcess();
  ~SuppleProcess() override;

  Outcome supple(const Arguments& arguments) const { return run_supple(arguments, folder); }
  /// Demands success, silence on stderr, and a JSON report on stdout.
  nlohmann::json report(Arguments arguments) const;
  /// Demands exit code `code` and one line on stderr that holds every part.
  void expect_refusal(const Arguments& arguments, const std::vector<std::string>& parts, int code = 2) const;
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::filesystem::path& name) const;
  std::vector<std::string> files() const;  ///< in the folder, sorted

  std::filesystem::path folder;
};

}  // namespace supple::test

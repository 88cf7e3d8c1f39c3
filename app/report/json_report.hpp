#pragma once
/// \file Reports for machines, and the checks that spare a user a long wait before a file cannot be written.

#include <core/stopwatch.hpp>
#include <core/types.hpp>
#include <reduction/pipeline/reduce_options.hpp>
#include <sparse/selection/selection.hpp>

#include <nlohmann/json.hpp>

#include <exception>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace supple {

using Json = nlohmann::ordered_json;  ///< keeps the order of the keys; NaN is written as null

/// To a file, or to stdout if the path is "-" or /dev/stdout; nothing if it is empty.
void write_json(const std::filesystem::path& path, const Json& report);
inline bool is_stdout(const std::filesystem::path& path) {
  return path == "-" || path == "/dev/stdout";
}

/// The name of a kind of cells or components as a key: "Gauss points" → "gauss_points".
std::string json_key(std::string_view name);
Json json_numbers(VectorIn values);
/// An entry for each iterate of a selector.
Json json_history(const SelectionReport& report);
Json json_full_error(const FullError& error);
Json json_seconds(const std::vector<std::pair<std::string, double>>& seconds, double total);

/// The stages of a command and their times.
class StageTimes {
 public:
  /// A stage that began when the last one ended ends now.
  void finish(const char* stage) {
    add(stage, watch_.seconds());
    watch_.restart();
  }
  void add(const char* stage, double seconds) { seconds_.emplace_back(stage, seconds); }
  double current() const { return watch_.seconds(); }  ///< of the stage that is going on [s]
  void restart() { watch_.restart(); }
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }
  double total() const { return total_.seconds(); }  ///< since the start [s]

 private:
  Stopwatch total_, watch_;
  std::vector<std::pair<std::string, double>> seconds_;
};

/// \throws InputError if a file could not be created at this path; stdout and no path always pass.
void require_writable(const std::filesystem::path& path);
/// The folder of a command's results, made with those above it. A failure that leaves before anything was written
/// takes away again what was made.
class OutputFolder {
 public:
  /// \param folder  empty: none.  \throws InputError naming it and the reason.
  explicit OutputFolder(const std::filesystem::path& folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // the innermost first
  int exceptions_ = std::uncaught_exceptions();
};

/// The value of an option such as "2 MPa" in `unit`. \throws InputError naming the option.
double option_quantity(std::string_view option, std::string_view text, std::string_view unit);

}  // namespace supple

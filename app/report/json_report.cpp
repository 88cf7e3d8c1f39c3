#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <core/check.hpp>
#include <core/output_file.hpp>
#include <io/text/unit.hpp>

#include <cctype>
#include <cstdio>
#include <unistd.h>

namespace supple {

void write_json(const std::filesystem::path& path, const Json& report) {
  if (path.empty()) return;
  // a name in a foreign encoding must not cost the report
  const std::string text = report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (is_stdout(path)) {
    std::fputs(text.c_str(), stdout);
    return;
  }
  const ExitGuard guard(path);
  write_file(path, text);
}

std::string json_key(std::string_view name) {
  std::string key(name);
  for (char& c : key) c = c == ' ' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return key;
}

Json json_numbers(VectorIn values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

Json json_history(const SelectionReport& report) {
  Json history = Json::array();
  for (const SelectionStep& step : report.history)
    history.push_back({{"points", step.size},
                       {"training_error", step.training_error},
                       {"held_out_error", step.held_out_error},
                       {"seconds", step.seconds},
                       {"columns_evaluated", step.columns_evaluated}});
  return history;
}

Json json_full_error(const FullError& error) {
  return {{"total", error.total},
          {"outside_subspace", error.outside},
          {"inside_subspace", error.inside},
          {"worst", error.worst},
          {"loads", error.loads},
          {"halved", error.halved},
          {"unfinished", error.unfinished}};
}

Json json_seconds(const std::vector<std::pair<std::string, double>>& seconds, double total) {
  Json result = Json::object();
  for (const auto& [stage, time] : seconds) result[stage] = result.value(stage, 0.0) + time;
  result["total"] = total;
  return result;
}

void require_writable(const std::filesystem::path& path) {
  if (path.empty() || is_stdout(path)) return;
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw InputError(path.string() + ": cannot be written: it is a folder");
  if (is_stream(path)) {
    if (access(path.c_str(), W_OK) != 0)
      throw InputError(path.string() + ": cannot be written: it is not open for that");
    return;
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, error))
    throw InputError(path.string() + ": cannot be written: there is no folder " + folder.string());
  if (access(folder.c_str(), W_OK) != 0)
    throw InputError(path.string() + ": cannot be written: " + folder.string() + " is not open for writing");
}

OutputFolder::OutputFolder(const std::filesystem::path& folder) {
  if (folder.empty()) return;
  std::error_code error;
  for (std::filesystem::path path = folder; !path.empty() && !std::filesystem::exists(path, error);
       path = path.parent_path())
    if (path.has_filename()) made_.push_back(path);  // "run/" ends in a nameless part
  std::filesystem::create_directories(folder, error);
  if (!error && !std::filesystem::is_directory(folder, error)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw InputError(folder.string() + ": the folder cannot be made: " + error.message());
}

OutputFolder::~OutputFolder() {
  std::error_code not_empty;
  if (std::uncaught_exceptions() > exceptions_)
    for (const std::filesystem::path& folder : made_) std::filesystem::remove(folder, not_empty);
}

double option_quantity(std::string_view option, std::string_view text, std::string_view unit) {
  try {
    return parse_quantity(text, unit);
  } catch (const InputError& error) {
    throw InputError(std::string(option) + ": " + error.what());
  }
}

}  // namespace supple

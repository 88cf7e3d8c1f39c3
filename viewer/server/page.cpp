#include <core/check.hpp>
#include <core/output_file.hpp>
#include <viewer/server/resource.hpp>

#include <system_error>
#include <utility>

namespace supple {

namespace {

constexpr std::uintmax_t most_bytes = std::uintmax_t{64} << 20;

std::string type_of(const std::filesystem::path& file) {
  static constexpr std::pair<std::string_view, std::string_view> types[]{{".html", "text/html; charset=utf-8"},
                                                                         {".js", "text/javascript; charset=utf-8"},
                                                                         {".css", "text/css; charset=utf-8"},
                                                                         {".json", "application/json"},
                                                                         {".svg", "image/svg+xml"},
                                                                         {".png", "image/png"},
                                                                         {".ico", "image/x-icon"},
                                                                         {".wasm", "application/wasm"},
                                                                         {".woff2", "font/woff2"},
                                                                         {".txt", "text/plain; charset=utf-8"}};
  for (const auto& [ending, type] : types)
    if (file.extension() == ending) return std::string(type);
  return "application/octet-stream";
}

}  // namespace

Resources read_page(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  Resources files;
  std::uintmax_t bytes = 0;
  try {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_symlink() || !entry.is_regular_file()) continue;
      bytes += entry.file_size();
      if (bytes > most_bytes) throw InputError(folder.string() + ": is larger than the 64 MiB that a page may have");
      files["/" + entry.path().lexically_relative(folder).generic_string()] = {type_of(entry.path()),
                                                                               read_file(entry.path())};
    }
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder.string() + ": cannot be read: " + error.code().message());
  }
  const auto index = files.find("/index.html");
  if (index == files.end()) throw InputError(folder.string() + ": has no index.html, expected a built page");
  files["/"] = index->second;
  return files;
}

}  // namespace supple

#include <core/check.hpp>
#include <io/text/cursor.hpp>
#include <io/text/index_file.hpp>

#include <algorithm>

namespace supple {

std::vector<Index> read_indices(const std::filesystem::path& path, std::string_view what, Index count) {
  const std::string bytes = read_text(path), name(what);
  Cursor in(path.string(), bytes, {.separator = '\0', .comment = '#'});
  std::vector<Index> indices;
  while (!in.peek().empty()) {
    const std::int64_t index = in.integer("a " + name + " index");
    if (index < 0 || index >= count)
      in.fail(name + " " + std::to_string(index) + " does not exist: indices are 0 … " + std::to_string(count - 1));
    indices.push_back(index);
  }
  if (indices.empty()) throw InputError(path.string() + ": names no " + name + ", expected one index a line");
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  return indices;
}

}  // namespace supple

#include <io/mesh/mesh_repairs.hpp>
#include <io/text/cursor.hpp>

#include <cctype>

namespace supple {

std::string plural(Index count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

bool has_extension(const std::filesystem::path& path, std::string_view extension) {
  std::string own = path.extension().string();
  for (char& c : own) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return own == extension;
}

std::string_view first_word(std::string_view bytes) {
  return Cursor("", bytes, {.separator = '\0', .comment = '#'}).word();
}

Index num_coincident_nodes(const Points& nodes) {
  std::vector<Index> order(nodes.rows());
  std::iota(order.begin(), order.end(), Index{0});
  const auto place = [&](Index v) { return std::array{nodes(v, 0), nodes(v, 1), nodes(v, 2)}; };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return place(a) < place(b); });
  Index count = 0;
  for (std::size_t k = 1; k < order.size(); ++k) count += place(order[k]) == place(order[k - 1]);
  return count;
}

}  // namespace supple

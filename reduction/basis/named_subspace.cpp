#include <core/check.hpp>
#include <reduction/basis/named_subspace.hpp>

#include <algorithm>

namespace supple {

const std::vector<std::string>& known_subspaces() {
  static const std::vector<std::string> names{"extended", "modal", "derivatives", "skinning", "pca"};
  return names;
}

std::vector<std::string> parts_of_subspace(const std::string& name) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= name.size();) {
    const std::size_t end = std::min(name.find('+', begin), name.size());
    const std::string part = name.substr(begin, end - begin);
    if (std::ranges::find(known_subspaces(), part) == known_subspaces().end()) {
      std::string known;
      for (const std::string& other : known_subspaces()) known += (known.empty() ? "" : ", ") + other;
      throw std::invalid_argument("subspace '" + part + "' is not known, expected one of " + known +
                                  ", or several with '+' between");
    }
    require(std::ranges::find(parts, part) == parts.end(), "subspace '" + name + "' has '" + part + "' twice");
    parts.push_back(part);
    begin = end + 1;
  }
  return parts;
}

void check(const SubspaceChoice& choice) {
  const std::vector<std::string> parts = parts_of_subspace(choice.name);
  require(parts.size() == 1 || choice.dimension == 0,
          "subspace '" + choice.name + "' has the dimensions of its parts, expected no other");
  require(choice.modes >= 1, "number of modes is " + std::to_string(choice.modes) + ", expected at least 1");
  require(choice.dimension >= 0, "dimension is " + std::to_string(choice.dimension) + ", expected 0 or more");
  require(std::ranges::find(parts, "pca") == parts.end() || choice.snapshots.size() > 0,
          "subspace 'pca' needs snapshots");
}

Index skinning_weights(const SubspaceChoice& choice) {
  return std::max<Index>(1, choice.dimension > 0 ? choice.dimension / 12 : (choice.modes + 1) / 2);
}

}  // namespace supple

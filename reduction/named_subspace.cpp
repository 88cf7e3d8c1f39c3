#include <core/check.hpp>
#include <reduction/named_subspace.hpp>

#include <algorithm>

namespace supple {

const std::vector<std::string>& known_subspaces() {
  static const std::vector<std::string> names{"extended", "modal", "derivatives", "skinning", "pca"};
  return names;
}

void check(const SubspaceChoice& choice) {
  std::string known;
  for (const std::string& name : known_subspaces()) known += (known.empty() ? "" : ", ") + name;
  require(std::find(known_subspaces().begin(), known_subspaces().end(), choice.name) != known_subspaces().end(),
          "subspace '" + choice.name + "' is not known, expected one of " + known);
  require(choice.modes >= 1, "number of modes is " + std::to_string(choice.modes) + ", expected at least 1");
  require(choice.dimension >= 0, "dimension is " + std::to_string(choice.dimension) + ", expected 0 or more");
  require(choice.name != "pca" || choice.snapshots.size() > 0, "subspace 'pca' needs snapshots");
}

Index skinning_weights(const SubspaceChoice& choice) {
  return std::max<Index>(1, choice.dimension > 0 ? choice.dimension / 12 : (choice.modes + 1) / 2);
}

}  // namespace supple

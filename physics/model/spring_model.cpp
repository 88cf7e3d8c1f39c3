#include <physics/model/spring_model.hpp>

#include <string>

namespace supple {

SpringModel::SpringModel(const Points& nodes, const std::vector<Ends>& springs, VectorIn stiffness)
    : rest_positions_(nodes), springs_(springs) {
  if (stiffness.size() != 1) require_size("stiffness", stiffness.size(), static_cast<Index>(springs.size()));
  terms_.reserve(springs.size());
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const auto [a, b] = springs[i];
    const std::string name = "spring " + std::to_string(i);
    for (const Index v : springs[i])
      require(v >= 0 && v < num_nodes(),
              name + " names node " + std::to_string(v) + ", expected 0 to " + std::to_string(num_nodes() - 1));
    const Point rest = (nodes.row(b) - nodes.row(a)).transpose();
    const double k = stiffness[stiffness.size() == 1 ? 0 : static_cast<Index>(i)];
    require(rest.norm() > 0, name + " has no length: its ends are at the same place");
    require(k > 0, name + " has stiffness " + std::to_string(k) + " N/m, expected > 0");
    terms_.push_back({{rest[0], rest[1], rest[2]}, rest.norm(), k});
  }
}

}  // namespace supple

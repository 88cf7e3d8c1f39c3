#include <physics/body/material_law.hpp>
#include <reduction/pipeline/object_traits.hpp>

namespace supple {

ObjectTraits traits_of(const Body& body, const ReduceOptions& options) {
  return {.diagonal = bounding_box(node_positions(body)).diagonal(),
          .inverted = inverted_rule(law(body), options.poses.inverted),
          .equilibria = num_equilibria(body, options),
          .thin = std::holds_alternative<Shell>(body),
          .component_name = std::string(component_name(body))};
}

Index num_equilibria(const Body& body, const ReduceOptions& options) {
  const bool free_shell = std::holds_alternative<Shell>(body) && fixed_nodes(body).empty();
  const bool useful = options.given_poses.size() == 0 && !free_shell;
  return options.equilibria.value_or(useful ? options.poses.count / 3 : 0);
}

InvertedPoses inverted_rule(std::string_view law, std::optional<InvertedPoses> asked) {
  const bool finite_energy = law == shell_law || material_law(law).finite_when_inverted;
  require(finite_energy || asked != InvertedPoses::Keep, "poses with inverted tets cannot be kept: the energy of " +
                                                             std::string(law) +
                                                             " is infinite there; expected shrink or redraw");
  return asked.value_or(finite_energy ? InvertedPoses::Keep : InvertedPoses::Shrink);
}

}  // namespace supple

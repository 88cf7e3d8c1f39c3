#include <physics/load/outside_force_library.hpp>
#include <physics/load/penalty_floor.hpp>

namespace supple {

Registry<NamedOutsideForce>& outside_forces() {
  static Registry<NamedOutsideForce> all(
      "outside force",
      {named_outside_force("floor", "a soft plane that nodes do not sink below",
                           OptionsOf<FloorParameters>()
                               .add("axis", &FloorParameters::axis, "which way is up: x, y or z")
                               .add("height", &FloorParameters::height, "of the floor [m]")
                               .add("stiffness", &FloorParameters::stiffness, "of all nodes together [N/m]"),
                           [](const TouchedNodes& where, const FloorParameters& parameters) {
                             return PenaltyFloor(where.rest_positions, where.nodes, where.shares, parameters);
                           })});
  return all;
}

}  // namespace supple

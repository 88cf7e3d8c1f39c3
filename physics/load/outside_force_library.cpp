#include <physics/load/follower_pressure.hpp>
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
                           }),
       named_outside_force(
           "pressure", "a pressure on the surface between the nodes, which it follows",
           OptionsOf<PressureParameters>().add("pressure", &PressureParameters::pressure, "pushing inward [Pa]"),
           [](const TouchedNodes& where, const PressureParameters& parameters) {
             return FollowerPressure(where.rest_positions, where.triangles, parameters);
           })});
  return all;
}

}  // namespace supple

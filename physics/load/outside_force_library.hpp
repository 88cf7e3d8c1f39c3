#pragma once
/// \file Registry of outside forces, for scenes.

#include <core/registry.hpp>
#include <physics/load/outside_force.hpp>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace supple {

/// The nodes that an outside force may touch.
struct TouchedNodes {
  const Points& rest_positions;  ///< of all nodes, n × 3 [m]
  std::vector<Index> nodes;
  Vector shares;  ///< of these nodes in their mass; they add up to 1
  std::vector<std::array<Index, 3>> triangles =
      {};  ///< of the object's surface, outward, whose corners are all among them
};

/// An outside force by name.
struct NamedOutsideForce {
  std::string name, description;
  std::vector<OptionInfo> options;
  /// \throws std::invalid_argument for options that it has not, or that make no sense.
  std::function<AnyOutsideForce(const TouchedNodes& where, const OptionValues& options)> make;
};

/// The entry of a force of one's own, from what makes it: make(where, parameters) with a Parameters of these options.
/// \throws std::invalid_argument for options with the names of keys that scenes have: force, nodes, region, from, until.
///
///     outside_forces().add(named_outside_force("wind", "drag of a steady wind", OptionsOf<WindParameters>()…,
///                                              [](const TouchedNodes& where, const WindParameters& p) { return Wind(…); }));
template <typename Parameters, typename Make>
NamedOutsideForce named_outside_force(std::string name, std::string description, OptionsOf<Parameters> options,
                                      Make make) {
  for (const OptionInfo& option : options.info())
    for (const char* key : {"force", "nodes", "region", "from", "until"})
      require(option.name != key,
              "outside force " + name + " has an option '" + option.name + "', which scenes have for every force");
  return {name, std::move(description), options.info(),
          [name, options, make](const TouchedNodes& where, const OptionValues& values) -> AnyOutsideForce {
            return make(where, options.make(values, "outside force " + name));
          }};
}

/// All outside forces by name: "floor", "pressure" and what was added.
Registry<NamedOutsideForce>& outside_forces();

}  // namespace supple

#pragma once
/// \file Check of the masses of a whole object.

#include <core/types.hpp>

#include <stdexcept>
#include <string>

namespace supple {

/// The masses themselves. \throws std::invalid_argument naming the first node that has none.
inline Vector mass_everywhere(Vector mass) {
  for (Index v = 0; v < mass.size(); ++v)
    if (!(mass[v] > 0))
      throw std::invalid_argument("node " + std::to_string(v) +
                                  " has no mass: it belongs to no cell, or what it belongs to has no size");
  return mass;
}

}  // namespace supple

#pragma once
/// \file Elements that lock where materials hardly change their volume.

#include <physics/body/body.hpp>

#include <optional>

namespace supple {

/// The largest Poisson's ratio at rest of a body's materials if that is above 0.45 and its elements lock there: linear tets
/// and trilinear hexahedra, whose displacements keep the volume at every Gauss point only by not bending, so bodies come out too
/// stiff (the softest frequency of a bar of 16 × 4 × 4 cells three times too high at 0.4999). Quadratic tets and shells do not.
/// None for a law that does not tell (MaterialLaw::poisson).
std::optional<double> locking_poisson(const Body& body);

}  // namespace supple

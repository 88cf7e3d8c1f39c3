#pragma once
/// \file Precision of the rows of a basis that a reduced system keeps.

#include <core/registry.hpp>

#include <array>

namespace supple {

/// How a ReducedSystem keeps the rows of W behind its components. A dense basis of hundreds of modes is larger than the
/// caches near a core, and Single halves what each force has to read. Rounded rows (relative 6e-8) are those of a basis
/// close by: energy, force and tangent still agree by differentiation, so solvers reach any tolerance.
enum class RowPrecision { Double, Single };

template <>
inline constexpr std::array names_of<RowPrecision>{Named{RowPrecision::Double, "double"},
                                                   Named{RowPrecision::Single, "single"}};

}  // namespace supple

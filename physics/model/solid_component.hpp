#pragma once
/// \file Cells or single Gauss points: what a component of a solid is.

namespace supple {

/// What a component of a solid is, hence what is selected when it is reduced. Either way the energy of all
/// components is that of the solid.
enum class SolidComponent {
  Element,     ///< a cell with all its Gauss points: few columns to fit
  GaussPoint,  ///< a single Gauss point, as in cubature: a finer choice, and a material evaluated for each
};

}  // namespace supple

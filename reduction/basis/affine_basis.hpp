#pragma once
/// \file Affine motions of a free object as a subspace.

#include <reduction/subspace/rigid_modes.hpp>
#include <reduction/subspace/subspace_builder.hpp>

namespace supple {

/// All affine motions of each part that nothing holds, nothing else: the fields 1, X, Y, Z of the part, times
/// I₃, so d = 12 a part; 9 if it is flat.
struct AffineBasis {
  /// \throws std::invalid_argument if every part is held.
  NodalBasis operator()(const RestState& object) const {
    object.require_space();
    const FreeComponents components = find_free_components(object.stencils, object.stencil_size, object.numbering);
    require(!components.free.empty(), "affine motions: every part of the object is held");
    Orthonormalized fields = mass_orthonormalize(affine_fields(object.positions, components), object.nodal_mass);
    SubspaceReport report;
    report.dropped = 3 * fields.dropped;
    return {std::move(fields.W), std::move(report)};
  }
};

static_assert(SubspaceBuilder<AffineBasis>);

}  // namespace supple

#pragma once
/// \file The affine motions of a free object.

#include <reduction/subspace/rigid_modes.hpp>
#include <reduction/subspace/subspace_builder.hpp>

#include <type_traits>

namespace supple {

/// All affine motions of each part that nothing holds, nothing else: the fields 1, X, Y, Z of the part, times
/// I₃, so d = 12 a part; 9 if it is flat.
struct AffineBasis {
  /// \throws std::invalid_argument if every part is held.
  template <typename System>
  requires(System::node_dim == 3) NodalBasis operator()(const System& system) const {
    using Model = std::remove_cvref_t<decltype(system.model())>;
    const FreeComponents components = find_free_components(system.stencils(), Model::stencil_size, system.numbering());
    require(!components.free.empty(), "affine motions: every part of the object is held");
    Orthonormalized fields =
        mass_orthonormalize(affine_fields(system.model().rest_positions(), components), system.nodal_mass());
    SubspaceReport report;
    report.dropped = 3 * fields.dropped;
    return {std::move(fields.W), std::move(report)};
  }
};

static_assert(SubspaceBuilder<AffineBasis>);

}  // namespace supple

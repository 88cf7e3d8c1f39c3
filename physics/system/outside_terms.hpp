#pragma once
/// \file Outside forces in the unknowns of a full system.

#include <physics/load/system_load.hpp>
#include <physics/system/node_numbering.hpp>

#include <memory>
#include <vector>

namespace supple {

/// Each force as a term over three unknowns a free node; on fixed nodes it is borne by the support.
std::vector<std::shared_ptr<const OutsideTerm<SparseMatrix>>> outside_terms(const std::vector<AnyOutsideForce>& forces,
                                                                            const NodeNumbering& numbering);

}  // namespace supple

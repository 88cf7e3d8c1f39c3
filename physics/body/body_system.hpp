#pragma once
/// \file Full system of any object, as a value.

#include <physics/body/body.hpp>
#include <physics/system/any_system.hpp>

namespace supple {

/// What integrators and static solvers run when nothing is reduced: the free nodes of an object, three unknowns each.
/// \throws std::invalid_argument for data that make no model, see force_model.
AnySystem<SparseMatrix> full_system(const Body& body);

}  // namespace supple

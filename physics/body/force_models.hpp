#pragma once
/// \file Force model of any object, its type erased.

#include <physics/body/body.hpp>
#include <physics/model/any_model.hpp>

#include <memory>

namespace supple {

/// The force model of a solid, its law by name. \throws std::invalid_argument for data that make no model, such as cells
/// without volume or an unknown law, or one that has no model of such cells.
std::shared_ptr<const AnyModel<4>> force_model(const Solid& solid);
std::shared_ptr<const AnyModel<8>> force_model(const HexSolid& solid);
std::shared_ptr<const AnyModel<10>> force_model(const QuadraticTetSolid& solid);
std::shared_ptr<const AnyModel<4>> force_model(const Shell& shell);

/// Calls visit(model) with a shared pointer to its force model, an AnyModel of four, eight or ten nodes.
/// \throws std::invalid_argument for data that make no model, such as tets without volume or an unknown law.
template <typename Visitor>
decltype(auto) with_force_model(const Body& body, Visitor&& visit) {
  return std::visit([&](const auto& some) -> decltype(auto) { return visit(force_model(some)); }, body);
}

}  // namespace supple

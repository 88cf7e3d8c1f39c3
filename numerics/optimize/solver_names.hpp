#pragma once
/// \file Names of nonlinear solvers, as scenes and command lines give them.

#include <numerics/optimize/warm_solver.hpp>

#include <array>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

struct NamedSolver {
  std::string_view name;
  NonlinearSolver solver;
};

/// Those of time steps, which are close to linear.
inline const std::array step_solvers{NamedSolver{"newton", Newton{}}, NamedSolver{"bfgs", Bfgs{}},
                                     NamedSolver{"broyden", Broyden{}}, NamedSolver{"warped-bfgs", WarpedBfgs{}}};
/// Whether one of them is for a full system, or for a reduced one.
inline bool is_step_solver_for(bool full, const NonlinearSolver& solver) {
  return std::holds_alternative<Newton>(solver) || std::holds_alternative<WarpedBfgs>(solver) == full;
}
/// Those of edits, which go far.
inline const std::array static_solvers{NamedSolver{"newton", Newton{}}, NamedSolver{"bfgs", LineSearchBfgs{}},
                                       NamedSolver{"nlopt", Nlopt{}}};

template <typename Table>
std::vector<std::string> solver_names(const Table& table) {
  std::vector<std::string> names;
  for (const NamedSolver& entry : table) names.emplace_back(entry.name);
  return names;
}
/// \param name  one of the table's.
template <typename Table>
NonlinearSolver solver_named(const Table& table, std::string_view name) {
  for (const NamedSolver& entry : table)
    if (entry.name == name) return entry.solver;
  throw std::invalid_argument("solver '" + std::string(name) + "' is not known");
}
template <typename Table>
std::string_view name_of_solver(const Table& table, const NonlinearSolver& solver) {
  for (const NamedSolver& entry : table)
    if (entry.solver.index() == solver.index()) return entry.name;
  return "unknown";
}

}  // namespace supple

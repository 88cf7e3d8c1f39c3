#pragma once
/// \file A heated bar that the tests of both floors share.

#include <physics/heat/heat_conduction.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/first_order.hpp>
#include <tests/support/meshes.hpp>

#include <gtest/gtest.h>

namespace supple::test {

using Conduction = HeatConduction<LinearConductivity>;

/// A bar of 6 × 2 × 2 irregular cubes of 0.1 m, of a metal whose conductivity doubles in 200 K, held at the reference
/// temperature at x = 0 or insulated everywhere.
struct HeatedBar {
  explicit HeatedBar(bool held = true)
      : mesh(perturbed(kuhn_box(6, 2, 2, 0.1), 0.01, 7)),
        system(std::make_shared<const FullSystem<Conduction>>(
            Conduction(mesh, LinearConductivity<double>::from(40, 0.005)), lumped_heat_capacity(mesh, 2700, 900),
            held ? nodes_where(mesh, [](const Point& x) { return x[0] < 0.05; }) : std::vector<Index>{})) {}

  /// `power` [W], spread evenly over the nodes where `holds`.
  template <typename Predicate>
  Vector flow(double power, const Predicate& holds) const {
    const std::vector<Index> nodes = nodes_where(mesh, holds);
    Vector q = Vector::Zero(mesh.num_nodes());
    for (const Index v : nodes) q[v] = power / static_cast<double>(nodes.size());
    return q;
  }
  Vector end_flow(double power) const {
    return flow(power, [](const Point& x) { return x[0] > 0.55; });
  }
  Vector side_flow(double power) const {
    return flow(power, [](const Point& x) { return x[1] > 0.15 && x[0] > 0.25 && x[0] < 0.45; });
  }

  TetMesh mesh;
  std::shared_ptr<const FullSystem<Conduction>> system;
};

/// Temperatures of all nodes after each step from rest under flows(time), n × steps.
template <typename System, typename Flows, typename ToNodes>
Matrix heat_up(const System& system, double h, Index steps, const FirstOrderOptions& options, const Flows& flows,
               const ToNodes& to_nodes) {
  FirstOrderIntegrator integrator(system, h, options);
  FirstOrderState state = FirstOrderState::at_rest(system.dim());
  integrator.balance(system.project(flows(0.0)), state);
  Matrix result(to_nodes(state.u).size(), steps);
  for (Index k = 0; k < steps; ++k) {
    const Report report = integrator.step(system.project(flows(state.time + h)), state);
    EXPECT_EQ(report.status, Status::Converged) << "step " << k << ": " << report.residual;
    result.col(k) = to_nodes(state.u);
  }
  return result;
}

}  // namespace supple::test

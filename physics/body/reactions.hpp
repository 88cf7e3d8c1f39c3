#pragma once
/// \file Forces that supports exert on an object.

#include <physics/body/body.hpp>
#include <physics/load/loads.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace supple {

/// All that loads exert on an object in a state [N]. \param u  displacements of all nodes, 3n [m].
Point total_force(const Loads& loads, const Body& body, VectorIn u);

/// What supports do to an object, exact in any state, from the cells at held nodes alone: along held axes,
/// r = f(u) + D v − f_ext, so that M a + D v + f(u) = f_ext + r there. Along free axes it is zero. In a state of a reduced
/// model r is the reaction of the full object in that state.
class Reactions {
 public:
  /// \param body  whose supports and cells are kept, not itself.
  explicit Reactions(const Body& body);

  /// Nodes that supports hold, fixed or sliding, ascending.
  const std::vector<Index>& nodes() const { return nodes_; }

  /// \param u  displacements of all nodes, 3n [m].  \param loads  that act now.  \return one row for each of nodes() [N].
  Points operator()(VectorIn u, const Loads& loads) const;
  /// In motion. \param v  velocities of all nodes [m/s].  \param damping  by stiffness, β K(0) v; what moves not at all is not
  /// damped by mass.
  Points operator()(VectorIn u, const Loads& loads, VectorIn v, const RayleighDamping& damping) const;

  /// Resultant of forces at these nodes: force [N] and moment about a point [N m].
  struct Resultant {
    Point force, moment;
  };
  /// \param positions  of all nodes [m], deformed or at rest.
  Resultant resultant(const Points& reactions, const Points& positions, const Point& about = Point::Zero()) const;

 private:
  Points along_held_axes(Points r) const;

  double size_;  // of the object [m]
  std::vector<Index> nodes_;
  std::vector<std::uint8_t> axes_;            // held, of each
  Vector mass_;                               // of each [kg]
  std::function<Points(VectorIn u)> forces_;  // of the cells at these nodes, on them
};

}  // namespace supple

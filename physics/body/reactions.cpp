#include <physics/body/force_models.hpp>
#include <physics/body/reactions.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <map>

namespace supple {

namespace {

/// Where nodes are in a list; −1 for others.
std::vector<Index> places_in(const std::vector<Index>& list, Index num_nodes) {
  std::vector<Index> place(static_cast<std::size_t>(num_nodes), -1);
  for (std::size_t k = 0; k < list.size(); ++k) place[static_cast<std::size_t>(list[k])] = static_cast<Index>(k);
  return place;
}

/// Of an outside force on each of its nodes, where those of the object are displaced so.
Points force_of(const AnyOutsideForce& outside, VectorIn u) {
  Points displacements(static_cast<Index>(outside.nodes().size()), 3), forces = Points::Zero(displacements.rows(), 3);
  for (Index a = 0; a < displacements.rows(); ++a)
    displacements.row(a) = u.segment<3>(3 * outside.nodes()[static_cast<std::size_t>(a)]).transpose();
  outside.force(displacements, forces);
  return forces;
}

}  // namespace

Point total_force(const Loads& loads, const Body& body, VectorIn u) {
  Point sum = nodal_mass(body).sum() * loads.gravity;
  for (const NodalForce& load : loads.forces) sum += load.force;
  for (const auto& [node, stiffness, displacement] : loads.springs)
    sum += stiffness * (displacement - u.segment<3>(3 * node));
  for (const AnyOutsideForce& other : loads.others) sum += force_of(other, u).colwise().sum().transpose();
  return sum;
}

Reactions::Reactions(const Body& body) {
  std::map<Index, std::uint8_t> held;
  for (const Index v : fixed_nodes(body)) held[v] = HeldAxes::all;
  for (const auto& [v, axes] : held_axes(body)) held[v] |= axes;
  for (const auto& [v, axes] : held) {
    nodes_.push_back(v);
    axes_.push_back(axes);
  }
  mass_ = nodal_mass(body)(nodes_);
  size_ = bounding_box(node_positions(body)).diagonal();
  with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    const std::vector<Index> place = places_in(nodes_, model->num_nodes());
    std::vector<Index> components;
    for (Index i = 0; i < model->num_components(); ++i)
      if (std::ranges::any_of(model->stencil(i), [&](Index v) { return place[static_cast<std::size_t>(v)] >= 0; }))
        components.push_back(i);
    forces_ = [model, place, components, count = nodes_.size()](VectorIn u) {
      Points sum = Points::Zero(static_cast<Index>(count), 3);
      for (const Index i : components) {
        const auto stencil = model->stencil(i);
        Local<Model::local_dofs> u_i;
        for (int a = 0; a < Model::stencil_size; ++a)
          u_i.template segment<3>(3 * a) = u.segment<3>(3 * stencil[static_cast<std::size_t>(a)]);
        const Local<Model::local_dofs> f_i = model->force(i, u_i);
        for (int a = 0; a < Model::stencil_size; ++a)
          if (const Index k = place[static_cast<std::size_t>(stencil[static_cast<std::size_t>(a)])]; k >= 0)
            sum.row(k) += f_i.template segment<3>(3 * a).transpose();
      }
      return sum;
    };
  });
}

Points Reactions::operator()(VectorIn u, const Loads& loads, VectorIn v, const RayleighDamping& damping) const {
  Points r = (*this)(u, loads);
  const double speed = v.cwiseAbs().maxCoeff();
  if (!(damping.beta > 0 && speed > 0)) return r;
  const double h = 1e-6 * size_ / speed;  // K(0) v by differences of forces about rest
  Points damped = damping.beta / (2 * h) * (forces_(h * v) - forces_(-h * v));
  return r + along_held_axes(std::move(damped));
}

Points Reactions::operator()(VectorIn u, const Loads& loads) const {
  Points r = forces_(u);
  const std::vector<Index> place = places_in(nodes_, u.size() / 3);
  const auto at = [&](Index node) { return place[static_cast<std::size_t>(node)]; };
  for (Index k = 0; k < r.rows(); ++k) r.row(k) -= mass_[k] * loads.gravity.transpose();
  for (const auto& [node, force] : loads.forces)
    if (at(node) >= 0) r.row(at(node)) -= force.transpose();
  for (const auto& [node, stiffness, displacement] : loads.springs)
    if (at(node) >= 0) r.row(at(node)) += stiffness * (u.segment<3>(3 * node) - displacement).transpose();
  for (const AnyOutsideForce& other : loads.others) {
    const Points forces = force_of(other, u);
    for (Index a = 0; a < forces.rows(); ++a)
      if (const Index k = at(other.nodes()[static_cast<std::size_t>(a)]); k >= 0) r.row(k) -= forces.row(a);
  }
  return along_held_axes(std::move(r));
}

Points Reactions::along_held_axes(Points r) const {
  for (Index k = 0; k < r.rows(); ++k)
    for (int c = 0; c < 3; ++c)
      if (!(axes_[static_cast<std::size_t>(k)] >> c & 1)) r(k, c) = 0;
  return r;
}

Reactions::Resultant Reactions::resultant(const Points& reactions, const Points& positions, const Point& about) const {
  Resultant sum{Point::Zero(), Point::Zero()};
  for (Index k = 0; k < reactions.rows(); ++k) {
    const Point r = reactions.row(k), x = positions.row(nodes_[static_cast<std::size_t>(k)]);
    sum.force += r;
    sum.moment += (x - about).cross(r);
  }
  return sum;
}

}  // namespace supple

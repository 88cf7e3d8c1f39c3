#include <physics/body/cut.hpp>
#include <physics/body/force_models.hpp>

#include <Eigen/Geometry>

#include <algorithm>

namespace supple {

CutForce cut_force(const Body& body, VectorIn u, const CutPlane& plane, const Point& about) {
  require_size("u", u.size(), 3 * num_nodes(body));
  require(plane.axis >= 0 && plane.axis < 3, "axis of a cut is " + std::to_string(plane.axis) + ", expected 0, 1 or 2");
  const Points& rest = node_positions(body);
  return with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    const auto is_beyond = [&](Index i) {
      double sum = 0;
      for (const Index v : model->stencil(i)) sum += rest(v, plane.axis);
      return sum > Model::stencil_size * plane.coordinate;
    };
    std::vector<char> beyond(static_cast<std::size_t>(model->num_components())),
        touched(static_cast<std::size_t>(model->num_nodes()), false);  // by what is beyond
    for (Index i = 0; i < model->num_components(); ++i) {
      beyond[static_cast<std::size_t>(i)] = is_beyond(i);
      if (beyond[static_cast<std::size_t>(i)])
        for (const Index v : model->stencil(i)) touched[static_cast<std::size_t>(v)] = true;
    }
    const auto count = std::ranges::count(beyond, true);
    require(count > 0 && count < model->num_components(), "nothing of the object lies on one side of the cut");
    CutForce result;
    for (Index i = 0; i < model->num_components(); ++i) {
      const auto stencil = model->stencil(i);
      const bool at_cut = !beyond[static_cast<std::size_t>(i)] &&
                          std::ranges::any_of(stencil, [&](Index v) { return touched[static_cast<std::size_t>(v)]; });
      if (!at_cut) continue;
      ++result.components;
      Local<Model::local_dofs> u_i;
      for (int a = 0; a < Model::stencil_size; ++a)
        u_i.template segment<3>(3 * a) = u.segment<3>(3 * stencil[static_cast<std::size_t>(a)]);
      const Local<Model::local_dofs> f = model->force(i, u_i);
      for (int a = 0; a < Model::stencil_size; ++a) {
        const Index v = stencil[static_cast<std::size_t>(a)];
        if (!touched[static_cast<std::size_t>(v)]) continue;
        const Point f_v = f.template segment<3>(3 * a), x = Point(rest.row(v)) + u.segment<3>(3 * v);
        result.force += f_v;
        result.moment += (x - about).cross(f_v);
      }
    }
    return result;
  });
}

}  // namespace supple

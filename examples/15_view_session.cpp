// A session as a viewer runs it, without one: reduce a bar, pull at its tip while it moves, then bend it by a handle and
// take that back. A server, a notebook or a game would show each frame.

#include <io/builtin/builtin_meshes.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <viewer/session/view_session.hpp>

#include <cstdio>

using namespace supple;

int main() {
  TetMesh mesh = std::get<TetMesh>(builtin_solid_mesh("bar:12x3x3"));
  std::vector<Index> held;
  for (Index v = 0; v < mesh.num_nodes(); ++v)
    if (mesh.nodes(v, 0) < 1e-9) held.push_back(v);
  const Solid solid = isotropic_solid(std::move(mesh), {.young = 1e5, .poisson = 0.3}, held);

  const auto model = std::make_shared<const ViewModel>(reduce(solid), "bar");
  const ViewGeometry& shown = model->geometry;
  std::vector<Index> end;  // nodes that are drawn
  for (Index k = 0; k < shown.num_surface_nodes; ++k)
    if (shown.rest(k, 0) > 0.99 * model->box.upper[0]) end.push_back(k);
  const Index tip = end.front();
  const auto place = [&](const ViewFrame& frame) -> Point {
    return (shown.rest.row(tip) + shown.surface_displacements(frame.q).row(tip).cast<double>()).transpose();
  };

  ViewSession session(model);
  session.join(/*client=*/1);
  const Point target = shown.rest.row(tip).transpose() + Point(0, 0.2, 0);
  session.apply(1, request::Set{{.damping = RayleighDamping{.alpha = 4}}});
  session.apply(1, request::PullAt{{.node = tip, .target = target}});
  session.apply(1, request::Play{});
  for (int frame = 0; frame < 180; ++frame) session.advance(1.0 / 60);
  const double left = (place(session.frame()) - target).norm();
  std::printf("after %.1f s the tip is %.0f mm from where it is pulled\n", session.frame().time, 1e3 * left);

  session.apply(1, request::SetMode{ViewMode::Edit});
  session.apply(1, request::MakeHandle{.nodes = end, .name = "end"});
  const Index handle = session.edit().handles().front().id;
  session.apply(1, request::MoveHandle{handle, RigidMotion::turn({0, 0, 1}, 0.8, {0.5, 0.1, 0.1}), /*grab=*/true});
  while (session.until_due() == 0) session.advance(0);
  const double bent = session.frame().elastic;
  std::printf("bent by its handle it holds %.2f J\n", bent);
  session.apply(1, request::Undo{});
  for (const std::string& warning : session.take_warnings()) std::printf("%s\n", warning.c_str());
  return left < 0.1 && bent > 0 && session.frame().elastic < 1e-6 * bent ? 0 : 1;
}

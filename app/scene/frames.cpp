#include <app/report/exit_guard.hpp>
#include <app/scene/coloured_picture.hpp>
#include <app/scene/frames.hpp>
#include <app/scene/result_fields.hpp>
#include <core/stopwatch.hpp>
#include <io/frames/vtu_writer.hpp>

#include <optional>

namespace supple {

namespace {

/// The start, the frame of the largest displacement, and the one after it that is farthest from that.
std::vector<Index> telling_frames(const std::vector<Points>& surface_displacement) {
  Index largest = 0, farthest = -1;
  double most = 0, distance = 0;
  const Index count = static_cast<Index>(surface_displacement.size());
  for (Index f = 0; f < count; ++f)
    if (const double norm = surface_displacement[f].norm(); norm > most) {
      most = norm;
      largest = f;
    }
  for (Index f = largest + 1; f < count; ++f)
    if (const double norm = (surface_displacement[f] - surface_displacement[largest]).norm(); norm > distance) {
      distance = norm;
      farthest = f;
    }
  std::vector<Index> frames{0};
  if (largest > 0) frames.push_back(largest);
  if (farthest > 0) frames.push_back(farthest);
  return frames;
}

void draw_frames(const std::filesystem::path& path, const Points& rest, const std::vector<Triangle>& triangles,
                 const std::vector<Points>& displacement, const Vector& times,
                 const std::function<std::string(double)>& caption) {
  std::vector<PictureObject> objects;
  for (const Index f : telling_frames(displacement)) {
    PictureObject object{.positions = rest + displacement[f], .triangles = triangles};
    object.scalar = displacement[f].rowwise().norm();
    object.caption = caption(times[f]);
    objects.push_back(std::move(object));
  }
  write_coloured_picture(path, objects, "displacement [m]", 1600, 800);
}

void write_surface(const FrameToWrite& frame, VtuSeries& series) {
  const Points displacement = frame.surface.rows(as_points(frame.u));
  VtuFields fields{
      .point_data = {{"displacement [m]", displacement}, {"velocity [m/s]", frame.surface.rows(as_points(frame.v))}}};
  add_places(fields, node_places(frame.body), frame.surface.nodes);
  series.add(frame.time, frame.surface.rows(node_positions(frame.body)) + displacement, frame.surface.triangles,
             fields);
}

/// Of a shell, whose cells are its surface, the surface.
void write_cells(const FrameToWrite& frame, VtuSeries& series) {
  if (std::holds_alternative<Shell>(frame.body)) return write_surface(frame, series);
  visit_solid(frame.body, [&](const auto& solid) {
    VtuFields fields{
        .point_data = {vector_field("displacement [m]", frame.u), vector_field("velocity [m/s]", frame.v)}};
    add_places(fields, solid.mesh.places, all_nodes(solid.mesh.num_nodes()));
    if (has_cell_stress(frame.body)) add_stress(fields, cell_stress(frame.body, frame.u));
    series.add(frame.time, solid.mesh.nodes + as_points(frame.u), solid.mesh.cells, fields);
  });
}

}  // namespace

Registry<NamedFrames>& frame_writers() {
  static Registry<NamedFrames> all("kind of frames",
                                   {{"surface", "the surface, as triangles", {}, write_surface},
                                    {"cells", "all cells of a solid, with their stress", {}, write_cells},
                                    {"tets", "the same as cells", {}, write_cells},
                                    {"none", "nothing", {}, {}}});
  return all;
}

double write_frames(const std::filesystem::path& folder, const std::string& frames, const ReducedModel& model,
                    const Trajectory& trajectory, const std::function<std::string(double)>& caption,
                    const Progress& progress) {
  const Surface surface(model.body);
  const Points rest = surface.rows(node_positions(model.body));
  const std::filesystem::path list = folder / "series.pvd";
  const auto& write = frame_writers().at(frames).write;
  std::optional<VtuSeries> series;
  if (write) {
    const ExitGuard guard;
    if (std::filesystem::exists(list))  // an earlier run may have left more frames than this one has
      for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".vtu" && entry.path().filename().string().starts_with("series_"))
          std::filesystem::remove(entry.path());
    series.emplace(list);
  }
  std::vector<Points> surface_displacement;
  double seconds = 0;
  for (Index f = 0; f < trajectory.num_frames(); ++f) {
    const Stopwatch watch;
    const Vector u = frame_displacement(trajectory, model, f);
    seconds += watch.seconds();
    surface_displacement.push_back(surface.rows(as_points(u)));
    if (series) {
      const Vector v = frame_velocity(trajectory, model, f);
      const ExitGuard guard;
      write({model.body, surface, trajectory.time[f], u, v}, *series);
    }
    tell(progress, "frames", static_cast<double>(f + 1) / static_cast<double>(trajectory.num_frames()));
  }
  tell(progress, "picture", 0);
  draw_frames(folder / "picture.png", rest, surface.triangles, surface_displacement, trajectory.time, caption);
  return seconds;
}

}  // namespace supple

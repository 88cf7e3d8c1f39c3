#include <app/scene/pose_file.hpp>
#include <app/scene/trajectory.hpp>
#include <core/check.hpp>
#include <core/tensor_file.hpp>
#include <io/table/matrix_file.hpp>

namespace supple {

namespace {

Matrix frames_of_trajectory(const std::filesystem::path& path, const Points& nodes) {
  const Trajectory trajectory = load_trajectory(path);
  const ReducedModel model = load_model_of(trajectory, path);
  if (!has_nodes(model.body, nodes))
    throw InputError(path.string() + ": the trajectory is of another mesh than the one to be reduced");
  std::vector<Index> deformed;
  for (Index f = 0; f < trajectory.num_frames(); ++f)
    if (!trajectory.u.row(f).isZero(0)) deformed.push_back(f);
  Matrix poses(3 * nodes.rows(), static_cast<Index>(deformed.size()));
  for (Index t = 0; t < poses.cols(); ++t) poses.col(t) = frame_displacement(trajectory, model, deformed[t]);
  return poses;
}

}  // namespace

Matrix read_poses(const std::filesystem::path& path, const Points& nodes, const NodePlaces& places) {
  if (std::error_code none; std::filesystem::is_directory(path, none))
    return read_poses(path / trajectory_file, nodes, places);
  Matrix poses;
  if (is_matrix_file(path)) {
    poses = read_matrix(path);
  } else if (const TensorFile file(path); file.contains("poses")) {
    poses = file.matrix("poses");
  } else if (file.contains("time")) {
    poses = frames_of_trajectory(path, nodes);
  } else {
    throw InputError(path.string() + ": there is no array 'poses', and it is no trajectory");
  }
  if (poses.cols() == 0) throw InputError(path.string() + ": there are no poses");
  if (!places.of_node.empty() && poses.rows() == 3 * places.count) {  // of all nodes of the mesh's file
    Matrix kept(3 * nodes.rows(), poses.cols());
    for (Index v = 0; v < nodes.rows(); ++v) kept.middleRows(3 * v, 3) = poses.middleRows(3 * places.place(v), 3);
    poses = std::move(kept);
  }
  for (Index t = 0; t < poses.cols(); ++t) {
    if (!poses.col(t).allFinite()) throw InputError(path.string() + ": pose " + std::to_string(t) + " is not finite");
    if (poses.col(t).isZero(0))
      throw InputError(path.string() + ": pose " + std::to_string(t) + " is at rest, where there is no force to fit");
  }
  return poses;
}

Matrix read_snapshots(const std::filesystem::path& path, const Points& nodes, const NodePlaces& places) {
  Matrix snapshots = read_poses(path, nodes, places);
  if (const Index rows = 3 * nodes.rows(); snapshots.rows() != rows)
    throw InputError(path.string() + ": holds " + std::to_string(snapshots.rows()) + " x " +
                     std::to_string(snapshots.cols()) + " numbers, expected " + std::to_string(rows) +
                     " rows, one for each axis of the " + std::to_string(nodes.rows()) +
                     " nodes, and a column a snapshot" + (snapshots.cols() == rows ? "; it may be transposed" : ""));
  return snapshots;
}

}  // namespace supple

#include <app/commands/problem_options.hpp>
#include <app/scene/pose_file.hpp>
#include <app/scene/scene.hpp>
#include <app/scene/trajectory.hpp>
#include <core/output_file.hpp>
#include <core/random.hpp>
#include <tests/fuzz/fuzz_target.hpp>
#include <tests/fuzz/small_models.hpp>
#include <tests/fuzz/tensor_edits.hpp>
#include <viewer/scene/edit_scene_file.hpp>

#include <algorithm>
#include <unistd.h>

namespace supple::fuzz {

namespace {

namespace fs = std::filesystem;

/// A folder for what targets need beside the file under test, filled once.
const fs::path& workshop() {
  static const struct Folder {
    fs::path path = fs::temp_directory_path() / ("supple_workshop_" + std::to_string(::getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  } folder;
  return folder.path;
}

// ---------------------------------------------------------------------------------------------------------------------
// Tensor files

/// Sound files, the first byte of a script chooses one.
std::vector<Tensors> small_model_files() {
  std::vector<Tensors> files;
  int k = 0;
  for (const Body& body : small_bodies()) {
    const fs::path path = workshop() / "model.supple";
    save_model(path, small_model(body, ++k % 2 == 0 ? 1 : 3));
    files.emplace_back(path);
  }
  return files;
}

std::vector<Tensors> small_trajectory_files() {
  const fs::path model = workshop() / "bar.supple", path = workshop() / "trajectory.safetensors";
  save_model(model, small_model(small_bodies().front(), 3));
  std::vector<Tensors> files;
  for (const bool reduced : {true, false}) {
    save_trajectory(path, small_trajectory(model, reduced));
    files.emplace_back(path);
  }
  return files;
}

std::vector<Tensors> small_pose_files() {
  std::vector<Tensors> files = small_trajectory_files();
  TensorFileWriter poses;
  poses.add("poses", Matrix(Matrix::Constant(6, 4, 0.1)));
  poses.write(workshop() / "poses.safetensors");
  files.emplace_back(workshop() / "poses.safetensors");
  return files;
}

/// Each sound file with no edit, and with some.
std::vector<std::string> scripts(std::size_t num_files) {
  Random random(3);
  std::vector<std::string> all;
  for (std::size_t k = 0; k < num_files; ++k)
    for (int length : {0, 3, 4, 6, 8, 12, 24}) {
      std::string& script = all.emplace_back(1, static_cast<char>(k));
      for (; length > 0; --length) script += static_cast<char>(random.below(256));
    }
  return all;
}

/// Writes what the script makes of one of the files.
fs::path edited(const std::vector<Tensors>& files, const std::string& script, const fs::path& path) {
  Tensors tensors = files[script.empty() ? 0 : static_cast<unsigned char>(script[0]) % files.size()];
  if (!script.empty()) tensors.edit(std::string_view(script).substr(1));
  tensors.write(path);
  return path;
}

void demand_sound(const ReducedModel& model) {
  const auto ascending = [](const std::vector<Index>& values) {
    return std::ranges::adjacent_find(values, std::greater_equal()) == values.end();
  };
  demand(!model.indices.empty() && model.indices.front() >= 0 && ascending(model.indices), "indices out of order");
  demand((model.weights.array() > 0).all() && model.weights.allFinite(), "weights that are not positive");
  demand(model.rest_stiffness.rows() == model.dim() && model.rest_stiffness.allFinite(), "a bad rest stiffness");
  const AnySystem<Matrix> system = model.system();
  const Vector q = Vector::Zero(model.dim());
  demand(system.force(q).allFinite() && std::isfinite(system.energy(q)), "no forces at rest");
}

Answer read_models(const std::string& script, const fs::path& folder) {
  static const std::vector<Tensors> files = small_model_files();
  const fs::path path = edited(files, script, folder / "model.supple");
  return answer_of(path, [&] { demand_sound(load_model(path)); });
}

Answer read_trajectories(const std::string& script, const fs::path& folder) {
  static const std::vector<Tensors> files = small_trajectory_files();
  const fs::path path = edited(files, script, folder / "trajectory.safetensors");
  return answer_of(path, [&] {
    const Trajectory trajectory = load_trajectory(path);
    demand(trajectory.u.allFinite() && trajectory.v.allFinite() && trajectory.time.allFinite(), "numbers not finite");
    demand(trajectory.u.rows() == trajectory.num_frames() && trajectory.v.rows() == trajectory.num_frames() &&
               trajectory.u.cols() == trajectory.v.cols(),
           "frames are missing");
    const ReducedModel model = load_model_of(trajectory, path);
    demand(frame_displacement(trajectory, model, 0).size() == 3 * num_nodes(model.body), "nodes are missing");
  });
}

Answer read_pose_files(const std::string& script, const fs::path& folder) {
  static const std::vector<Tensors> files = small_pose_files();
  static const Points nodes = node_positions(small_bodies().front());
  const fs::path path = edited(files, script, folder / "poses");
  return answer_of(path, [&] {
    const Matrix poses = read_poses(path, nodes);
    demand(poses.cols() > 0 && poses.allFinite(), "poses that are none");
  });
}

std::vector<std::string> tensor_file_seeds() {
  std::vector<std::string> seeds;
  for (const Tensors& files : small_trajectory_files()) {
    files.write(workshop() / "seed");
    seeds.push_back(read_file(workshop() / "seed"));
  }
  TensorFileWriter file;
  file.metadata["naïve"] = "text\n\x1f";
  file.add("a", std::vector<std::uint8_t>{1, 2, 3});
  file.add("none", std::vector<double>{});
  file.write(workshop() / "seed");
  seeds.push_back(read_file(workshop() / "seed"));
  return seeds;
}

/// The layout itself: bytes as they come, and with checksums that fit them.
Answer read_tensor_files(const std::string& bytes, const fs::path& folder) {
  const auto read = [&](const std::string& file) {
    const fs::path path = put(folder / "tensors", file);
    return answer_of(path, [&] {
      (void)answer_of(path, [&] { (void)header_checksum(path); });
      const TensorFile tensors(path);
      int sum = 0;
      for (const auto& [name, tensor] : tensors.tensors()) {
        for (const std::byte b : tensor.bytes) sum += static_cast<int>(b);
        (void)answer_of(path, [&, &array = name] { (void)tensors.matrix(array); });
        (void)answer_of(path, [&, &array = name] { (void)tensors.integers(array); });
      }
      demand(sum >= 0, "no bytes");
      (void)answer_of(path, [&] { (void)load_model(path); });
      (void)answer_of(path, [&] { (void)load_trajectory(path); });
    });
  };
  (void)read(bytes);
  return read(resealed(bytes));
}

// ---------------------------------------------------------------------------------------------------------------------
// Scenes, edits, materials

constexpr const char* scene_seed =
    R"({"description": "pull", "duration": "1.5 s", "step": "5 ms", "gravity": [0, -9.81, 0],
 "pulls": [{"acceleration": [0, 0, 3], "until": 0.2}],
 "forces": [{"nodes": "x>95%", "force": [0, 0, 2.5], "from": 0.5, "until": "700 ms", "ramp": 0.1}, {"node": 3, "force": [1, 0, 0]}],
 "springs": [{"at": [0.5, 0.1, 0], "stiffness": "2 kN/m", "displacement": [0, 0.1, 0], "ramp": 0.2},
  {"node": 5, "stiffness": 4, "target": [1, 2, 3]}, {"nodes": "y<50%", "stiffness": 4,
   "path": [{"time": 0, "displacement": [0, 0, 0]}, {"time": 0.5, "displacement": [0, 0.2, 0]}]}],
 "outside": [{"force": "floor", "axis": "y", "height": -0.2, "stiffness": 2e4, "nodes": "x>=0", "from": 0.1, "until": 2}],
 "damping": {"alpha": 0.2, "beta": 0.001}, "integrator": {"method": "generalized-alpha", "rho_infinity": 0.5},
 "solver": {"method": "bfgs", "tolerance": 1e-6, "max_iterations": 9, "max_halvings": 2}, "output": {"every": 2, "track": [1, 7]}})";
constexpr const char* newmark_seed =
    R"({"integrator": {"method": "newmark", "beta": 0.3, "gamma": 0.6}, "solver": {"method": "warped-bfgs"}, "gravity": ["1 m/s^2", 0, 0]})";

constexpr const char* edit_seed = R"({"description": "bend", "seed": 2, "handles": [{"name": "root", "nodes": "x<5%"},
  {"name": "box", "box": "0.4,-1,-1:2,1,1", "samples": 3, "weight": "2 kN/m"}, {"name": "set", "file": "nodes.txt"},
  {"name": "labels", "file": "labels.txt", "label": 2}],
 "edits": [{"increments": 10, "moves": [{"handle": "box", "axis": [1, 0, 0], "angle": "70 deg", "centre": [0.5, 0.3, 0.6], "translation": [0, 0.1, 0]}]},
  {"moves": [{"handle": "set", "matrix": [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0.5, 0, 0, 0, 1]}, {"handle": "labels", "translation": [0, 1, 0]}]}],
 "solver": {"method": "newton", "tolerance": 1e-6, "max_iterations": 200}})";

constexpr const char* materials_seed =
    R"({"law": "ogden", "young": "2 MPa", "poisson": 0.4, "density": 900, "parameters": {"bulk": 1e7},
 "regions": {"left": {"young": "5 MPa", "density": 1800}, "2": {"poisson": 0.3, "parameters": {"mu3": 0}}}})";

Answer read_scenes(const std::string& bytes, const fs::path& folder) {
  static const Body body = small_bodies().front();
  const fs::path path = put(folder / "scene.json", bytes);
  return answer_of(path, [&] {
    const Scene scene = read_scene(path, body);
    for (const TimedLoads& timed : scene.loads)
      for (const auto& [node, force] : timed.loads.forces)
        demand(node >= 0 && node < num_nodes(body) && force.allFinite(), "a force on no node");
    for (const TimedSprings& timed : scene.springs)
      for (const auto& [node, stiffness] : timed.springs)
        demand(node >= 0 && node < num_nodes(body) && stiffness > 0 && timed.displacement(0.1).allFinite(),
               "a bad spring");
    for (const Index node : scene.track) demand(node >= 0 && node < num_nodes(body), "a node that does not exist");
    demand(!scene.step || *scene.step > 0, "no time step");
  });
}

Answer read_edits(const std::string& bytes, const fs::path& folder) {
  static const Body body = small_bodies().front();
  const fs::path path = put(folder / "edit.json", bytes);
  put(folder / "nodes.txt", "3\n5 # the last\n");
  std::string labels;
  for (Index v = 0; v < num_nodes(body); ++v) labels += v > 4 ? "2\n" : "1\n";
  put(folder / "labels.txt", labels);
  return answer_of(path, [&] {
    const EditScene scene = read_edit_scene(path, body);
    for (const HandleRegion& handle : scene.handles)
      demand(!handle.nodes.empty() && handle.nodes.front() >= 0 && handle.nodes.back() < num_nodes(body),
             "a bad handle");
    for (const Edit& edit : scene.edits)
      for (const auto& [handle, motion] : edit.moves) {
        demand(handle >= 0 && handle < static_cast<Index>(scene.handles.size()), "a handle that does not exist");
        demand(motion(Point(1, 2, 3)).allFinite(), "a motion that is not finite");
      }
    demand(!make_handles(scene, 1, 1).empty(), "no handles");
  });
}

Answer read_materials(const std::string& bytes, const fs::path& folder) {
  static const NamedMesh mesh{std::get<Solid>(small_bodies().front()).mesh, {}};
  const fs::path path = put(folder / "materials.json", bytes);
  return answer_of(path, [&] {
    ProblemOptions problem;
    problem.mesh = "bar:1x1x1";
    problem.materials = path;
    const Body body = load_body(problem, mesh);
    const Solid& solid = std::get<Solid>(body);
    demand(solid.parameters.allFinite() && solid.density.allFinite() && (solid.density.array() > 0).all(),
           "no material");
    for (const std::int32_t row : solid.material_of_cell)
      demand(row >= 0 && row < solid.parameters.rows(), "a material that does not exist");
  });
}

std::function<std::vector<std::string>()> just(std::vector<std::string> seeds) {
  return [seeds] { return seeds; };
}

}  // namespace

std::vector<Target> model_targets() {
  return {{"tensor_files", tensor_file_seeds, read_tensor_files, 1000},
          {"models", just(scripts(4)), read_models, 1000, 1 << 20, false},
          {"trajectories", just(scripts(2)), read_trajectories, 1000, 1 << 20, false},
          {"poses", just(scripts(3)), read_pose_files, 1000, 1 << 20, false},
          {"scenes", just({scene_seed, newmark_seed}), read_scenes},
          {"edits", just({edit_seed}), read_edits},
          {"materials", just({materials_seed}), read_materials}};
}

}  // namespace supple::fuzz

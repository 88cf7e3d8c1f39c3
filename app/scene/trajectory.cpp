#include <app/report/exit_guard.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/trajectory.hpp>
#include <core/tensor_file.hpp>

#include <nlohmann/json.hpp>

#include <charconv>
#include <fstream>

namespace supple {

namespace {

constexpr const char* format_name = "supple trajectory";
constexpr const char* format_version = "1";

Vector reconstruct(const Trajectory& trajectory, const ReducedModel& model, const RowMatrix& frames, Index frame) {
  const Vector coordinates = frames.row(frame).transpose();
  if (!trajectory.reduced) return coordinates;
  return std::visit([&](const auto& subspace) -> Vector { return subspace->reconstruct(coordinates); }, model.subspace);
}

}  // namespace

Vector frame_displacement(const Trajectory& trajectory, const ReducedModel& model, Index frame) {
  return reconstruct(trajectory, model, trajectory.u, frame);
}
Vector frame_velocity(const Trajectory& trajectory, const ReducedModel& model, Index frame) {
  return reconstruct(trajectory, model, trajectory.v, frame);
}

void save_trajectory(const std::filesystem::path& path, const Trajectory& trajectory) {
  TensorFileWriter file;
  file.metadata = {{"format", format_name},
                   {"format_version", format_version},
                   {"model", trajectory.model.string()},
                   {"model_checksum", trajectory.model_checksum},
                   {"step", exact(trajectory.step)},
                   {"steps_per_second", exact(trajectory.steps_per_second)}};
  file.add("time", trajectory.time);
  file.add("kinetic", trajectory.kinetic);
  file.add("elastic", trajectory.elastic);
  file.add("work", trajectory.work);
  if (trajectory.reduced) {
    file.add("q", trajectory.u);
    file.add("q_dot", trajectory.v);
  } else {
    const auto add = [&](const char* name, const RowMatrix& frames) {
      const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> single = frames.cast<float>();
      file.add(name, std::span<const float>(single.data(), static_cast<std::size_t>(single.size())),
               {frames.rows(), frames.cols() / 3, 3});
    };
    add("displacement", trajectory.u);
    add("velocity", trajectory.v);
  }
  const ExitGuard guard;
  file.write(path);
}

Trajectory load_trajectory(const std::filesystem::path& path) {
  if (std::error_code none; std::filesystem::is_directory(path, none)) return load_trajectory(path / trajectory_file);
  const TensorFile file(path);
  const auto fail = [&](const std::string& why) { return InputError(path.string() + ": " + why); };
  if (!file.metadata().contains("format") || file.metadata("format") != format_name)
    throw fail("this is not a trajectory of Supple");
  if (file.metadata("format_version") != format_version)
    throw fail("the trajectory has version " + file.metadata("format_version") + ", expected " + format_version);
  const auto number = [&](const char* key) {
    const std::string& text = file.metadata(key);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      throw fail(std::string(key) + " is '" + text + "', expected a number");
    return value;
  };
  Trajectory trajectory;
  trajectory.model = file.metadata("model");
  trajectory.model_checksum = file.metadata("model_checksum");
  trajectory.step = number("step");
  trajectory.steps_per_second = number("steps_per_second");
  trajectory.time = file.vector("time");
  const Index frames = trajectory.num_frames();
  if (frames == 0) throw fail("there are no frames");
  trajectory.kinetic = file.vector("kinetic", frames);
  trajectory.elastic = file.vector("elastic", frames);
  trajectory.work = file.vector("work", frames);
  trajectory.reduced = file.contains("q");
  if (trajectory.reduced) {
    trajectory.u = file.matrix("q", frames, TensorFile::any);
    trajectory.v = file.matrix("q_dot", frames, trajectory.u.cols());
  } else {
    const auto read = [&](const char* name) -> RowMatrix {
      const auto values = file.values<float>(name, {frames, TensorFile::any, 3});
      using Single = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      return Eigen::Map<const Single>(values.data(), frames, static_cast<Index>(values.size()) / frames).cast<double>();
    };
    trajectory.u = read("displacement");
    trajectory.v = read("velocity");
    if (trajectory.u.cols() != trajectory.v.cols())
      throw fail("displacement and velocity are of different numbers of nodes");
  }
  if (!trajectory.time.allFinite() || !trajectory.u.allFinite() || !trajectory.v.allFinite() ||
      !(trajectory.kinetic + trajectory.elastic + trajectory.work).allFinite())
    throw fail("it holds numbers that are not finite");
  for (Index k = 1; k < frames; ++k)
    if (!(trajectory.time[k] > trajectory.time[k - 1])) throw fail("the times of the frames do not ascend");
  return trajectory;
}

ReducedModel load_model_of(const Trajectory& trajectory, const std::filesystem::path& source) {
  if (std::error_code none; !std::filesystem::exists(trajectory.model, none))
    throw InputError(source.string() + ": its model " + trajectory.model.string() + " is gone");
  const auto checksum = [&] {
    try {
      return header_checksum(trajectory.model);
    } catch (const InputError& error) {
      throw InputError(source.string() + ": its model " + error.what());
    }
  };
  if (checksum() != trajectory.model_checksum)
    throw InputError(source.string() + ": its model " + trajectory.model.string() +
                     " has changed since; run supple simulate again");
  ReducedModel model = load_model(trajectory.model);
  const Index expected = trajectory.reduced ? model.dim() : 3 * num_nodes(model.body);
  if (trajectory.u.cols() != expected)
    throw InputError(source.string() + ": frames have " + std::to_string(trajectory.u.cols()) +
                     " coordinates, expected " + std::to_string(expected));
  return model;
}

std::string header_checksum(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  unsigned char head[8] = {};
  file.read(reinterpret_cast<char*>(head), sizeof head);
  std::uint64_t length = 0;
  for (int k = 8; k-- > 0;) length = length << 8 | head[k];
  std::error_code unknown;
  if (file && length < 100'000'000 && length < std::filesystem::file_size(path, unknown) && !unknown) {
    std::string text(length, ' ');
    file.read(text.data(), static_cast<std::streamsize>(length));
    const nlohmann::json header = nlohmann::json::parse(text, nullptr, false);
    if (file && header.is_object())
      if (const auto metadata = header.find("__metadata__"); metadata != header.end() && metadata->is_object())
        if (const auto sum = metadata->find("supple.xxh3"); sum != metadata->end() && sum->is_string()) return *sum;
  }
  throw InputError(path.string() + ": this is not a model of Supple");
}

}  // namespace supple

#include <app/commands/mesh_source.hpp>
#include <app/commands/option_checks.hpp>
#include <app/commands/shared_options.hpp>
#include <app/commands/view_command.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/coloured_picture.hpp>
#include <app/scene/trajectory.hpp>
#include <core/check.hpp>
#include <core/parallel.hpp>
#include <core/version.hpp>
#include <io/text/index_file.hpp>
#include <physics/body/surface.hpp>
#include <viewer/server/view_server.hpp>
#include <viewer/session/view_model.hpp>

#include <CLI/CLI.hpp>

#include <cstdio>

namespace supple {

namespace {

namespace fs = std::filesystem;

/// The page beside this program: in a tree where it was built, or where it was installed.
std::optional<fs::path> built_page() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  for (const char* place : {"../viewer/page/dist", "../share/supple/viewer"}) {
    const fs::path folder = (program.parent_path() / place).lexically_normal();
    if (fs::exists(folder / "index.html", error)) return folder;
  }
  return {};
}

Resources page_of(const ViewCommand& command) {
  const std::optional<fs::path> folder = command.page ? command.page : built_page();
  if (folder) return read_page(*folder);
  warn(
      "the page was not built: only the session is served. cmake --build BUILD --target viewer_page builds it, or says "
      "what is missing, which is npm or the packages that it fetches; --page names a page built elsewhere");
  return {};
}

/// Tells the terminal and all clients.
Progress progress_to(ViewServer& server) {
  return [&server, bar = progress_bar()](std::string_view stage, double share) {
    tell(bar, stage, share);
    server.progress(stage, share);
  };
}

std::string name_of(const ViewCommand& command) {
  return fs::path(command.mesh).stem().string();
}

/// A mesh with all that reduce() asks for.
struct Problem {
  Body body;
  ReduceOptions options;
};

Problem read_problem(const ViewCommand& command) {
  const NamedMesh named = load_mesh(command.mesh, command.mesh_unit);
  Body body = load_body(command, named);
  ReduceOptions options = reduce_options(command, named, body);
  if (!command.full_loads) options.full_loads = 8;
  if (command.points) options.points = *command.points;
  options.singular = SingularModels::Refuse;
  return {std::move(body), std::move(options)};
}

std::shared_ptr<const ViewModel> reduced(const ViewCommand& command, const Problem& problem, ViewServer& server) {
  const auto& [body, options] = problem;
  ReduceReport report;
  ReducedModel model = reduce(body, options, &report, progress_to(server));
  clear_progress();
  if (const auto note = locking_note(command, body)) report.notes.insert(report.notes.begin(), *note);
  for (const std::string& note : report.notes) warn(note);
  model.provenance = {
      {"version", SUPPLE_VERSION}, {"mesh", command.mesh}, {"full_error", exact(report.full_error.total)}};
  return std::make_shared<const ViewModel>(std::move(model), name_of(command), report.notes);
}

/// A trajectory of the model's mesh, as far as it is drawn.
ViewRecording read_recording(const fs::path& path, const ReducedModel& model) {
  const Trajectory trajectory = load_trajectory(path);
  const ReducedModel own = load_model_of(trajectory, path);
  if (!has_nodes(own.body, node_positions(model.body)))
    throw InputError(path.string() + ": it moves another mesh than the model's");
  const Surface surface(model.body);
  ViewRecording recording{.name = trajectory.reduced ? "reduced" : "full", .time = trajectory.time, .frames = {}};
  recording.frames.resize(trajectory.num_frames(), 3 * static_cast<Index>(surface.nodes.size()));
  for (Index k = 0; k < trajectory.num_frames(); ++k)
    recording.frames.row(k) =
        surface.rows(as_points(frame_displacement(trajectory, own, k))).reshaped<Eigen::RowMajor>().cast<float>();
  return recording;
}

std::shared_ptr<const ViewModel> loaded(const ViewCommand& command) {
  ReducedModel model = load_model(command.mesh);
  std::vector<ViewRecording> recordings;
  for (const auto& path : {command.replay, command.beside})
    if (path) recordings.push_back(read_recording(*path, model));
  if (recordings.size() == 2 && recordings[0].name == recordings[1].name) {
    recordings[0].name = command.replay->filename().string();
    recordings[1].name = command.beside->filename().string();
  }
  try {
    return std::make_shared<const ViewModel>(std::move(model), name_of(command), std::vector<std::string>(),
                                             std::move(recordings));
  } catch (const std::invalid_argument& error) {
    throw InputError(command.replay->string() + ": " + error.what());
  }
}

/// While it lives, a signal takes leave of the server's clients; where one has, it waits for the end of the process.
struct Farewell {
  explicit Farewell(ViewServer& server) {
    on_signal_do([&server] {
      server.close();
      server.wait();
    });
  }
  ~Farewell() { on_signal_do({}); }
  Farewell(const Farewell&) = delete;
  Farewell& operator=(const Farewell&) = delete;
};

}  // namespace

void ViewCommand::run() const {
  set_num_threads(threads);
  const bool has_model = is_model(mesh);
  if (has_model)
    refuse_options_of_meshes(*declared_);
  else if (replay)
    throw InputError("--replay is for models, and " + mesh + " is a mesh");
  // What cannot be served ends this before there is an address.
  const auto model = has_model ? loaded(*this) : nullptr;
  const auto problem = has_model ? std::nullopt : std::optional(read_problem(*this));
  ViewServer server({.address = listen, .port = port, .page = page_of(*this)});
  const Farewell farewell(server);
  std::printf("%s\n", server.url().c_str());
  std::fflush(stdout);
  server.serve(has_model ? model : reduced(*this, *problem, server));
  server.wait();
}

void ViewCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("view", "Simulate and edit in the browser");
  declared_ = &command;
  declare_problem(command, *this);
  command.get_option("MESH")->description(
      "A model that 'supple reduce' made, or what is reduced first: a mesh as there, or a built-in, see below");
  declare_training(command, *this);
  command.add_option("--points", points, "Largest number of components that stand for all [as 'supple reduce' takes]")
      ->type_name("S")
      ->check(whole_number())
      ->group(method_group);
  declare_full_loads(command, *this, /*least=*/0);
  command.add_option("--port", port, "To listen on; 0: a free one")->type_name("N")->capture_default_str();
  command
      .add_option("--listen", listen,
                  "IP address to listen on; any but the loopback interface's asks pages for the token that is printed")
      ->type_name("ADDRESS")
      ->capture_default_str();
  CLI::Option* played =
      command
          .add_option("--replay", replay,
                      "A motion of the model's mesh to play: folder or trajectory of 'supple simulate'")
          ->type_name("RUN");
  command
      .add_option("--beside", beside, "Another, such as the full object's, to play beside it and to compare it with")
      ->type_name("RUN")
      ->needs(played);
  command
      .add_option("--page", page, "Folder of the page's files [the page that was built or installed with the command]")
      ->type_name("DIR");
  declare_threads(command, threads);
  command.footer([] {
    return "Prints the address of the page, and ends with Ctrl-C. On a remote machine: ssh -L 8080:127.0.0.1:8080 "
           "HOST, "
           "and --port 8080.\n\n" +
           material_help() + "\n" + subspace_help() + "\n" + builtin_help() +
           "\nExamples:\n"
           "supple view dragon.supple\n"
           "supple view dragon.supple --port 8080\n"
           "supple view dragon.supple --replay run --beside full-run\n"
           "supple view octopus --fix 'y<4%'";
  });
  command.callback([this] { run(); });
}

}  // namespace supple

#include <viewer/scene/edit_scene_file.hpp>
#include <viewer/server/messages.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace supple {

namespace {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "numbers are sent as they are in memory");

// ---------------------------------------------------------------------------------------------------------------------
// What a client says

std::vector<Index> nodes_of(const JsonFields& fields, const ViewModel& model) {
  const Index n = model.geometry.num_nodes();
  std::vector<Index> nodes = fields.integers("nodes", between(0, static_cast<double>(n - 1)));
  if (static_cast<Index>(nodes.size()) > n)  // what is read here is gone through again
    fields.fail("nodes", "lists " + std::to_string(nodes.size()) + ", of which there are " + std::to_string(n));
  return nodes;
}

Point point_of(const JsonFields& fields, const char* key) {
  return fields.numbers(key, 3);
}

RigidMotion motion_of(const JsonFields& fields) {
  const Vector m = fields.numbers("motion", 12);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topRows<3>() = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(m.data());
  try {
    return RigidMotion::from(matrix, 1e-3);
  } catch (const std::invalid_argument& error) {
    fields.fail("motion", std::string("is refused: ") + error.what());
  }
}

std::optional<std::optional<Floor>> floor_of(const JsonFields& fields) {
  if (!fields.contains("floor")) return {};
  if (fields.is_null("floor")) return std::optional<Floor>();
  const JsonFields floor = fields.object("floor");
  return std::optional(Floor{value_named<FloorAxis>(floor.choice("axis", all_names_of<FloorAxis>()), "axis"),
                             floor.number_or("height", 0)});
}

SettingsChange settings_of(const JsonFields& fields) {
  SettingsChange change;
  if (fields.contains("gravity")) change.gravity = point_of(fields, "gravity");
  if (fields.contains("step")) change.step = fields.number("step", positive);
  if (fields.contains("speed")) change.speed = fields.number("speed", positive);
  if (fields.contains("stiffness")) change.stiffness = fields.number("stiffness", positive);
  if (const auto damping = fields.object_if("damping"))
    change.damping = RayleighDamping{damping->number("mass", non_negative), damping->number("stiffness", non_negative)};
  if (fields.contains("integrator")) change.integrator = Choice::parse(fields.text("integrator"));
  change.floor = floor_of(fields);
  return change;
}

Pull pull_of(const JsonFields& fields) {
  Pull pull{.node = fields.integer("node", non_negative), .target = point_of(fields, "target")};
  if (fields.contains("stiffness")) pull.stiffness = fields.number("stiffness", positive);
  return pull;
}

EditScene scene_of(const JsonFields& fields, const ViewModel& model) {
  const JsonFields scene = fields.object("scene");
  // Before any of them is read: each may name all nodes, and a spring on every node has a dense row for each.
  for (const char* key : {"handles", "forces"})
    if (const std::size_t count = scene.objects_if(key).size(); count > EditSession::most_handles)
      scene.fail(key,
                 "has " + std::to_string(count) + ", expected at most " + std::to_string(EditSession::most_handles));
  for (const char* key : {"springs", "surface", "outside"})
    if (scene.contains(key)) scene.fail(key, "is not taken from clients");
  return read_edit_scene(scene, model.model.body);
}

struct Entry {
  std::string_view name;
  Message (*read)(const JsonFields& fields, const ViewModel& model);
};
/// An action without anything else.
template <typename R>
Message plain(const JsonFields&, const ViewModel&) {
  return Request(R{});
}
using Fields = const JsonFields&;
using Model = const ViewModel&;
const std::array entries{
    Entry{"ack",
          [](Fields fields, Model) -> Message {
            return message::Ack{static_cast<std::uint32_t>(fields.integer("frame", between(0, 0xffffffffu)))};
          }},
    Entry{"stream",
          [](Fields fields, Model) -> Message {
            return message::Stream{value_named<StreamKind>(fields.choice("what", all_names_of<StreamKind>()), "what")};
          }},
    Entry{"save", [](Fields, Model) -> Message { return message::Save{}; }},
    Entry{"play", plain<request::Play>},
    Entry{"pause", plain<request::Pause>},
    Entry{"reset", plain<request::Reset>},
    Entry{"release", plain<request::Release>},
    Entry{"undo", plain<request::Undo>},
    Entry{"redo", plain<request::Redo>},
    Entry{"step",
          [](Fields fields, Model) -> Message {
            return Request(request::Step{fields.integer_or("count", 1, between(1, 1000))});
          }},
    Entry{"mode",
          [](Fields fields, Model) -> Message {
            return Request(
                request::SetMode{value_named<ViewMode>(fields.choice("mode", all_names_of<ViewMode>()), "mode")});
          }},
    Entry{"set", [](Fields fields, Model) -> Message { return Request(request::Set{settings_of(fields)}); }},
    Entry{"pull", [](Fields fields, Model) -> Message { return Request(request::PullAt{pull_of(fields)}); }},
    Entry{"fix", [](Fields fields, Model model) -> Message { return Request(request::Fix{nodes_of(fields, model)}); }},
    Entry{"handle",
          [](Fields fields, Model model) -> Message {
            return Request(request::MakeHandle{nodes_of(fields, model), fields.text_or("name", ""),
                                               fields.flag_or("movable", true)});
          }},
    Entry{"move",
          [](Fields fields, Model) -> Message {
            return Request(
                request::MoveHandle{fields.integer("handle"), motion_of(fields), fields.flag_or("grab", false)});
          }},
    Entry{"remove",
          [](Fields fields, Model) -> Message { return Request(request::RemoveHandle{fields.integer("handle")}); }},
    Entry{"show_mode",
          [](Fields fields, Model) -> Message {
            return Request(request::ShowMode{fields.integer("mode", non_negative),
                                             fields.number_or("amplitude", 0.1, between(0, 1))});
          }},
    Entry{"seek", [](Fields fields, Model) -> Message { return Request(request::Seek{fields.number("time")}); }},
    Entry{"load",
          [](Fields fields, Model model) -> Message { return Request(request::Load{scene_of(fields, model)}); }}};

/// Why a text could not be parsed: a number that no double holds is refused, anything else is no message.
[[noreturn]] void explain(std::string_view text, const InputError& error) {
  try {
    const nlohmann::json parsed = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error&) {
    throw NoMessage(error.what());
  } catch (const nlohmann::json::exception&) {
  }
  throw Refusal("", error.what());
}

// ---------------------------------------------------------------------------------------------------------------------
// What the server says

/// Names may come from files, in any encoding.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json say(const char* what) {
  return {{"say", what}};
}

Json point_json(const Point& p) {
  return {p[0], p[1], p[2]};
}

Json motion_json(const RigidMotion& motion) {
  const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows = motion.matrix().topRows<3>();
  return std::vector<double>(rows.data(), rows.data() + rows.size());
}

/// As a user writes it.
std::string choice_text(const Choice& choice) {
  std::string text = choice.name;
  for (const auto& [name, value] : choice.options) text += ":" + name + "=" + value;
  return text;
}

Json settings_json(const ViewSettings& settings) {
  Json json{{"gravity", point_json(settings.gravity)},
            {"step", settings.step},
            {"speed", settings.speed},
            {"stiffness", settings.stiffness},
            {"damping", {{"mass", settings.damping.alpha}, {"stiffness", settings.damping.beta}}},
            {"integrator", choice_text(settings.integrator)},
            {"floor", nullptr}};
  if (settings.floor) json["floor"] = {{"axis", name_of(settings.floor->axis)}, {"height", settings.floor->height}};
  return json;
}

Json handles_json(const ViewSession& session) {
  Json handles = Json::array();
  const std::vector<Index>& number = session.model().geometry.number;
  for (const EditHandle& handle : session.edit().handles()) {
    Json nodes = Json::array();
    for (const Index v : handle.region->nodes)
      if (number[v] >= 0) nodes.push_back(number[v]);
    handles.push_back({{"id", handle.id},
                       {"name", handle.region->name},
                       {"nodes", std::move(nodes)},
                       {"movable", handle.region->movable},
                       {"motion", motion_json(handle.motion)},
                       {"centre", point_json(handle.centre)}});
  }
  return handles;
}

Json pulls_json(const ViewSession& session) {
  Json pulls = Json::array();
  for (const auto& [client, pull] : session.simulation().pulls())
    pulls.push_back(
        {{"client", client}, {"node", pull.node}, {"target", point_json(pull.target)}, {"stiffness", *pull.stiffness}});
  return pulls;
}

}  // namespace

ReadMessage read_message(std::string_view text, const ViewModel& model) {
  if (text.size() > largest_message) throw NoMessage("a message is larger than 1 MiB");
  std::optional<JsonFields> fields;
  try {
    fields = JsonFields::parse(text, "message");
  } catch (const InputError& error) {
    explain(text, error);
  }
  std::string action;
  try {
    action = fields->text("do");
    const auto entry = std::ranges::find(entries, action, &Entry::name);
    if (entry == entries.end()) fields->fail("do", "is '" + action.substr(0, 60) + "', which is not known");
    Message message = entry->read(*fields, model);
    fields->finish();
    return {std::move(action), std::move(message)};
  } catch (const InputError& error) {
    throw Refusal(action, error.what());
  } catch (const std::invalid_argument& error) {  // of names and choices
    throw Refusal(action, error.what());
  }
}

std::string hello_text(int client, Index num_clients) {
  Json json = say("hello");
  json.update({{"client", client}, {"protocol", protocol_version}, {"clients", num_clients}});
  return text_of(json);
}

std::string ready_text() {
  return text_of(say("ready"));
}

std::string progress_text(std::string_view stage, double share) {
  Json json = say("progress");
  json.update({{"stage", stage}, {"share", share}});
  return text_of(json);
}

std::string refused_text(std::string_view action, std::string_view reason) {
  Json json = say("refused");
  json.update({{"do", action}, {"reason", reason}});
  return text_of(json);
}

std::string warning_text(std::string_view text) {
  Json json = say("warning");
  json["text"] = text;
  return text_of(json);
}

std::string saved_text(const EditScene& scene, const NodePlaces& places) {
  Json json = say("saved");
  json["scene"] = edit_scene_json(scene, places);
  return text_of(json);
}

std::string state_text(const ViewSession& session) {
  Json json = say("state");
  json["mode"] = name_of(session.mode());
  json["playing"] = session.playing();
  json["settings"] = settings_json(session.settings());
  json["handles"] = handles_json(session);
  json["pulls"] = pulls_json(session);
  json["fixed"] = session.simulation().held();
  json["can_undo"] = session.edit().can_undo();
  json["can_redo"] = session.edit().can_redo();
  return text_of(json);
}

std::string frame_bytes(const ViewFrame& frame, std::uint32_t number, StreamKind what, const ViewGeometry& geometry) {
  constexpr std::size_t header = 96;
  std::string bytes(header, '\0');
  const auto put = [&](std::size_t offset, auto value) { std::memcpy(&bytes[offset], &value, sizeof value); };
  const auto real = [&](std::size_t offset, double value) { put(offset, static_cast<float>(value)); };
  const auto count = [&](std::size_t offset, Index value) { put(offset, static_cast<std::uint32_t>(value)); };
  put(4, number);
  put(8, frame.time);
  put(16, frame.kinetic);
  put(24, frame.elastic);
  put(32, frame.potential);
  put(40, frame.made);
  real(48, frame.residual);
  count(52, frame.iterations);
  real(56, 1e6 * frame.seconds);
  real(60, frame.steps_per_second);
  real(64, frame.speed);
  real(68, frame.error);
  count(72, frame.playing | frame.falls_behind << 1 | frame.missed << 2 | frame.beyond_training << 3);
  count(80, frame.num_steps);
  Index num_floats = 0;
  const auto append = [&](const auto& floats) {
    num_floats += floats.size();
    bytes.append(reinterpret_cast<const char*>(floats.data()), static_cast<std::size_t>(floats.size()) * sizeof(float));
  };
  std::uint32_t content = static_cast<std::uint32_t>(what);
  if (!frame.displacements.empty()) {
    content = frame.displacements.size() == 1 ? 2 : 3;
    for (const auto& displacements : frame.displacements) append(displacements);
  } else if (what == StreamKind::Coordinates) {
    append(Eigen::VectorXf(frame.q.cast<float>()));
  } else {
    append(geometry.surface_displacements(frame.q));
  }
  put(0, content);
  count(76, num_floats);
  return bytes;
}

}  // namespace supple

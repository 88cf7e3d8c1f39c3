#pragma once
/// \file Requests that clients make to a session.

#include <reduction/editing/edit_scene.hpp>
#include <viewer/session/settings.hpp>
#include <viewer/session/simulation_session.hpp>

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace supple {

/// What a session shows.
enum class ViewMode { Simulate, Edit, Modes, Replay };
template <>
inline constexpr std::array names_of<ViewMode>{Named{ViewMode::Simulate, "simulate"}, Named{ViewMode::Edit, "edit"},
                                               Named{ViewMode::Modes, "modes"}, Named{ViewMode::Replay, "replay"}};

namespace request {
struct Play {};
struct Pause {};
struct Reset {};  ///< to rest, both simulation and edit; modes and replay: to the beginning
struct Step {     ///< pauses, takes so many steps
  Index count = 1;
};
struct SetMode {
  ViewMode mode = ViewMode::Simulate;
};
struct Set {
  SettingsChange change;
};
struct PullAt {
  Pull pull;
};
struct Release {};
struct Fix {
  std::vector<Index> nodes;  ///< of the ViewGeometry
};
struct MakeHandle {
  std::vector<Index> nodes;  ///< of the ViewGeometry
  std::string name = {};     ///< empty: it gets one
  bool movable = true;
};
struct MoveHandle {
  Index handle = 0;
  RigidMotion motion;
  bool grab = false;  ///< begins a drag
};
struct RemoveHandle {
  Index handle = 0;
};
struct Undo {};
struct Redo {};
struct ShowMode {
  Index mode = 0;          ///< counts the flexible ones
  double amplitude = 0.1;  ///< share of the diagonal, 0 to 1
};
struct Seek {
  double time = 0;  ///< of the recording [s]
};
struct Load {
  EditScene scene;
};
}  // namespace request

using Request =
    std::variant<request::Play, request::Pause, request::Reset, request::Step, request::SetMode, request::Set,
                 request::PullAt, request::Release, request::Fix, request::MakeHandle, request::MoveHandle,
                 request::RemoveHandle, request::Undo, request::Redo, request::ShowMode, request::Seek, request::Load>;

}  // namespace supple

#pragma once
/// \file Messages of each kind, good and bad, for the small clamped bar.

#include <string>
#include <utility>
#include <vector>

namespace supple::test {

inline std::vector<std::string> good_messages() {
  return {R"({"do": "ack", "frame": 1})",
          R"({"do": "stream", "what": "positions"})",
          R"({"do": "play"})",
          R"({"do": "pause"})",
          R"({"do": "reset"})",
          R"({"do": "step", "count": 3})",
          R"({"do": "mode", "mode": "edit"})",
          R"({"do": "mode", "mode": "simulate"})",
          R"({"do": "mode", "mode": "modes"})",
          R"({"do": "mode", "mode": "replay"})",
          R"({"do": "seek", "time": 0.25})",
          R"({"do": "set", "gravity": [0, -9.81, 0], "speed": 0.5})",
          R"({"do": "set", "step": 0.01, "stiffness": 2, "damping": {"mass": 1, "stiffness": 0.001}})",
          R"({"do": "set", "integrator": "newmark:gamma=0.6", "floor": {"axis": "y", "height": -0.2}})",
          R"({"do": "pull", "node": 50, "target": [1, 0.5, 0], "stiffness": 100})",
          R"({"do": "release"})",
          R"({"do": "fix", "nodes": [50, 51, 52]})",
          R"({"do": "handle", "nodes": [50, 51, 52], "name": "hand", "movable": true})",
          R"({"do": "move", "handle": 1, "motion": [1, 0, 0, 0, 0, 1, 0, 0.02, 0, 0, 1, 0], "grab": true})",
          R"({"do": "remove", "handle": 1})",
          R"({"do": "undo"})",
          R"({"do": "redo"})",
          R"({"do": "show_mode", "mode": 2, "amplitude": 0.1})",
          R"({"do": "save"})",
          R"({"do": "load", "scene": {"handles": [{"name": "a", "nodes": "x>90%"}], "edits": [{"moves": []}]}})"};
}

/// And a part of the reason why they are refused, which the message alone tells.
inline std::vector<std::pair<std::string, std::string>> bad_messages() {
  return {{R"([1, 2])", "an object"},
          {R"({})", "/do is missing"},
          {R"({"do": 3})", "/do is 3"},
          {R"({"do": "explode"})", "not known"},
          {R"({"do": "play", "loud": true})", "/loud is not known"},
          {R"({"do": "ack"})", "/frame is missing"},
          {R"({"do": "ack", "frame": -1})", "/frame"},
          {R"({"do": "stream", "what": "video"})", "/what"},
          {R"({"do": "step", "count": 0})", "/count"},
          {R"({"do": "step", "count": 1001})", "/count"},
          {R"({"do": "step", "count": 1.5})", "whole"},
          {R"({"do": "mode", "mode": "sleep"})", "/mode"},
          {R"({"do": "seek"})", "/time is missing"},
          {R"({"do": "load", "scene": {"handles": [{"name": "a", "nodes": "x>90%"}], "springs": [], "edits": []}})",
           "/springs is not taken"},
          {R"({"do": "load", "scene": {"handles": [{"name": "a", "nodes": "x>90%"}], "outside": [], "edits": []}})",
           "/outside is not taken"},
          {R"({"do": "set", "gravity": [0, 1]})", "/gravity"},
          {R"({"do": "set", "gravity": [0, 1, "2"]})", "/gravity/2"},
          {R"({"do": "set", "step": "fast"})", "/step"},
          {R"({"do": "set", "step": 1e999})", "too large"},
          {R"({"do": "set", "colour": 1})", "/colour"},
          {R"({"do": "set", "damping": {"mass": -1, "stiffness": 0}})", "/damping/mass"},
          {R"({"do": "set", "floor": {"axis": "w"}})", "/floor/axis"},
          {R"({"do": "set", "floor": {"axis": "y", "depth": 1}})", "/floor/depth"},
          {R"({"do": "set", "floor": true})", "/floor"},
          {R"({"do": "pull", "node": 3})", "/target is missing"},
          {R"({"do": "pull", "node": 3.5, "target": [0, 0, 0]})", "/node"},
          {R"({"do": "pull", "node": 3, "target": [0, 0, null]})", "/target/2"},
          {R"({"do": "pull", "node": 3, "target": [0, 0, 0], "stiffness": 0})", "/stiffness"},
          {R"({"do": "fix", "nodes": [0, 1e7]})", "/nodes/1"},
          {R"({"do": "fix", "nodes": 7})", "/nodes"},
          {R"({"do": "handle", "nodes": [-1]})", "/nodes/0"},
          {R"({"do": "handle", "nodes": [50], "movable": 1})", "/movable"},
          {R"({"do": "move", "handle": 1, "motion": [1, 2, 3]})", "/motion"},
          {R"({"do": "move", "handle": 1, "motion": [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]})", "no rigid motion"},
          {R"({"do": "move", "handle": 1, "motion": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]})", "no rigid motion"},
          {R"({"do": "show_mode", "mode": -1})", "/mode"},
          {R"({"do": "show_mode", "mode": 0, "amplitude": 3})", "/amplitude"},
          {R"({"do": "load", "scene": {}})", "/scene/handles"},
          {R"({"do": "load", "scene": {"handles": [], "edits": []}})", "/scene/handles"},
          {R"({"do": "load", "scene": {"handles": [{"name": "a", "file": "/etc/passwd"}], "edits": [{"moves": []}]}})",
           "/scene/handles/0/file"},
          {R"({"do": "load", "scene": {"handles": [{"name": "a", "indices": [1000000]}], "edits": [{"moves": []}]}})",
           "/scene/handles/0/indices"}};
}

/// Sound messages that make no sense to a session with one handle, 1, at rest.
inline std::vector<std::string> messages_that_sessions_refuse() {
  return {R"({"do": "ack", "frame": 4000000000})",
          R"({"do": "set", "gravity": [0, 1e9, 0]})",
          R"({"do": "set", "step": 100})",
          R"({"do": "set", "speed": 11, "gravity": [0, 1, 0]})",
          R"({"do": "set", "integrator": "euler"})",
          R"({"do": "set", "integrator": "newmark:gamma=0.1"})",
          R"({"do": "pull", "node": 100000, "target": [0, 0, 0]})",
          R"({"do": "pull", "node": 50, "target": [0, 1e9, 0]})",
          R"({"do": "pull", "node": 50, "target": [0, 0, 0], "stiffness": 1e300})",
          R"({"do": "handle", "nodes": []})",
          R"({"do": "handle", "nodes": [50], "name": "one"})",
          R"({"do": "move", "handle": 7, "motion": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]})",
          R"({"do": "move", "handle": 1, "motion": [1, 0, 0, 1e9, 0, 1, 0, 0, 0, 0, 1, 0]})",
          R"({"do": "remove", "handle": 7})",
          R"({"do": "redo"})",
          R"({"do": "show_mode", "mode": 100000})"};
}

}  // namespace supple::test

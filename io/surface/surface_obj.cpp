#include <io/surface/surface_formats.hpp>

#include <cctype>
#include <charconv>

namespace supple {
namespace {

/// The node of "v", "v/vt", "v/vt/vn" or "v//vn".
std::int64_t node_number(const Cursor& in, std::string_view corner) {
  const std::string_view number = corner.substr(0, corner.find('/'));
  std::int64_t value = 0;
  const auto [rest, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || rest != number.data() + number.size() || value == 0)
    in.fail("expected a corner such as 7, 7/1, 7/1/3 or 7//3, found \"" + std::string(corner.substr(0, 40)) + "\"");
  return value;
}

/// The largest number of a node that had not been seen when a face named it: it may come later.
struct Announced {
  std::int64_t number = 0;
  std::size_t position = 0;
};

void read_face(Cursor& in, FileSurface& surface, Announced& announced) {
  const auto num_nodes = static_cast<std::int64_t>(surface.nodes.size());
  while (true) {
    const std::size_t position = in.position();
    const std::string_view word = in.word_in_line();
    if (word.empty()) break;
    const std::int64_t number = node_number(in, word);
    if (number < -num_nodes)
      in.fail("node " + std::to_string(number) + " does not exist: " + std::to_string(num_nodes) +
              " nodes precede this line");
    if (number > announced.number) announced = {number, position};
    surface.corners.push_back(number < 0 ? num_nodes + number : number - 1);
  }
  surface.end_face();
}

}  // namespace

/// Only v and f lines count; of polylines and points it is told that they are left out.
/// \see Wavefront, "Object Files (.obj)", Advanced Visualizer manual, appendix B1.
void read_obj(Cursor& in, FileSurface& surface) {
  surface.format = "Wavefront OBJ";
  surface.first_number = 1;
  Announced announced;
  while (!in.peek().empty()) {
    const std::string_view keyword = in.word();
    if (keyword == "v") {
      Point x;
      for (double& coordinate : x) coordinate = in.real_in_line("a coordinate");
      surface.nodes.push_back(x);
    } else if (keyword == "f") {
      read_face(in, surface, announced);
    } else if (keyword == "l" || keyword == "p") {
      ++surface.num_lower;
    } else if (keyword == "surf" || keyword == "curv") {
      in.fail("free-form surfaces are not read; save the object as triangles");
    } else if (!std::isalpha(static_cast<unsigned char>(keyword.front()))) {
      in.fail("expected a keyword such as v or f, found \"" + std::string(keyword.substr(0, 40)) + "\"");
    }
    in.rest_of_line();
  }
  if (announced.number > static_cast<std::int64_t>(surface.nodes.size())) {
    in.set_position(announced.position);
    in.word_in_line();
    in.fail("node " + std::to_string(announced.number) + " does not exist: the file has " +
            std::to_string(surface.nodes.size()) + " nodes");
  }
}

}  // namespace supple

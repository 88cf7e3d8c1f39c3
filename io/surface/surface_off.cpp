#include <io/mesh/mesh_formats.hpp>
#include <io/surface/surface_formats.hpp>

namespace supple {

bool is_off_keyword(std::string_view word) {
  for (const std::string_view prefix : {"ST", "C", "N", "4", "n"})
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  return word == "OFF";
}

/// A vertex a line, its position first and what else it has ignored; so, too, behind the corners of a face.
/// \see Geomview manual, "OFF Files".
void read_off(Cursor& in, FileSurface& surface) {
  const std::string_view keyword = in.word();
  surface.format = std::string(keyword) + ", ASCII";
  if (keyword.find_first_of("4n") != std::string_view::npos)
    in.fail("expected points of three dimensions, found " + std::string(keyword));
  if (in.peek() == "BINARY") in.fail("binary OFF is not read; save it as ASCII");
  const Index num_nodes = in.count("vertices", 5), num_faces = in.count("faces", 2);
  in.rest_of_line();  // the number of edges, which nobody needs
  surface.nodes.resize(num_nodes);
  for (Point& x : surface.nodes) {
    x[0] = in.real("a coordinate");
    for (int c = 1; c < 3; ++c) x[c] = in.real_in_line("a coordinate");
    in.rest_of_line();
  }
  for (Index f = 0; f < num_faces; ++f) {
    const Index num_corners = in.count("corners of a face", 2);
    for (Index k = 0; k < num_corners; ++k)
      surface.corners.push_back(node_at(in, in.integer_in_line("a node number"), 0, num_nodes));
    surface.end_face();
    in.rest_of_line();
  }
}

}  // namespace supple

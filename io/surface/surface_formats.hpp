#pragma once
/// \file Readers of the formats behind read_triangle_mesh, one a format: each turns a text into a FileSurface.

#include <io/text/cursor.hpp>
#include <physics/mesh/triangle_mesh.hpp>

#include <span>
#include <string>
#include <vector>

namespace supple {

/// A surface as a file tells it: indices are in range, nothing else is certain.
struct FileSurface {
  std::string format;
  std::vector<Point> nodes;
  std::vector<Index> corners;                        ///< of all faces, one after the other
  std::vector<std::size_t> face_end;                 ///< where the corners of each face end
  std::int64_t first_number = 0;                     ///< of nodes and of faces
  std::string numbering = "numbers as in the file";  ///< what they mean, for messages
  std::vector<std::string> warnings;
  Index num_lower = 0;  ///< lines and points, left out

  Index num_faces() const { return static_cast<Index>(face_end.size()); }
  void end_face() { face_end.push_back(corners.size()); }
  std::span<const Index> face(Index f) const {
    const std::size_t begin = f == 0 ? 0 : face_end[f - 1];
    return {corners.data() + begin, face_end[f] - begin};
  }
};

void read_obj(Cursor& in, FileSurface& surface);
void read_off(Cursor& in, FileSurface& surface);
void read_ply(Cursor& in, FileSurface& surface);
void read_ascii_stl(Cursor& in, FileSurface& surface);
void read_binary_stl(Cursor& in, FileSurface& surface);

/// Whether a file has exactly the size that it announces as binary STL.
bool is_binary_stl(std::string_view bytes);

/// Whether a word begins an OFF file: OFF with any of the prefixes ST, C, N, 4, n.
bool is_off_keyword(std::string_view word);

}  // namespace supple

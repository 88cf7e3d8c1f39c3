#pragma once
/// \file Surface of a mesh, as pictures and ParaView see it.

#include <io/picture/picture.hpp>
#include <physics/body/body.hpp>

#include <filesystem>
#include <vector>

namespace supple {

/// The boundary of a solid, its faces cut into triangles, or a shell itself: triangles over `nodes`, which are indices
/// into the mesh.
struct Surface {
  std::vector<Triangle> triangles;
  std::vector<Index> nodes;

  explicit Surface(const Body& body);
  /// The rows of the surface's nodes.
  Points rows(const Points& all) const;
};

/// An interleaved vector x₀ y₀ z₀ x₁ … over the nodes as n × 3.
inline Eigen::Map<const Points> as_points(const Vector& u) {
  return {u.data(), u.size() / 3, 3};
}

/// Draws and writes objects that are coloured by a length [m], on one scale from 0.
void write_coloured_picture(const std::filesystem::path& path, const std::vector<PictureObject>& objects,
                            const std::string& label, int width, int height);

/// Draws and writes in one go. \see draw_picture
void write_picture(const std::filesystem::path& path, const std::vector<PictureObject>& objects,
                   PictureOptions options = {});

}  // namespace supple

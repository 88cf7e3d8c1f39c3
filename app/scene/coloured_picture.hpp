#pragma once
/// \file Pictures of objects, coloured by a length.

#include <io/picture/picture.hpp>
#include <physics/body/surface.hpp>

#include <filesystem>
#include <vector>

namespace supple {

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

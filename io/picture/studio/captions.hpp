#pragma once
/// \file Captions and colour bar of a picture, and the window that they leave to its objects.

#include <io/picture/picture.hpp>

#include <span>

namespace supple::studio {

/// Distances of the edges of what the objects may fill from the middle of the picture [pixels].
struct Window {
  double left, right, top, bottom;

  double width() const { return left + right; }
  double height() const { return top + bottom; }
};
/// \throws std::invalid_argument if nothing is left.
Window free_window(std::span<const PictureObject> objects, const PictureOptions& options);

/// The objects' captions, and the colour bar if the scale has a label and an object has scalars.
void draw_captions(Image& image, std::span<const PictureObject> objects, const ScalarScale& scale, const View& view);

}  // namespace supple::studio

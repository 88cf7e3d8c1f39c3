#pragma once
/// \file Painter of a picture: from what stands in each pixel, and the light there, to colours.

#include <io/picture/studio/lighting.hpp>
#include <io/picture/studio/scene.hpp>

namespace supple::studio {

/// The scene on its ground and background, without text.
Image paint(const Scene& scene, const Lighting& light, const PictureOptions& options, const View& view);

}  // namespace supple::studio

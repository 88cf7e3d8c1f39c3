#pragma once
/// \file Pictures of deformed objects: a small studio with soft light, a camera that finds its place, and captions.

#include <io/picture/colour.hpp>
#include <io/picture/image.hpp>
#include <physics/mesh/tet_mesh.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace supple {

/// One surface and what is shown on it.
struct PictureObject {
  Points positions;                 ///< n × 3 [m], deformed
  std::vector<Triangle> triangles;  ///< counter-clockwise from outside, as boundary_faces gives them
  Colour colour = rgb(0x8db3da);
  Vector scalar = {};  ///< n values that colour the surface instead, or empty; NaN shows as grey

  std::vector<Index> highlighted = {};  ///< triangles in the colour `highlight`
  Colour highlight = rgb(0xe2572b);
  Points markers = Points(0, 3);  ///< centres of small balls [m]; those inside the object shimmer through
  double marker_radius = 0;       ///< [m]; 0: 1.2 % of the object's diagonal
  double edges = 0;               ///< how dark the triangles' edges are drawn, 0 … 1

  std::string caption = {};
  Points reach = Points(0, 3);  ///< more positions that the view must hold, such as those of the other frames
};

/// Looks at the objects from azimuth and elevation; the distance follows from what has to be seen.
struct Camera {
  double azimuth = 30, elevation = 18;  ///< [deg] around the up axis and above the horizon
  double field_of_view = 22;            ///< [deg] vertical, below 120; 0: orthographic
  Point up = Point::UnitY();            ///< a unit vector
};

enum class Arrangement {
  SideBySide,  ///< from left to right as the camera sees them, in their order
  Together,    ///< each where its positions say
};

/// How scalars become colours; one scale for all objects of the picture.
struct ScalarScale {
  ColourMap map = ColourMap::Sequential;
  std::optional<double> low = {}, high = {};  ///< the objects' own least and largest value unless given
  std::string label = {};                     ///< with unit; if not empty, a colour bar is drawn beside the objects
};

struct PictureOptions {
  int width = 1280, height = 960;  ///< pixels
  int samples = 3;                 ///< along each axis of a pixel: 1 to see quickly, 3 for print
  Camera camera = {};
  Arrangement arrangement = Arrangement::SideBySide;
  ScalarScale scale = {};
  bool ground = true;  ///< a floor under the lowest point, seen by the shadows it takes
};

/// Where the camera and the objects stand: computed once, it holds still over a sequence of pictures.
struct View {
  Point eye, right, up, forward;  ///< camera [m]; the axes are unit vectors
  double pixels = 0;              ///< per metre, in perspective at distance 1 m
  bool perspective = true;
  std::vector<Point> offsets;     ///< added to the positions of each object
  std::vector<double> caption_x;  ///< where each caption is centred [pixels]
  Point ground_up, centre;        ///< normal of the ground; centre of what is lit
  double ground_height = 0;       ///< along ground_up
  double radius = 1;              ///< of what is lit and casts shadows
  double scalar_low = 0, scalar_high = 1;
};

/// The closest view that holds all positions, reaches, captions and the colour bar.
/// \throws std::invalid_argument if there is no object with a triangle, an index is out of range, a number is
/// not finite or not in its range, or the scalars do not fit the positions.
View fit_view(std::span<const PictureObject> objects, const PictureOptions& options = {});

/// Draws the objects as the view says. Triangles count from both sides; edges sharper than 50° stay sharp.
/// The image does not depend on the number of threads.
/// \throws std::invalid_argument as fit_view, and if the view is of another number of objects.
/// \note O((triangles + pixels) · lamps): 1 s of processor time for 35 000 triangles in 1280 × 960 pixels.
Image draw_picture(std::span<const PictureObject> objects, const PictureOptions& options, const View& view);
inline Image draw_picture(std::span<const PictureObject> objects, const PictureOptions& options = {}) {
  return draw_picture(objects, options, fit_view(objects, options));
}

}  // namespace supple

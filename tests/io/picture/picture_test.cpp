#include <core/check.hpp>
#include <core/parallel.hpp>
#include <io/picture/picture.hpp>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace supple {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

PictureObject quad(const Point& corner, const Point& a, const Point& b) {
  PictureObject object;
  object.positions.resize(4, 3);
  object.positions << corner.transpose(), (corner + a).transpose(), (corner + a + b).transpose(),
      (corner + b).transpose();
  object.triangles = {{0, 1, 2}, {0, 2, 3}};
  return object;
}

PictureObject box(const Point& lower, const Point& size) {
  PictureObject object;
  object.positions.resize(8, 3);
  for (Index v = 0; v < 8; ++v)
    object.positions.row(v) = (lower + Point(v & 1, (v >> 1) & 1, (v >> 2) & 1).cwiseProduct(size)).transpose();
  object.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return object;
}

/// An octahedron refined onto the sphere.
PictureObject ball(const Point& centre, double radius, int refinements = 4) {
  std::vector<Point> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Triangle> triangles{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int k = 0; k < refinements; ++k) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [entry, added] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(points.size()));
      if (added) points.push_back((points[a] + points[b]).normalized());
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  PictureObject object;
  object.triangles = triangles;
  object.positions.resize(static_cast<Index>(points.size()), 3);
  for (Index v = 0; v < object.positions.rows(); ++v)
    object.positions.row(v) = (centre + radius * points[v]).transpose();
  return object;
}

PictureOptions small(bool ground = false) {
  PictureOptions options;
  options.width = 240, options.height = 180, options.samples = 2;
  options.ground = ground;
  return options;
}

Image draw(const PictureObject& object, const PictureOptions& options) {
  return draw_picture({&object, 1}, options);
}

/// Where a point shows in the picture [pixels].
Eigen::Vector2d project(const View& view, const PictureOptions& options, const Point& p) {
  const Point q = p - view.eye;
  const double scale = view.perspective ? view.pixels / q.dot(view.forward) : view.pixels;
  return {options.width / 2.0 + scale * q.dot(view.right), options.height / 2.0 - scale * q.dot(view.up)};
}

double brightness(const Colour& c) {
  return (c.r + c.g + c.b) / 3;
}
double difference(const Colour& a, const Colour& b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}
Colour at(const Image& image, const Eigen::Vector2d& pixel) {
  return image.at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
}

TEST(FitView, HoldsEverythingAndComesAsCloseAsPossible) {
  for (const double fov : {0.0, 15.0, 60.0})
    for (const double azimuth : {0.0, 70.0, 200.0})
      for (const double elevation : {-30.0, 0.0, 25.0, 90.0}) {
        PictureOptions options = small();
        options.camera = {.azimuth = azimuth, .elevation = elevation, .field_of_view = fov, .up = Point::UnitZ()};
        const PictureObject object = box({5, -3, 100}, {3, 1, 2});
        const View view = fit_view({&object, 1}, options);
        Eigen::AlignedBox2d seen;
        for (const auto& p : object.positions.rowwise()) seen.extend(project(view, options, p.transpose()));
        const double margin = 0.05 * options.height;
        EXPECT_GE(seen.min().x(), margin - 1e-6);
        EXPECT_GE(seen.min().y(), margin - 1e-6);
        EXPECT_LE(seen.max().x(), options.width - margin + 1e-6);
        EXPECT_LE(seen.max().y(), options.height - margin + 1e-6);
        const Eigen::Vector2d free(options.width - 2 * margin, options.height - 2 * margin);
        EXPECT_NEAR((seen.sizes().array() / free.array()).maxCoeff(), 1, 1e-9)
            << fov << " " << azimuth << " " << elevation;
      }
}

TEST(FitView, AzimuthTurnsAroundTheUpAxis) {
  const PictureObject object = box({0, 0, 0}, {1, 1, 1});
  PictureOptions options = small();
  options.camera = {.azimuth = 0, .elevation = 0, .field_of_view = 20, .up = Point::UnitY()};
  EXPECT_LT((fit_view({&object, 1}, options).forward + Point::UnitZ()).norm(), 1e-12);
  EXPECT_LT((fit_view({&object, 1}, options).right - Point::UnitX()).norm(), 1e-12);
  options.camera.azimuth = 90;
  EXPECT_LT((fit_view({&object, 1}, options).forward + Point::UnitX()).norm(), 1e-12);
  options.camera.up = Point::UnitZ();
  options.camera.azimuth = 0;
  EXPECT_LT((fit_view({&object, 1}, options).forward + Point::UnitX()).norm(), 1e-12);
  options.camera.elevation = 90;
  EXPECT_LT((fit_view({&object, 1}, options).forward + Point::UnitZ()).norm(), 1e-12);
}

TEST(FitView, ReachKeepsRoomForOtherFrames) {
  PictureObject object = box({0, 0, 0}, {1, 1, 1});
  object.reach.resize(1, 3);
  object.reach << 0.5, 9, 0.5;
  const View view = fit_view({&object, 1}, small());
  const Eigen::Vector2d far = project(view, small(), {0.5, 9, 0.5});
  EXPECT_GE(far.y(), 8);
  EXPECT_NEAR(far.y(), 9, 0.01);
}

TEST(FitView, ObjectsSideBySideDoNotOverlapAndKeepTheirOrder) {
  std::vector<PictureObject> objects{box({0, 0, 0}, {3, 1, 1}), box({0, 0, 0}, {1, 1, 1}), box({-7, 0, 0}, {2, 1, 1})};
  const PictureOptions options = small();
  const View view = fit_view(objects, options);
  double last = 0;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    Eigen::AlignedBox2d seen;
    for (const auto& p : objects[k].positions.rowwise())
      seen.extend(project(view, options, p.transpose() + view.offsets[k]));
    EXPECT_GT(seen.min().x(), last);
    EXPECT_GT(view.caption_x[k], seen.min().x());
    EXPECT_LT(view.caption_x[k], seen.max().x());
    last = seen.max().x();
  }
  PictureOptions together = options;
  together.arrangement = Arrangement::Together;
  for (const Point& offset : fit_view(objects, together).offsets) EXPECT_EQ(offset, Point::Zero());
}

TEST(DrawPicture, ABallCoversTheAreaOfItsDisc) {
  PictureOptions options = small();
  options.camera.field_of_view = 0;
  options.samples = 4;
  const Image image = draw(ball({3, 2, 1}, 0.1, 5), options);
  int covered = 0;
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x)  // at the left there is only background, the same along a row
      covered += difference(image.at(x, y), image.at(0, y)) > 0.02;
  // The diameter is the height without margins; partly covered pixels count wholly, so a quarter of a pixel
  // more.
  const double radius = 0.45 * options.height + 0.25;
  EXPECT_NEAR(covered, std::numbers::pi * radius * radius, 0.01 * covered);
}

TEST(DrawPicture, TheNearerSurfaceHidesTheFarther) {
  PictureObject back = quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), front = quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0});
  back.colour = rgb(0x3050ff);
  front.colour = rgb(0xff3020);
  PictureOptions options = small();
  options.arrangement = Arrangement::Together;
  options.camera.azimuth = 0, options.camera.elevation = 0;
  for (const bool swapped : {false, true}) {
    const std::vector<PictureObject> objects = swapped ? std::vector{front, back} : std::vector{back, front};
    const View view = fit_view(objects, options);
    const Image image = draw_picture(objects, options, view);
    const Colour middle = at(image, project(view, options, {0, 0, 1})),
                 side = at(image, project(view, options, {1.7, 1.7, 0}));
    EXPECT_GT(middle.r, 1.5 * middle.b);
    EXPECT_GT(side.b, 1.5 * side.r);
  }
}

TEST(DrawPicture, ScalarsAreInterpolatedInSpaceNotOnTheScreen) {
  // A long strip seen at a low angle: its middle shows far above the middle of its picture.
  PictureObject strip = quad({-1, 0, 10}, {2, 0, 0}, {0, 0, -20});
  strip.scalar.resize(4);
  strip.scalar << 0, 0, 1, 1;
  PictureOptions options = small();
  options.camera = {.azimuth = 0, .elevation = 15, .field_of_view = 60, .up = Point::UnitY()};
  options.scale.map = ColourMap::Diverging;
  options.scale.low = 0, options.scale.high = 1;
  const View view = fit_view({&strip, 1}, options);
  const Image image = draw_picture({&strip, 1}, options, view);
  const auto redness = [&](double z) {
    const Colour c = at(image, project(view, options, {0, 0, z}));
    return c.r - c.b;
  };
  EXPECT_NEAR(redness(0), 0, 0.05);  // neutral where the scalar is one half
  EXPECT_GT(redness(-5), 0.1);
  EXPECT_LT(redness(5), -0.1);
}

TEST(DrawPicture, HighlightedTrianglesAndNotANumberHaveTheirColours) {
  PictureObject wall = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  PictureOptions options = small();
  options.camera.azimuth = 0, options.camera.elevation = 0;
  wall.highlighted = {1};
  const View view = fit_view({&wall, 1}, options);
  Image image = draw_picture({&wall, 1}, options, view);
  const auto lower = project(view, options, {0.8, 0.2, 0}), upper = project(view, options, {0.2, 0.8, 0});
  EXPECT_GT(at(image, lower).b, at(image, lower).r);
  EXPECT_GT(at(image, upper).r, 1.5 * at(image, upper).b);
  wall.highlighted.clear();
  wall.scalar = Vector::Constant(4, std::nan(""));
  image = draw_picture({&wall, 1}, options, view);
  EXPECT_NEAR(at(image, lower).r, at(image, lower).b, 0.05);
}

TEST(DrawPicture, MarkersInsideShimmerThrough) {
  PictureObject cube = box({0, 0, 0}, {1, 1, 1});
  const PictureOptions options = small();
  const View view = fit_view({&cube, 1}, options);
  const Image plain = draw_picture({&cube, 1}, options, view);
  cube.markers.resize(2, 3);
  cube.markers << 0.5, 0.5, 0.5, 0.5, 0.5, 1;
  cube.marker_radius = 0.08;
  const Image marked = draw_picture({&cube, 1}, options, view);
  const auto inside = project(view, options, {0.5, 0.5, 0.5}), outside = project(view, options, {0.5, 0.5, 1});
  const double hidden = at(marked, inside).r - at(plain, inside).r, open = at(marked, outside).r - at(plain, outside).r;
  EXPECT_GT(at(marked, inside).r - at(marked, inside).b, at(plain, inside).r - at(plain, inside).b + 0.1);
  EXPECT_GT(open, hidden);
  const auto beside = project(view, options, {0.5, 0.8, 1});
  EXPECT_EQ(at(marked, beside), at(plain, beside));
}

TEST(DrawPicture, EdgesDarkenTheSurfaceAlongTriangles) {
  PictureObject wall = quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  PictureOptions options = small();
  options.camera.azimuth = 0, options.camera.elevation = 0;
  const View view = fit_view({&wall, 1}, options);
  const Image plain = draw_picture({&wall, 1}, options, view);
  wall.edges = 0.8;
  const Image lined = draw_picture({&wall, 1}, options, view);
  const auto diagonal = project(view, options, {0.5, 0.5, 0}), middle = project(view, options, {0.7, 0.3, 0});
  double darkest = 1;
  for (const double side : {-1.0, 0.0, 1.0})
    darkest = std::min(darkest, brightness(at(lined, diagonal + Eigen::Vector2d(side, 0))));
  EXPECT_LT(darkest, 0.8 * brightness(at(plain, diagonal)));
  EXPECT_EQ(at(lined, middle), at(plain, middle));
}

TEST(DrawPicture, SharpEdgesStaySharpAndRoundOnesSmooth) {
  const PictureOptions options = small();
  const PictureObject cube = box({0, 0, 0}, {1, 1, 1});
  const View view = fit_view({&cube, 1}, options);
  const Image image = draw_picture({&cube, 1}, options, view);
  // Two points of one face, near to and far from the edge, look alike; the other face does not.
  const Colour near_edge = at(image, project(view, options, {0.95, 0.5, 1})),
               same_face = at(image, project(view, options, {0.4, 0.5, 1})),
               other_face = at(image, project(view, options, {1, 0.5, 0.9}));
  EXPECT_LT(difference(near_edge, same_face), 0.06);
  EXPECT_GT(difference(near_edge, other_face), 0.12);

  const PictureObject round = ball({0, 0, 0}, 1, 3);
  const Image disc = draw(round, options);
  double largest = 0;  // step between neighbouring pixels inside
  for (int x = 75; x < 165; ++x) largest = std::max(largest, difference(disc.at(x, 90), disc.at(x + 1, 90)));
  EXPECT_LT(largest, 0.03);
}

TEST(DrawPicture, TheGroundTakesASoftShadow) {
  const PictureObject object = ball({0, 1.5, 0}, 1);
  PictureObject table = object;
  table.reach.resize(1, 3);
  table.reach << 0, 0, 0;  // the ground is where something reaches
  const PictureOptions with = small(true), without = small(false);
  const View view = fit_view({&table, 1}, with);
  EXPECT_NEAR(view.ground_height, 0, 1e-12);
  const Image shadow = draw_picture({&table, 1}, with, view), none = draw_picture({&table, 1}, without, view);
  double darkest = 0, farthest = 0;
  for (int x = 0; x < with.width; ++x)
    for (int y = 0; y < with.height; ++y) {
      const double darker = brightness(none.at(x, y)) - brightness(shadow.at(x, y));
      EXPECT_GE(darker, -1e-9);
      darkest = std::max(darkest, darker);
      if (y < with.height / 4) farthest = std::max(farthest, darker);
    }
  EXPECT_GT(darkest, 0.15);
  EXPECT_LT(farthest, 0.03);
}

TEST(DrawPicture, WhatIsCoveredIsDarker) {
  // A roof over half of a floor.
  const std::vector<PictureObject> open{quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4})};
  std::vector<PictureObject> covered = open;
  covered.push_back(quad({-2, 0.6, 0.2}, {2, 0, 0}, {0, 0, -2.2}));
  PictureOptions options = small();
  options.arrangement = Arrangement::Together;
  options.camera.elevation = 12, options.camera.azimuth = 0;
  const View view = fit_view(covered, options);
  View alone = view;
  alone.offsets.resize(1), alone.caption_x.resize(1);
  const Image light = draw_picture(open, options, alone), dark = draw_picture(covered, options, view);
  const auto under = project(view, options, {-1, 0, -0.3}), beside = project(view, options, {1.8, 0, 1.8});
  EXPECT_LT(brightness(at(dark, under)), 0.75 * brightness(at(light, under)));
  EXPECT_NEAR(brightness(at(dark, beside)), brightness(at(light, beside)), 0.06);
}

TEST(DrawPicture, BothSidesAndBothWindingsLookAlike) {
  PictureObject object = ball({0, 0, 0}, 1);
  const Image outward = draw(object, small());
  for (Triangle& triangle : object.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_EQ(draw(object, small()).pixels, outward.pixels);
}

TEST(DrawPicture, DoesNotDependOnTheNumberOfThreads) {
  std::vector<PictureObject> objects{ball({0, 0, 0}, 1), box({0, 0, 0}, {1, 2, 1})};
  objects[0].scalar = objects[0].positions.col(1);
  set_num_threads(1);
  const Image one = draw_picture(objects, small(true));
  set_num_threads(3);
  const Image three = draw_picture(objects, small(true));
  set_num_threads(0);
  EXPECT_EQ(one.pixels, three.pixels);
}

TEST(DrawPicture, AKeptViewHoldsStill) {
  std::vector<PictureObject> objects{box({0, 0, 0}, {1, 1, 1}), ball({0, 0, 0}, 0.5)};
  const PictureOptions options = small();
  const View view = fit_view(objects, options);
  const Image before = draw_picture(objects, options, view);
  objects[1].positions.col(1).array() += 0.2;
  const Image after = draw_picture(objects, options, view);
  const auto corner = project(view, options, Point(0.5, 0.9, 1) + view.offsets[0]);
  EXPECT_LT(difference(at(before, corner), at(after, corner)), 0.02);
  EXPECT_NE(before.pixels, after.pixels);
}

TEST(DrawPicture, CaptionsAndColourBarStandInTheFreeMargins) {
  std::vector<PictureObject> objects{box({0, 0, 0}, {1, 1, 1}), box({0, 0, 0}, {1, 1, 1})};
  objects[0].scalar = objects[0].positions.col(0);
  PictureOptions options = small();
  const Image plain = draw_picture(objects, options);
  objects[1].caption = "right";
  options.scale.label = "x [m]";
  const View view = fit_view(objects, options);
  const Image image = draw_picture(objects, options, view);
  const auto ink = [&](int x0, int x1, int y0, int y1) {
    int count = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) count += brightness(image.at(x, y)) < 0.6;
    return count;
  };
  const int x = static_cast<int>(view.caption_x[1]);
  EXPECT_GT(ink(x - 12, x + 12, 165, 180), 10);
  const int other = static_cast<int>(view.caption_x[0]);
  EXPECT_EQ(ink(other - 12, other + 12, 165, 180), 0);
  EXPECT_GT(ink(205, 240, 30, 150), 100);  // the bar, its dark end at least, and its numbers
  const Colour top = image.at(213, 52), bottom = image.at(213, 128);
  EXPECT_GT(brightness(top), brightness(bottom) + 0.2);
}

TEST(DrawPicture, DegenerateAndFarAwayObjectsAreHarmless) {
  PictureObject point;
  point.positions = Points::Ones(3, 3);
  point.triangles = {{0, 1, 2}};
  EXPECT_EQ(draw(point, small(true)).width, 240);
  PictureObject far = box({1e7, 1e7, 1e7}, {1, 1, 1});
  const PictureObject near_by = box({0, 0, 0}, {1, 1, 1});
  EXPECT_LT(difference(draw(far, small()).at(120, 90), draw(near_by, small()).at(120, 90)), 0.02);
  // Frames that leave the view, even behind the camera.
  const View view = fit_view({&near_by, 1}, small());
  for (const double where : {1e3, -1e3, 30.0}) {
    PictureObject gone = near_by;
    gone.positions.array() += where;
    draw_picture({&gone, 1}, small(true), view);
  }
}

TEST(DrawPicture, NamesWhatIsWrong) {
  const auto refuse = [](const PictureObject& object, const PictureOptions& options, const std::string& reason) {
    EXPECT_THAT([&] { draw(object, options); }, ThrowsMessage<std::invalid_argument>(HasSubstr(reason)));
  };
  const PictureObject good = box({0, 0, 0}, {1, 1, 1});
  PictureObject wrong = good;
  wrong.triangles.push_back({0, 1, 8});
  refuse(wrong, small(), "has a triangle with node 8 of 8");
  wrong = good;
  wrong.scalar = Vector::Zero(7);
  refuse(wrong, small(), "scalar of object 0 of a picture has size 7, expected 8");
  wrong = good;
  wrong.highlighted = {12};
  refuse(wrong, small(), "highlights triangle 12 of 12");
  wrong = good;
  wrong.positions(2, 1) = std::nan("");
  refuse(wrong, small(), "position that is not finite");
  wrong = good;
  wrong.triangles.clear();
  refuse(wrong, small(), "no triangle");
  PictureOptions options = small();
  options.samples = 9;
  refuse(good, options, "samples of a picture is 9");
  options = small();
  options.width = 0;
  refuse(good, options, "width of a picture is 0");
  options = small();
  options.camera.up = {1, 1, 0};
  refuse(good, options, "not a unit vector");
  View view = fit_view({&good, 1}, small());
  view.offsets.clear();
  EXPECT_THROW(draw_picture({&good, 1}, small(), view), std::invalid_argument);
}

}  // namespace
}  // namespace supple

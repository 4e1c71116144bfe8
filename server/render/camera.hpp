// Where a picture is looked at from, and the line of sight of each of its points.
#pragma once
#include <cstdint>

#include "store/grid/vec3.hpp"

namespace teracell::server {

struct PictureSize {
  uint32_t width = 1280, height = 960;  // pixels
};

// A line of sight: the points from + t * along, t >= 0. t is the distance from the camera's plane.
struct Sight {
  Vec3 from, along;
};

// Lengths are those of the grid. `right`, `up` and `forward` have length 1 and are at right angles to each other.
struct Camera {
  bool perspective = true;
  int sky = 2;  // the axis that light falls along
  Vec3 from{}, right{}, up{}, forward{};
  PictureSize size;
  double pixel = 1;  // the side of a pixel: at distance 1, or, without perspective, everywhere

  // Of the point (x, y) of the picture, in pixels from its upper left corner. Pixel (i, j) has its centre at (i + 0.5, j + 0.5).
  Sight sight(double x, double y) const;
  // What is drawn is at most this large where the choice is free.
  double finest_at(double t) const { return pixel_at(t) / 4; }
  double pixel_at(double t) const { return perspective ? pixel * t : pixel; }
};

// `fov`: degrees, from the lower to the upper side of the picture. Throws UsageError unless `from` and `at` differ, and 0 < fov < 180.
// Where the view is along `up`, another axis is up.
Camera perspective_camera(const Vec3& from, const Vec3& at, int up, double fov, PictureSize size);
// The middle of a box of cells, and an eye (1, -1.4, 0.9) times its diagonal away from it: at 30 degrees all of the box is in the picture.
struct DefaultView {
  Vec3 from, at;
};
DefaultView default_view(const Grid& grid, const Box& cells);
// Looks along +axis or -axis, without perspective. The grid is as large as it can be with all of it in the picture. Where the view is along `up`,
// another axis is up: y in place of z, and z in place of the others.
Camera axis_camera(const Grid& grid, int axis, bool positive, int up, PictureSize size);

// (0, 0, 0) stays as it is.
Vec3 normalised(const Vec3& a);

}  // namespace teracell::server

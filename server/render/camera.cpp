#include "server/render/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::server {
namespace {

Vec3 unit(int axis) {
  Vec3 out{};
  out[axis] = 1;
  return out;
}

// Vectors at right angles, as near to `up` as can be.
void turn(Camera& camera, const Vec3& forward, int up) {
  camera.forward = forward;
  camera.sky = up;
  const double steepest = 1 - 1e-12;
  if (std::abs(forward[up]) >= steepest) up = up == 2 ? 1 : 2;
  camera.right = normalised(cross(forward, unit(up)));
  camera.up = cross(camera.right, forward);
}

double length(const Axis& axis) { return axis.max() - axis.min(); }
double middle(const Axis& axis) { return axis.min() + length(axis) / 2; }

}  // namespace

Vec3 normalised(const Vec3& a) {
  const double largest = std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
  if (largest == 0) return a;
  const Vec3 scaled = a * (1 / largest);  // squares of what is very small or large are not finite
  return scaled * (1 / std::sqrt(dot(scaled, scaled)));
}

Sight Camera::sight(double x, double y) const {
  const double along_right = (x - size.width / 2.0) * pixel, along_up = (size.height / 2.0 - y) * pixel;
  if (perspective) return {from, forward + right * along_right + up * along_up};
  return {from + right * along_right + up * along_up, forward};
}

Camera perspective_camera(const Vec3& from, const Vec3& at, int up, double fov, PictureSize size) {
  if (!(fov > 0 && fov < 180)) throw UsageError(fmt::format("--fov: expected more than 0 and less than 180 degrees, found {}", fov));
  const Vec3 forward = normalised(at - from);
  if (dot(forward, forward) == 0)
    throw UsageError(fmt::format("--from, --at: expected two points, found ({}, {}, {}) twice", from[0], from[1], from[2]));
  Camera camera{.perspective = true, .from = from, .size = size};
  // In long doubles, so that the double is the same with any library's tangent.
  camera.pixel = 2 * static_cast<double>(std::tan(static_cast<long double>(fov / 2 * std::numbers::pi / 180))) / size.height;
  turn(camera, forward, up);
  return camera;
}

DefaultView default_view(const Grid& grid, const Box& cells) {
  Vec3 extent, centre;
  for (int d = 0; d < 3; ++d) {
    const double lo = grid.axis[d].plane(cells.lo[d]);
    extent[d] = grid.axis[d].plane(cells.hi[d]) - lo;
    centre[d] = lo + extent[d] / 2;
  }
  return {centre + Vec3{1, -1.4, 0.9} * norm(extent), centre};
}

Camera axis_camera(const Grid& grid, int axis, bool positive, int up, PictureSize size) {
  Camera camera{.perspective = false, .size = size};
  turn(camera, unit(axis) * (positive ? 1 : -1), up);
  for (int d = 0; d < 3; ++d) camera.from[d] = middle(grid.axis[d]);
  camera.from[axis] = positive ? grid.axis[axis].min() : grid.axis[axis].max();
  double width = 0, height = 0;
  for (int d = 0; d < 3; ++d) width += std::abs(camera.right[d]) * length(grid.axis[d]), height += std::abs(camera.up[d]) * length(grid.axis[d]);
  camera.pixel = std::max(width / size.width, height / size.height);
  return camera;
}

}  // namespace teracell::server

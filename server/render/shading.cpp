#include "server/render/shading.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace teracell::server {
namespace {

double step_from(double lo, double hi, double x) {
  const double t = std::clamp((x - lo) / (hi - lo), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

double Shading::cell_at(const Vec3& point, double t) const {
  double sum = 0;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = grid_.axis[d];
    const int64_t cell = axis.is_graded() ? axis.cell_at(std::clamp(point[d], axis.min(), axis.max())) : 0;
    sum += axis.is_graded() ? axis.plane(cell + 1) - axis.plane(cell) : axis.step();
  }
  const double cell = std::ldexp(sum / 3, level_.value_or(0));
  return level_ ? cell : std::max(cell, camera_.finest_at(t));
}

Vec3 Shading::face_normal(const Sight& sight, int face) const {
  if (face < 0) return normalised(sight.along * -1);
  if (face >= 3) return normalised(plane_of(cuts_, face - 3).normal);
  Vec3 out{};
  out[face] = sight.along[face] > 0 ? -1 : 1;
  return out;
}

// A plane through the hits around: `linear(t)` is linear in x and y on it. Two rounds: the first takes for each direction the side that rises
// less, the second fits a plane to what is near that of the first. Cells much larger than a pixel keep their faces.
Vec3 Shading::normal(const Samples& samples, int64_t x, int64_t y) const {
  const Sample& here = samples.at(x, y);
  const Sight sight = camera_.sight(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
  const Vec3 face = face_normal(sight, here.face), point = sight.from + sight.along * here.t;
  const double cell = cell_at(point, here.t), pixels = cell / camera_.pixel_at(here.t), blocks = step_from(8, 16, pixels);
  if (blocks >= 1 || here.face >= 3) return face;
  const int64_t stride = std::clamp<int64_t>(std::llround(pixels * 0.7), 1, kReach / 2);
  const double q = linear(here.t);
  const double noise = 1.5 * std::abs(linear(here.t + cell) - q);
  const auto slope = [&](int64_t dx, int64_t dy) {
    double best = std::numeric_limits<double>::infinity();
    for (const int64_t sign : {-1, 1})
      for (const int64_t far : {stride, 2 * stride}) {
        const int64_t at_x = x + sign * far * dx, at_y = y + sign * far * dy;
        if (!samples.has(at_x, at_y) || !samples.at(at_x, at_y).shown()) break;
        const double s = (linear(samples.at(at_x, at_y).t) - q) / static_cast<double>(sign * far);
        if (std::abs(s) < std::abs(best)) best = s;
      }
    return std::isfinite(best) ? best : 0;
  };
  double b = slope(1, 0), c = slope(0, 1);
  for (int round = 0; round < 2; ++round) {
    const double tolerance = noise + 0.5 * (std::abs(b) + std::abs(c)) * static_cast<double>(stride);
    double n = 0, sx = 0, sy = 0, sq = 0, xx = 0, xy = 0, yy = 0, xq = 0, yq = 0;
    for (int64_t dy = -2 * stride; dy <= 2 * stride; dy += stride)
      for (int64_t dx = -2 * stride; dx <= 2 * stride; dx += stride) {
        if (!samples.has(x + dx, y + dy)) continue;
        const Sample& s = samples.at(x + dx, y + dy);
        if (!s.shown()) continue;
        const auto fx = static_cast<double>(dx), fy = static_cast<double>(dy);
        const double rise = linear(s.t) - q, off = (rise - b * fx - c * fy) / (2 * tolerance);
        if (std::abs(off) >= 1) continue;
        const double w = (1 - off * off) * (1 - off * off);
        n += w, sx += w * fx, sy += w * fy, sq += w * rise, xx += w * fx * fx, xy += w * fx * fy, yy += w * fy * fy, xq += w * fx * rise,
            yq += w * fy * rise;
      }
    if (n == 0) break;
    xx -= sx * sx / n, xy -= sx * sy / n, yy -= sy * sy / n, xq -= sx * sq / n, yq -= sy * sq / n;
    const double det = xx * yy - xy * xy;
    if (det <= 1e-6 * (xx * yy + 1e-300)) break;
    b = (xq * yy - yq * xy) / det;
    c = (yq * xx - xq * xy) / det;
  }
  // The two directions along the plane, from one pixel to the next.
  const double to_t = camera_.perspective ? -here.t * here.t : 1;
  const Vec3 right = camera_.right * camera_.pixel, down = camera_.up * -camera_.pixel;
  const double scale = camera_.perspective ? here.t : 1;
  const Vec3 p = right * scale + sight.along * (b * to_t), r = down * scale + sight.along * (c * to_t);
  Vec3 n = normalised(cross(p, r));
  if (dot(n, sight.along) > 0) n = n * -1;
  return blocks > 0 ? normalised(n * (1 - blocks) + face * blocks) : n;
}

bool Shading::is_near(const Sample& a, const Sample& b) const {
  if (a.label != b.label) return false;
  const double nearer = std::min(a.t, b.t);
  // A surface seen at 80 degrees from its normal rises by six pixels per pixel.
  return std::abs(a.t - b.t) <= 8 * camera_.pixel_at(nearer) + 1e-6 * nearer;
}

bool Shading::is_edge(const Samples& samples, int64_t x, int64_t y) const {
  const Sample& here = samples.at(x, y);
  bool faces = false;  // whether cells are large enough to see their faces
  if (here.shown()) {
    const Sight sight = camera_.sight(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
    faces = cell_at(sight.from + sight.along * here.t, here.t) > 4 * camera_.pixel_at(here.t);
  }
  for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    if (!samples.has(x + dx, y + dy)) continue;
    const Sample& there = samples.at(x + dx, y + dy);
    if (here.shown() != there.shown() || (here.shown() && (!is_near(here, there) || (faces && here.face != there.face)))) return true;
  }
  return false;
}

// Cells that are large enough to be seen one by one have thin lines between them.
double Shading::line_at(const Vec3& point, const Sample& sample) const {
  constexpr double kWidth = 0.75;  // pixels on both sides of the plane between two cells
  const double pixel = camera_.pixel_at(sample.t), strength = step_from(8, 24, cell_at(point, sample.t) / pixel);
  if (strength == 0) return 0;
  const int level = level_.value_or(0);
  double nearest = 1;
  for (int d = 0; d < 3; ++d) {
    if (d == sample.face) continue;
    const Axis& axis = grid_.axis[d];
    const int64_t cell = axis.cell_at(std::clamp(point[d], axis.min(), axis.max())) >> level;
    const double lo = axis.plane(cell << level), hi = axis.plane(std::min((cell + 1) << level, axis.cells()));
    nearest = std::min(nearest, std::min(std::abs(point[d] - lo), std::abs(hi - point[d])) / (pixel * kWidth));
  }
  return strength * (1 - nearest);
}

Light Shading::light(const Sight& sight, const Sample& sample, const Vec3& normal) const {
  const Vec3 eye = normalised(sight.along * -1);
  const double facing = std::min(1.0, std::abs(dot(normal, eye)));
  const Vec3 point = sight.from + sight.along * sample.t;
  const double line = 1 - 0.45 * line_at(point, sample);
  if (sample.face >= 3) return {static_cast<float>(0.82 * line), 0, static_cast<float>(facing)};
  const Vec3 n = {dot(normal, camera_.right), dot(normal, camera_.up), -dot(normal, camera_.forward)};
  const Vec3 e = {dot(eye, camera_.right), dot(eye, camera_.up), -dot(eye, camera_.forward)};
  constexpr Vec3 kLight = {-0.448, 0.617, 0.647};
  const double open = openness_.at(point, normal);
  const double key = std::max(dot(n, kLight), 0.0), glancing = 1 - facing;
  const double sky = (0.52 + 0.22 * normal[camera_.sky]) * (0.35 + 0.65 * open), direct = key * (0.47 + 0.31 * open);
  const double shine = std::pow(std::max(dot(n, normalised(kLight + e)), 0.0), 32);
  return {static_cast<float>((sky + direct) * line), static_cast<float>(open * (0.1 * shine + 0.1 * glancing * glancing * glancing)),
          static_cast<float>(facing)};
}

Rgba lit(const Rgba& color, const Light& light) {
  Rgba out = color;
  for (int c = 0; c < 3; ++c) {
    const double own = color[c] / 255.0;
    out[c] = static_cast<uint8_t>(std::lround(255 * std::sqrt(std::clamp(own * own * light.own + light.added, 0.0, 1.0))));
  }
  return out;
}

}  // namespace teracell::server

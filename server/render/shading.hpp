// Light on what was hit: a normal from the hits around it, and the light of the dashboard's 3D view.
#pragma once
#include <optional>

#include "server/render/openness.hpp"
#include "store/text/color.hpp"

namespace teracell::server {

// What a pixel shows. Pixels lie in rows.
struct Sample {
  static constexpr uint32_t kNothing = ~uint32_t{0};
  double t = 0;  // a float would not do: coordinates may have any size up to 1e75
  uint32_t label = kNothing;
  int8_t face = -1;
  bool shown() const { return label != kNothing; }
};

// Pixels of a picture, half open.
struct Window {
  int64_t x0, y0, x1, y1;
  int64_t width() const { return x1 - x0; }
  int64_t height() const { return y1 - y0; }
  bool has(int64_t x, int64_t y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
};

// What the pixels of a window show.
struct Samples {
  Window window;
  std::vector<Sample> samples;
  explicit Samples(const Window& w) : window(w), samples(static_cast<size_t>(w.width() * w.height())) {}
  const Sample& at(int64_t x, int64_t y) const { return samples[static_cast<size_t>((y - window.y0) * window.width() + x - window.x0)]; }
  Sample& at(int64_t x, int64_t y) { return samples[static_cast<size_t>((y - window.y0) * window.width() + x - window.x0)]; }
  bool has(int64_t x, int64_t y) const { return window.has(x, y); }
};

// Light that a surface sends to the eye, whatever its colour c: c * c * own + added. On squares of colours, which are near enough to linear
// values.
struct Light {
  float own = 0, added = 0;
  float facing = 0;  // the cosine of the angle between the normal and the line of sight
};
Rgba lit(const Rgba& color, const Light& light);  // sRGB; alpha is kept

class Shading {
 public:
  static constexpr int64_t kReach = 8;  // pixels around one that its normal depends on
  // Keeps references. `level`: whose cells are drawn; without it, those that take at most a quarter of a pixel.
  Shading(const Grid& grid, const Camera& camera, const Openness& openness, const Cuts& cuts, std::optional<int> level)
      : grid_(grid), camera_(camera), openness_(openness), cuts_(cuts), level_(level) {}
  // Towards the camera, of length 1. REQUIRES: the pixel shows something.
  Vec3 normal(const Samples& samples, int64_t x, int64_t y) const;
  Vec3 face_normal(const Sight& sight, int face) const;
  // Whether a pixel shows something else than the one beside it, or something far behind it: there, one line of sight is too few.
  bool is_edge(const Samples& samples, int64_t x, int64_t y) const;
  bool is_near(const Sample& a, const Sample& b) const;  // part of the same surface, as far as two pixels tell
  // Of what a line of sight meets. Where something is cut, light is the same everywhere, so that colours can be compared.
  Light light(const Sight& sight, const Sample& sample, const Vec3& normal) const;

 private:
  double linear(double t) const { return camera_.perspective ? 1 / t : t; }  // of the picture's x and y on a plane
  double cell_at(const Vec3& point, double t) const;                         // the mean side of what is drawn there, or more
  double line_at(const Vec3& point, const Sample& sample) const;             // how much a line between cells darkens the point: 0 to 1

  const Grid& grid_;
  const Camera& camera_;
  const Openness& openness_;
  const Cuts& cuts_;
  const std::optional<int> level_;
};

}  // namespace teracell::server

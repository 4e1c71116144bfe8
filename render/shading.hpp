// Light on what was hit: a normal from the hits around it, and the light of the dashboard's 3D view.
#pragma once
#include <optional>

#include "render/camera.hpp"
#include "render/openness.hpp"
#include "store/color.hpp"

namespace teracell {

// What a pixel shows. Pixels lie in rows.
struct Sample {
  static constexpr uint32_t kNothing = ~uint32_t{0};
  double t = 0;  // a float would not do: coordinates may have any size up to 1e75
  uint32_t label = kNothing;
  int8_t face = -1;
  bool shown() const { return label != kNothing; }
};

// A stretch of rows of a picture.
struct Rows {
  int64_t first = 0, end = 0;
  uint32_t width = 0;
  std::vector<Sample> samples;
  const Sample& at(int64_t x, int64_t y) const { return samples[static_cast<size_t>((y - first) * width + x)]; }
  Sample& at(int64_t x, int64_t y) { return samples[static_cast<size_t>((y - first) * width + x)]; }
  bool has(int64_t x, int64_t y) const { return x >= 0 && x < width && y >= first && y < end; }
};

class Shading {
 public:
  static constexpr int64_t kReach = 8;  // pixels around one that its normal depends on
  // Keeps references. `level`: whose cells are drawn; without it, those that take at most a quarter of a pixel.
  Shading(const Grid& grid, const Camera& camera, const Openness& openness, std::optional<int> level)
      : grid_(grid), camera_(camera), openness_(openness), level_(level) {}
  // Towards the camera, of length 1. REQUIRES: the pixel shows something.
  Vec3 normal(const Rows& rows, int64_t x, int64_t y) const;
  Vec3 face_normal(const Sight& sight, int face) const;
  // Whether a pixel shows something else than the one beside it, or something far behind it: there, one line of sight is too few.
  bool is_edge(const Rows& rows, int64_t x, int64_t y) const;
  bool is_near(const Sample& a, const Sample& b) const;  // part of the same surface, as far as two pixels tell
  // sRGB.
  Rgba lit(const Rgba& color, const Vec3& point, const Vec3& normal, const Vec3& along) const;

 private:
  double linear(double t) const { return camera_.perspective ? 1 / t : t; }  // of the picture's x and y on a plane
  double cell_at(const Vec3& point, double t) const;                         // the mean side of what is drawn there, or more

  const Grid& grid_;
  const Camera& camera_;
  const Openness& openness_;
  const std::optional<int> level_;
};

}  // namespace teracell

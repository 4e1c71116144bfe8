// What a point is inside of: the sum of the crossings below it, for each layer that has any (compose.hpp).
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "mesher/closing/closing.hpp"

namespace teracell::mesher {

inline constexpr uint32_t kNoBody = ~uint32_t{0};

// What a crossing along an axis adds, so that it can be added to those of the rays: by the sign of a frame's handedness, which differs for y.
inline int step_along(int axis, bool up, int ray_axis) { return (up ? 1 : -1) * (axis == 1 ? -1 : 1) * (ray_axis == 1 ? -1 : 1); }

class LayerSums {
 public:
  void clear() { sums_.clear(); }
  void add(uint32_t layer, int step) {
    for (Sum& s : sums_)
      if (s.layer == layer) {
        s.sum += step;
        if (s.sum == 0) s = sums_.back(), sums_.pop_back();
        return;
      }
    sums_.push_back({layer, step});
  }
  // Adds the crossings of a ray that lie below the sample point of a cell.
  void add_below(std::span<const uint64_t> crossings, uint32_t cell) {
    for (const uint64_t c : crossings)
      if (Crossing::cell(c) <= cell && !Crossing::is_mark(c)) add(Crossing::layer(c), Crossing::step(c));
  }
  bool inside(uint32_t body) const {
    return std::ranges::any_of(sums_, [&](const Sum& s) { return body_of_layer(s.layer) == body && is_inside(s); });
  }
  // The body of the lowest rank that the point is inside of, or kNoBody.
  uint32_t owner(const std::vector<uint32_t>& rank) const {
    uint32_t owner = kNoBody;
    for (const Sum& s : sums_)
      if (is_inside(s) && (owner == kNoBody || rank[body_of_layer(s.layer)] < rank[owner])) owner = body_of_layer(s.layer);
    return owner;
  }

 private:
  struct Sum {
    uint32_t layer;
    int sum;
  };
  static bool is_inside(const Sum& s) { return is_parity_layer(s.layer) ? s.sum % 2 != 0 : s.sum != 0; }
  std::vector<Sum> sums_;
};

}  // namespace teracell::mesher

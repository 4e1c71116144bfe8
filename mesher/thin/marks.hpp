// Stretches of a tile's rays that are a body's though their sample points are not inside it: cells of sheets, and cells that
// keep thin parts. They join the crossings as a step up and a step down, so precedence and counting see nothing new.
#pragma once
#include <algorithm>

#include "mesher/engines/engine.hpp"

namespace teracell {

// Not thread-safe.
class Marks {
 public:
  void reset(uint32_t rays);
  // The cells [from, to) of a ray (v * nu + u) become the layer's. Marks that continue one another, in the order in which they
  // are made, are one: a wall along the rays costs two crossings a ray and not two a cell.
  void add(uint32_t ray, uint32_t layer, uint32_t from, uint32_t to) {
    uint32_t& last = last_[ray];
    if (last != kNone) {
      Stretch& s = all_[last];
      if (s.layer == layer && from <= s.to && s.from <= to) {
        s.from = std::min(s.from, from), s.to = std::max(s.to, to);
        return;
      }
    }
    last = static_cast<uint32_t>(all_.size());
    all_.push_back({ray, layer, from, to});
  }
  // Adds them to the tile's crossings. Throws InputError when these get too many.
  void join(const Tile& tile, Crossings& crossings);

 private:
  struct Stretch {
    uint32_t ray, layer, from, to;
  };
  static constexpr uint32_t kNone = ~uint32_t{0};
  std::vector<Stretch> all_;
  std::vector<uint32_t> last_;  // of each ray
  std::vector<uint64_t> joined_;
  std::vector<uint32_t> next_;
};

}  // namespace teracell

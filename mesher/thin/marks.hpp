// Stretches of a tile's rays that belong to a body although their sample points are not inside it: cells of sheets, and cells
// that keep thin parts. Each is added to the crossings as a step up and a step down, so precedence and counting need no change.
#pragma once
#include <algorithm>

#include "mesher/engines/engine.hpp"

namespace teracell::mesher {

// Not thread-safe.
class Marks {
 public:
  void reset(uint32_t rays);
  // Gives the cells [from, to) of ray v * nu + u to the layer. A mark that continues the ray's latest one is joined to it, so a
  // wall along the rays costs two crossings per ray and not two per cell.
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
  // Adds the marks to the tile's crossings. Throws InputError when there are too many.
  void join(const Tile& tile, Crossings& crossings);

 private:
  struct Stretch {
    uint32_t ray, layer, from, to;
  };
  static constexpr uint32_t kNone = ~uint32_t{0};
  std::vector<Stretch> all_;
  std::vector<uint32_t> last_;  // the latest mark of each ray
  std::vector<uint64_t> joined_;
  std::vector<uint32_t> next_;
};

}  // namespace teracell::mesher

// Crossings of all bodies -> runs. Pure.
//
// A body is inside where one of its *layers* is: a layer is a group of shells under one fill rule, with a counter of
// its own (a winding number or a parity) that the crossings of its facets step. Of the bodies that hold a sample
// point the strongest gives the label.
#pragma once
#include <utility>

#include "mesher/engine.hpp"
#include "store/run.hpp"

namespace teracell {

struct Layer {
  uint32_t body;
  bool evenodd;
};

// Pairs of crossings of a body between the sample points of cells `cell` - 1 and `cell` of a ray.
struct CloseCrossings {
  uint32_t ray, cell, body;
  uint64_t pairs;
};

// Not thread-safe: keeps scratch memory.
class Composer {
 public:
  // `strength[b]` ranks body b, 0 strongest, all different; `label[b]` is its label; label 0 is the background.
  Composer(std::vector<Layer> layers, const std::vector<uint32_t>& strength, const std::vector<Label>& label);
  // Turns the crossings of a tile of nu x nv rays of `length` cells into runs; sorts them on the way. Every layer's
  // surface is closed, so its counter is back at zero where the ray ends: anything else throws Error.
  void compose(Crossings& crossings, uint32_t nu, uint32_t nv, uint32_t length, RayBlock& out);
  // Of the tile that was composed last, by ray; marks are none.
  const std::vector<CloseCrossings>& close_crossings() const { return close_; }
  // Of each body, since the last call: how many cells it owned, and how many in it stronger bodies owned.
  std::vector<unsigned __int128> take_cells() { return std::exchange(cells_, std::vector<unsigned __int128>(cells_.size())); }
  std::vector<unsigned __int128> take_covered() { return std::exchange(covered_, std::vector<unsigned __int128>(covered_.size())); }

 private:
  struct Alternating {
    uint32_t body = 0, pattern = ~0u;
  };
  // Both write the changes of a ray at `at`, its pattern, and return how many layers its end leaves open.
  size_t compose_one_layer(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns);
  size_t compose_any(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns);
  void step(uint64_t crossing);
  // Of crossings of the same cell, sorted.
  void note_close(std::span<const uint64_t> crossings, uint32_t length);
  uint32_t top() const;
  // Cells in the bodies that are inside now, the strongest of which has this strength.
  void count(uint32_t cells, uint32_t owner);

  std::vector<Layer> layers_;
  std::vector<uint32_t> strength_;  // of each body
  std::vector<Label> label_;        // by strength; last of all that of the background
  std::vector<uint32_t> body_;      // by strength
  std::vector<unsigned __int128> cells_, covered_;
  std::vector<int> counter_;        // of each layer
  std::vector<int> inside_;         // of each body: layers that are inside
  std::vector<uint64_t> active_;    // bit s: the body of strength s is inside
  int open_ = 0;                    // layers that are inside
  int overlap_ = 0;                 // bodies that are inside
  uint32_t ray_ = 0;                // composed now
  std::vector<CloseCrossings> close_;
  std::vector<SetId> sets_;
  std::vector<std::vector<Alternating>> alternating_;  // [begins inside][number of changes]
};

}  // namespace teracell

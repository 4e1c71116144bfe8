// Crossings of all bodies -> runs. Pure.
//
// A body is inside where one of its *layers* is: a layer is a group of shells under one fill rule, with a counter of
// its own (a winding number or a parity) that the crossings of its facets step. Of the bodies that hold a sample
// point the strongest gives the label. What a ray costs depends on the bodies that it meets, whatever their number in all.
#pragma once
#include "mesher/engines/engine.hpp"
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

// The cells of a body: how many it owns, and how many in it stronger bodies own.
struct BodyCells {
  uint32_t body;
  uint64_t owned, covered;
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
  // Since the last call, of the bodies that rays met. REQUIRES: called at least once every 2^63 cells.
  std::vector<BodyCells> take_cells();

 private:
  struct Body {
    uint32_t strength;
    Label label;
    uint32_t layers = 0;            // that are inside
    bool met = false;               // since take_cells()
    int64_t owned = 0, within = 0;  // cells since then; where rays are in the body now, less those below
  };
  struct Alternating {
    Label label = 0;
    uint32_t pattern = ~0u;
  };
  // Both write the changes of a ray at `at`, its pattern, and return how many layers its end leaves open.
  size_t compose_one_layer(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns);
  size_t compose_any(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns);
  void step(uint64_t crossing, uint32_t cell);
  Body& meet(uint32_t body) {
    Body& b = bodies_[body];
    if (!b.met) b.met = true, met_.push_back(body);
    return b;
  }
  // Of crossings of the same cell, sorted.
  void note_close(std::span<const uint64_t> crossings, uint32_t length);

  std::vector<Layer> layers_;
  std::vector<Body> bodies_;
  std::vector<int> counter_;     // of each layer
  std::vector<uint32_t> met_;    // bodies
  std::vector<uint32_t> inside_; // bodies, the strongest last
  int open_ = 0;                 // layers that are inside
  uint32_t ray_ = 0;             // composed now
  std::vector<CloseCrossings> close_;
  std::vector<SetId> sets_;
  std::vector<std::vector<Alternating>> alternating_;  // [begins inside][number of changes]
};

}  // namespace teracell

// Crossings of all bodies -> runs. Pure.
//
// A sample point is inside a body where it is inside one of the body's *layers*. A layer is a group of shells under one fill
// rule. It has a counter, a winding number or a parity, which the crossings of its facets step. Of the bodies that hold a
// sample point, the one of the lowest rank gives the label. The cost of a ray depends on the bodies that it meets, not on how
// many bodies there are.
#pragma once
#include <array>

#include "mesher/engines/engine.hpp"
#include "mesher/overlaps/tile_overlaps.hpp"
#include "store/runs/run.hpp"

namespace teracell::mesher {

struct Layer {
  uint32_t body;
  bool evenodd;
};

// Pairs of crossings of one body between the sample points of cells `cell` - 1 and `cell` of a ray.
struct CrossingPairs {
  uint32_t ray, cell, body;
  uint64_t pairs;
};

// How many cells a body owns, and how many cells in it are owned by bodies of a lower rank.
struct BodyCells {
  uint32_t body;
  uint64_t owned, covered;
};

// Not thread-safe: it keeps scratch memory.
class Composer {
 public:
  // `rank[b]` is the rank of body b: all are different, and 0 wins over all others. `label[b]` is its label, and `in_others[b]` that of its cells
  // whose sample points lie in several bodies; label 0 is the background. `ray_axis`: that of all rays.
  Composer(std::vector<Layer> layers, const std::vector<uint32_t>& rank, const std::vector<Label>& label, const std::vector<Label>& in_others,
           int ray_axis);
  Composer(const Composer&) = delete;  // it points at its own courses
  // Turns the crossings of a tile of nu x nv rays of `length` cells into runs, and sorts the crossings. Every layer's surface
  // is closed, so its counter is back at zero where the ray ends. Throws Error when it is not.
  void compose(Crossings& crossings, uint32_t nu, uint32_t nv, uint32_t length, RayBlock& out);
  // Of the tile that was composed last, ascending by ray. Marks don't count as crossings here.
  const std::vector<CrossingPairs>& crossing_pairs() const { return pairs_; }
  // Of the bodies that rays have met since the last call. REQUIRES: it is called at least once per 2^63 cells.
  std::vector<BodyCells> take_cells();
  // Of the tile that was composed last, packed; empty if no bodies overlap in it. `cells` are those of the tile. REQUIRES: it is called for
  // every tile.
  Bytes take_overlaps(const Box& cells);

  static constexpr int kCourseBits = 8;

 private:
  struct Body {
    uint32_t rank;
    Label label, in_others;
    int marks = 0;                  // that the ray is in: the cells there are the body's, but not inside it
    uint16_t layers = 0;            // that the ray is inside of, of its two
    bool met = false;               // since take_cells()
    int64_t owned = 0, within = 0;  // cells since then; while a ray is in the body, `within` lacks the cell that it ends at
  };
  struct Alternating {
    Label label = 0;
    uint32_t pattern = ~0u;
  };
  // What became of a ray that meets several bodies, for the rays after it that meet the same ones in the same order, with the same crossings
  // in one cell: neighbours mostly do. Its crossings are known by their order.
  struct Course {
    struct Turn {  // 1: the ray enters the body, -1: it leaves it
      uint32_t body;
      int way;
    };
    // All of a body that the ray leaves while it is in others. `from`, `to` and `since` are crossings, each the first one of its cell.
    struct Leaving {
      Inside body;
      uint32_t to;
      size_t first_other, end_other, first_stretch, end_stretch;
      Owner owner;
    };
    struct Stretch {  // that bodies have in common
      uint32_t from, to;
      TileOverlaps::Stretches of_rays;  // that took the course again, since they were handed on
    };
    struct Shared {  // the crossings [from, to) lie in one cell
      uint32_t from, to;
    };
    bool known = false;
    bool taken = false;               // since its cells were added up
    uint64_t tile = 0;                // that the pattern and the stretches are of
    uint32_t pattern = 0;
    std::vector<SetId> sets;          // of the pattern
    std::vector<uint64_t> order;      // crossings without their cells, but with whether it is that of the one before (of the first one: cell 0)
    bool reaches_end = false;         // the last cell is beyond the ray
    std::vector<uint32_t> changes;    // the crossings that are
    std::vector<uint32_t> owners;     // by crossing: the body that owns the cells since the crossing before, if any
    std::vector<Turn> turns;          // by crossing
    std::vector<Leaving> leaving;
    std::vector<Inside> others;       // of all leavings
    std::vector<Stretch> stretches;   // of all leavings
    std::vector<Shared> shared;
    std::vector<uint64_t> cells;      // by crossing: the sum over the rays that took it again, since it was added up

    bool takes(std::span<const uint64_t> sorted, uint32_t length) const;
  };
  // The rays [from, to) have as many crossings each. Writes their changes at `at`.
  void compose_alike(Crossings& crossings, uint32_t from, uint32_t to, uint32_t length, uint32_t*& at, RayBlock& out);
  // The first of `rays` rays of n crossings each whose crossings are all changes, of one body: returns how many, and sets their pattern.
  uint32_t compose_turns(const uint64_t* c, uint32_t n, uint32_t rays, uint32_t length, uint32_t* at, PatternTable& patterns);
  uint32_t alternating_pattern(Label label, bool begins_inside, size_t changes, PatternTable& patterns);
  // Both write the changes of a ray at `at`, set its pattern, and return how many layers are still open at its end.
  size_t compose_one_layer(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns);
  size_t compose_any(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns);
  // The same for a ray that takes this course.
  void compose_again(Course& course, std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns);
  void add_cells(Course& course);
  void add_overlaps(Course& course);
  void learn_leaving(const Inside& body);
  void step(uint64_t crossing, uint32_t cell);
  void enter(const Inside& body);
  void leave(uint32_t rank, uint32_t cell);
  Label label_here() const;
  std::vector<Inside>::iterator place_inside(uint32_t rank);
  Body& meet(uint32_t body) {
    Body& b = bodies_[body];
    if (!b.met) b.met = true, met_.push_back(body);
    return b;
  }
  // REQUIRES: the crossings are of one cell, and sorted.
  void note_pairs(std::span<const uint64_t> crossings, uint32_t length);

  std::vector<Layer> layers_;
  std::vector<Body> bodies_;
  std::vector<int> counter_;     // one per layer
  std::vector<uint32_t> met_;    // bodies
  std::vector<Inside> inside_;   // bodies that the ray is inside of, the one of the lowest rank last
  Owner owner_{};                // of the latest cell, where the ray is inside of several bodies
  TileOverlaps overlaps_;
  int open_ = 0;                 // layers that the ray is inside of
  uint32_t ray_ = 0;             // the one that is being composed
  uint32_t turns_ = 0;           // the pattern of the rays of compose_turns()
  std::vector<CrossingPairs> pairs_;
  std::vector<SetId> sets_;
  std::vector<std::vector<Alternating>> alternating_;  // [begins inside][number of changes]
  std::vector<Course> courses_ = std::vector<Course>(size_t{1} << kCourseBits);  // by their hashes; the latest ones
  uint64_t tile_ = 0;                     // the number of the tile that is being composed
  std::vector<Course*> of_tile_;          // that rays of the tile took, or made
  Course* latest_ = courses_.data();      // that a ray took, or made if it could
  Course* learning_ = nullptr;            // that of the ray that is being composed; null if it has none
  uint32_t crossing_ = 0;                 // the one that is being stepped
  uint32_t first_of_cell_ = 0;            // of its cell, the first crossing
  uint32_t owner_crossing_ = 0;           // since which owner_ is the owner: the first one of the cell
};

}  // namespace teracell::mesher

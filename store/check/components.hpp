// Which cells hang together through faces: connected components of the cells of a label, found block by block.
//
// Within a block, a ray whose runs each meet the same run of the ray beside it takes over their components as a whole: neighbouring rays nearly
// always do, and then nothing has to be joined. At the borders of blocks components are joined in the order of the blocks. Those that no border
// reaches any more are finished, so memory depends on the border alone (as in single-pass connected component labelling; H. Samet, 1984).
#pragma once
#include <array>
#include <functional>

#include "store/base/groups.hpp"
#include "store/check/field.hpp"

namespace teracell::inline store {

struct Component {
  Label label = 0;
  uint32_t thinnest = 0;         // of thin cells: the least thickness, in half cells
  unsigned __int128 cells = 0;
  std::array<uint32_t, 3> lo{~0u, ~0u, ~0u}, hi{};  // by u, v, w; half open
  std::array<uint32_t, 3> first{~0u, ~0u, ~0u};     // of the thinnest, the cell that comes first in the order z, y, x: by z, y, x
  void add(const Component& other);
};

// Rays along a border of a block, as runs with the components that they belong to.
struct Border {
  std::vector<uint32_t> begin{0}, ends, components;
  uint32_t rays() const { return static_cast<uint32_t>(begin.size()) - 1; }
};

struct BlockComponents {
  std::vector<Component> all;
  std::array<Border, 4> borders;  // the rays with the lowest u, the highest u, the lowest v, the highest v
};

// Each thread has its own.
class BlockLabeller {
 public:
  // `window`: of the rays; its first ray is (u, v) of the grid.
  BlockComponents components(const RayBlock& rays, const RayWindow& window, uint32_t u, uint32_t v, const RayFrame& frame);

 private:
  static bool follows(const RayBlock& rays, uint32_t a, uint32_t b);
  void join_rays(const RayBlock& rays, uint32_t a, uint32_t first_a, uint32_t b, uint32_t first_b);
  void count(const RayBlock& rays, uint32_t ray, uint32_t first, uint32_t u, uint32_t v, const RayFrame& frame);

  Groups groups_;                  // of nodes
  std::vector<Component> nodes_;   // of the runs of a ray that took over nothing; its first run's place is what rays take over
  std::vector<uint32_t> first_;    // node of each ray
  std::pair<uint32_t, uint32_t> joined_;  // rays of these nodes were joined run by run
};

// What groups of parts make, in the order of their first parts, goes to `all`. Returns of each part where its group is there.
std::vector<uint32_t> join_parts(Groups& groups, std::span<const Component> parts, std::vector<Component>& all);

using Finished = std::function<void(const Component&)>;

// Components of blocks that later blocks may reach, numbered from 0 on.
class OpenComponents {
 public:
  explicit OpenComponents(Finished finished) : finished_(std::move(finished)) {}
  uint32_t add(std::span<const Component> components);  // returns the number of the first
  void join(uint32_t a, uint32_t b);                    // unless their labels differ
  uint32_t keep(uint32_t component);                    // returns its number after finish_others()
  void finish_others();                                 // those that were not kept are finished

 private:
  const Finished finished_;
  Groups groups_;
  std::vector<Component> all_, kept_;
  std::vector<uint32_t> numbers_;  // among those that are kept
};

// Joins the components of blocks, which come in the order of their columns: u fastest.
class ComponentJoiner {
 public:
  ComponentJoiner(const LevelShape& shape, Finished finished) : open_(std::move(finished)), above_(shape.chunks_u) {}
  void add(uint32_t cu, BlockComponents&& block);
  void finish() { open_.finish_others(); }

 private:
  void join(const Border& a, const Border& b);

  OpenComponents open_;
  Border before_;              // of the block before, at its highest u
  std::vector<Border> above_;  // of the last row of blocks, at their highest v; the row that comes replaces them
};

}  // namespace teracell::store

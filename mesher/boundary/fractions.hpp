// Counts what mixed cells are made of: the sub-samples of each label. A sub-sample is a sample point of a finer grid, so an engine casts
// rays through them, and a composer decides them, as for that grid.
#pragma once
#include "mesher/compose/compose.hpp"
#include "mesher/scene/labels.hpp"
#include "store/channels/mixed_cells.hpp"

namespace teracell::mesher {

// Not thread-safe.
class FractionCounter {
 public:
  // Keeps a reference to `meta`.
  FractionCounter(const std::vector<Layer>& layers, const Labels& labels, const Metadata& meta, const Subdivision& samples);

  // The cells of a tile, which is as long as the grid along the rays: how often their rays cross surfaces, and the labels that they have got.
  struct Cells {
    Box box;
    uint64_t crossings;
    const RayBlock* runs;
  };
  // Finds the mixed cells of a tile. `facets` hold those of solids that lie in its cells.
  void count(const Cells& tile, std::span<const SceneFacet* const> facets, Engine& engine, MixedCells& out);

 private:
  // In a sub-ray, the sub-sample `at` is the first one with another label.
  struct Change {
    uint32_t at;
    Label from, to;
  };
  // Rays [begin, end) of a row of the block's rays: they have the same pattern, of a body and the background by turns, and their sub-rays have as
  // many crossings each. What is known of them lies from `spans` on in spans_, for eight rays at a time.
  struct Alike {
    uint32_t begin, end, changes;
    Label label;
    size_t spans;
    uint32_t cells;  // the most mixed cells that they may have
  };
  // The cells [from, to) that a change of each of eight rays is spread over, and whether two of them side by side have as many sub-samples of the
  // background (not 0). From `counts` on, backgrounds_ has how many those are in the first cell, ray by ray, then in the second, and so on.
  struct Spans {
    int32_t from[8], to[8], has_equal[8];
    size_t counts;
  };
  // Appends the rays of a block.
  void count_block(const Box& tile, const Box& cells, std::span<const SceneFacet* const> facets, Engine& engine, const RayBlock& runs,
                   MixedCells& out);
  void cast(const Box& cells, std::span<const SceneFacet* const> facets, Engine& engine);
  void find_simple(uint32_t v, uint32_t nu, const RayBlock& runs, uint32_t first_ray);
  uint32_t find_alike(uint32_t v, uint32_t begin, uint32_t end, const RayBlock& runs, uint32_t first_ray);
  void count_alike(Alike& rays, size_t corner, const uint32_t* ends);
  void add_simple(const Alike& rays, uint32_t begin, uint32_t end, MixedCells& out) const;
  void compose_others(uint32_t v, const Box& cells);
  bool count_plain_ray(uint32_t u, const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out);
  bool count_two_labels(uint32_t u, const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out);
  void find_changes(uint32_t u);
  void count_ray(const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out);
  void give(Label label, int64_t sub_samples);

  const Metadata& meta_;
  const RayFrame frame_;
  const Subdivision samples_;
  const uint32_t total_;
  std::vector<Label> label_of_layer_;
  Composer composer_;
  std::pair<int64_t, int64_t> axis_cells_{0, 0};  // axis_ has their sub-samples along the rays
  Axis axis_;
  Tile sub_tile_;
  std::vector<const SceneFacet*> near_;
  // Of the block's sub-rays.
  bool in_planes_ = false;
  CrossingPlanes planes_;
  Crossings crossings_;  // if they are not in planes
  // Of a row of rays: which are simple, and how they change; the other ones, and the runs of their sub-rays.
  std::vector<uint8_t> simple_;
  std::vector<Alike> alike_;
  std::vector<Spans> spans_;
  std::vector<int32_t> places_, backgrounds_;
  size_t backgrounds_size_ = 0;  // of what backgrounds_ has
  std::vector<uint32_t> others_;
  Crossings other_crossings_;
  RayBlock sub_runs_;
  std::vector<MixedCells> blocks_;
  // Of a ray: where its sub-rays change, and how many sub-samples of a cell have which label.
  std::vector<Change> changes_;
  struct Share {
    Label label;
    int64_t sub_samples;
  };
  std::vector<Share> shares_;
  std::vector<uint32_t> labels_, counts_;
  struct Stretch {
    uint32_t from, to;
  };
  std::vector<Stretch> stretches_;
  std::vector<uint32_t> plain_;
};

}  // namespace teracell::mesher

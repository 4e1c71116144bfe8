// Counts what mixed cells are made of: the sub-samples of each label. A sub-sample is a sample point of a finer grid, so an engine casts
// rays through them, and a composer decides them, as for that grid.
#pragma once
#include "mesher/boundary/simple_rays.hpp"
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
  // Appends the rays of a block.
  void count_block(const Box& tile, const Box& cells, std::span<const SceneFacet* const> facets, Engine& engine, const RayBlock& runs,
                   MixedCells& out);
  void cast(const Box& cells, std::span<const SceneFacet* const> facets, Engine& engine);
  void compose_others(uint32_t v, uint32_t nu, const Box& cells);
  bool count_plain_ray(uint32_t u, const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out);
  bool count_two_labels(uint32_t u, const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out);
  void find_changes(uint32_t u);
  void count_ray(const Box& cells, std::span<const uint32_t> ends, std::span<const SetId> sets, MixedCells& out);
  void give(Label label, int64_t sub_samples);

  const Metadata& meta_;
  const RayFrame frame_;
  const Subdivision samples_;
  const uint32_t total_;
  Composer composer_;
  std::pair<int64_t, int64_t> axis_cells_{0, 0};  // axis_ has their sub-samples along the rays
  Axis axis_;
  Tile sub_tile_;
  std::vector<const SceneFacet*> near_;
  // Of the block's sub-rays.
  bool in_planes_ = false;
  CrossingPlanes planes_;
  Crossings crossings_;  // if they are not in planes
  // Of a row of rays: the simple ones; the other ones, and the runs of their sub-rays.
  SimpleRays simple_;
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

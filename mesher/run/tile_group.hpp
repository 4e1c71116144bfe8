// The work on a tile group: cast its rays, compose, encode, coarsen. Its four rows of tiles are jobs for any threads; the
// thread that ends the last of them makes the group's chunk of level 2 and adds it to the levels above. (Whole groups as jobs leave
// threads idle at the end of a small grid: 1000 x 1000 rays are 16 groups.)
#pragma once
#include <atomic>

#include "mesher/boundary/fractions.hpp"
#include "mesher/boundary/links.hpp"
#include "mesher/compose/compose.hpp"
#include "mesher/run/cast_totals.hpp"
#include "mesher/run/mesh_options.hpp"
#include "mesher/scene/labels.hpp"
#include "mesher/thin/marker.hpp"
#include "mesher/tiles/tiling.hpp"
#include "store/runs/chunk_codec.hpp"
#include "store/write/pyramid_writer.hpp"

namespace teracell::mesher {

// What a thread keeps from one job to the next.
struct Worker {
  Worker(std::unique_ptr<Engine> by, const std::vector<Layer>& layers, const Labels& labels, const Scene& scene, const Metadata& meta,
         const MeshOptions& options)
      : engine(std::move(by)),
        marker(scene, meta, labels, options.thin),
        composer(layers, labels.rank, labels.of_body, labels.of_overlap, meta.ray_axis),
        adder(meta),
        fine{{}, SetTable(static_cast<uint32_t>(meta.labels.size()))} {
    if (options.fractions) fractions.emplace(layers, labels, meta, *options.fractions);
    if (options.links) links.emplace(scene, layers, labels, meta);
  }
  uint64_t exact_decisions() const { return engine->exact_decisions() + marker.exact_decisions() + (links ? links->exact_decisions() : 0); }
  std::unique_ptr<Engine> engine;
  Marker marker;
  Composer composer;
  ChunkEncoder encoder;
  Coarsener coarsener;
  LabelsAdder adder;
  Crossings crossings;
  Chunk fine;  // the chunk of level 0 that is being made
  std::optional<FractionCounter> fractions;
  bool sums_shares = false;  // of labels, for the volumes of bodies with exact surfaces; it takes 4 % of such a run
  MixedCells mixed, mixed_part;
  MixedCellsEncoder mixed_encoder;
  std::optional<LinkFinder> links;
  LinksEncoder links_encoder;
};

class TileGroupWork {
 public:
  static constexpr uint32_t kRows = kFanOut;
  // Keeps references to tiling and meta. The chunk of level 2 is added to `above`; null: there is no level above it.
  TileGroupWork(TileGroup group, const Tiling& tiling, const Metadata& meta, std::shared_ptr<PyramidNode> above);

  // Makes the chunks of level 0 of a row, [0, kRows), and with the last row the group's chunk of level 2.
  // Different rows may be made by different threads at once.
  void make_row(uint32_t row, Worker& worker);

  const TileGroup& group() const { return group_; }
  const std::shared_ptr<PyramidNode>& above() const { return above_; }
  // When all rows are made.
  const std::vector<LevelChunk>& chunks() const { return chunks_; }
  const std::array<RowTotals, kRows>& totals() const { return totals_; }
  void add_amounts(CellSums& sums) const;
  // What the other channels have for the tiles: calls put(channel, key, frame) for every chunk of level 0.
  template <class F>
  void for_each_frame(F&& put) const {
    for (uint32_t i = 0; i < kChildren; ++i) {
      const LevelChunk& tile = chunks_[i];
      for (uint32_t s = 0; s < tile.segments.size(); ++s)
        for (size_t channel = 1; channel < meta_.channels.size(); ++channel)
          put(channel, ChunkKey{0, tile.cu, tile.cv, s}, frames_[i].empty() ? Bytes() : frames_[i][channel - 1][s]);
    }
  }

 private:
  void make_chunk(uint32_t i, std::span<const SceneFacet* const> facets, Worker& worker);
  void tally_pairs(const std::vector<CrossingPairs>& all, const Box& cells, Tallies& tallies) const;
  void make_frames(uint32_t i, const Box& cells, std::span<const SceneFacet* const> facets, const RayBlock& runs, Worker& worker);
  void make_level2(Worker& worker);

  const TileGroup group_;
  const Tiling& tiling_;
  const Metadata& meta_;
  const LevelShape shape_;
  const std::shared_ptr<PyramidNode> above_;
  std::atomic<uint32_t> rows_left_ = kRows;
  std::vector<LevelChunk> chunks_;    // kChildren of level 0, empty where they lie beyond the grid, and one of level 2
  std::array<std::vector<std::vector<Bytes>>, kChildren> frames_;  // of each tile, by channel (but the labels) and segment
  std::array<Chunk, kChildren> pieces_;    // the chunks of level 0, coarsened to level 2
  std::array<RowTotals, kRows> totals_;
};

}  // namespace teracell::mesher

// What the two ways of comparing grids share: the comparison of a chunk of the first grid with the same cells of the second one.
#pragma once
#include <functional>
#include <optional>

#include "store/format/chunk_stats.hpp"
#include "store/read/reader.hpp"
#include "store/runs/change_numbers.hpp"
#include "store/runs/chunk_codec.hpp"
#include "store/runs/named_runs.hpp"

namespace teracell::inline store {

// The differences in a part of a chunk of the first grid.
struct FoundChanges {
  ChunkKey key;                   // of the chunk
  uint32_t first, length;         // of the part's cells along the rays, counted in the grid
  std::vector<LabelStats> stats;  // the numbers of the changes as labels; also 0, for what is the same. From the chunk's first ray and `first` on
  Bytes frame;                    // the part as a chunk, with these numbers as labels, if that is asked for
};

struct GridComparison {
  const GridReader &a, &b;
  const MaterialNames& names;
  ChangeNumbers& numbers;
  bool with_cells;  // fill FoundChanges::frame
  int threads;
  size_t memory;
  std::function<void(double)> progress;     // the share that is done; may throw
  std::function<void(FoundChanges)> found;  // called by one thread at a time; for each chunk of the first grid, its cells ascend
};

// The rays of both grids lie along the same axis.
void compare_along(const GridComparison& c);
// They don't.
void compare_across(const GridComparison& c);

inline constexpr uint32_t kMostChangeLabels = 65535;  // of a file

// Keeps its memory from chunk to chunk: each thread has its own.
class ChunkComparison {
 public:
  explicit ChunkComparison(const GridComparison& c) : c_(c), shape_(c.a.shape(0)), numbers_(c.numbers) {}

  // Compares the cells [w0, w1) of a chunk's rays with those of other(u, v), the runs of the second grid along ray (u, v) of the chunk.
  // Nothing is returned where all are the same. REQUIRES: w0 and w1 lie in the chunk; both count in the grid.
  template <class Other>
  std::optional<FoundChanges> compare(const ChunkKey& key, uint32_t w0, uint32_t w1, Other&& other) {
    if (!scratch_) scratch_ = std::make_shared<Chunk>();
    c_.a.read(key, *scratch_);
    a_.set(scratch_, c_.names.of_a, key.segment * shape_.chunk_cells);
    const RayBlock& rays = a_.rays();
    bool differs = false;
    for (uint32_t v = 0, ray = 0; v < rays.nv; ++v)
      for (uint32_t u = 0; u < rays.nu; ++u, ++ray) {
        const NamedRuns x = a_.ray(ray), y = other(u, v);
        if (same_runs(x, y) || !find_changes(x, y, w0, w1)) {
          if (differs) out_.append(kAllSame, {});
          continue;
        }
        if (!differs) {
          out_.reset(rays.nu, rays.nv, w1 - w0);
          for (uint32_t before = 0; before < ray; ++before) out_.append(kAllSame, {});
          differs = true;
        }
        out_.append(labels_, at_);
      }
    if (!differs) return std::nullopt;
    return FoundChanges{key, w0, w1 - w0, stats_of(out_), c_.with_cells ? encoder_.encode(out_, sets_) : Bytes()};
  }

 private:
  static constexpr std::array<SetId, 1> kAllSame = {0};

  // The changes along a ray, as runs of their numbers. Returns whether there are any.
  bool find_changes(const NamedRuns& x, const NamedRuns& y, uint32_t w0, uint32_t w1) {
    labels_.clear();
    at_.clear();
    for_each_stretch(x, y, w0, w1, [&](uint32_t from, uint32_t, MaterialName in_a, MaterialName in_b) {
      const uint32_t number = numbers_.of(in_a, in_b);
      if (!labels_.empty() && labels_.back() == number) return;
      if (!labels_.empty()) at_.push_back(from - w0);
      labels_.push_back(number);
    });
    return labels_.size() > 1 || labels_[0] != 0;
  }

  const GridComparison& c_;
  const LevelShape shape_;
  KnownChanges numbers_;
  std::shared_ptr<Chunk> scratch_;
  NamedChunk a_;
  std::vector<SetId> labels_;
  std::vector<uint32_t> at_;
  RayBlock out_;
  const SetTable sets_{kMostChangeLabels + 1};
  ChunkEncoder encoder_;
};

}  // namespace teracell::store

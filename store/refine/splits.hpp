// Which cells of the coarser levels are split, in blocks of 128 x 128 x 128 cells.
//
// Whether a cell is split depends on those up to N cells around it on the level below. So levels are made two at a time, a *tier*, for one block of
// the cells below them: of tier 0 from the runs, of each other tier from what the tier below it has found. Of that only the coarser level is
// kept, 1 bit for 64 cells, and only where a bit is set, in a file without a name. All else is made again when it is asked for, which takes
// less time than to keep it.
#pragma once
#include <functional>
#include <optional>
#include <unordered_map>

#include "store/base/spill.hpp"
#include "store/refine/wants.hpp"

namespace teracell::inline store {

// A block of a tier: 128 cells of level 2 * tier along each axis, by u, v, w.
struct RefinedBlock {
  static constexpr int kBits = 7;
  static constexpr int64_t kCells = int64_t{1} << kBits;
  int tier = 0;
  Index3 at{};
  int level() const { return 2 * tier; }
  Box cells() const;  // of its level
  friend bool operator==(const RefinedBlock&, const RefinedBlock&) = default;
};

// What is split of a block, on the one or two levels above its own: split[0] is level() + 1.
struct BlockSplits {
  std::vector<Bits> split;
  size_t memory() const;
};

// Threads may share it once it is prepared.
class Splits {
 public:
  // Keeps a reference to the reader. Files are made in `folder`; `memory`: bytes, for what is kept for a while. Throws UsageError, IoError.
  Splits(const GridReader& reader, const Refinement& refinement, const std::filesystem::path& folder, size_t memory);

  int coarsest() const { return refinement_.coarsest; }
  int tiers() const { return (coarsest() + 1) / 2; }
  // Makes ready what get() and base() need for cells of a box of level 0, by u, v, w: what was made for an earlier box isn't made again.
  void prepare(const Box& box, int threads, const std::function<void(double share)>& progress);
  bool is_prepared(const Box& box) const;

  // The rays of a block of tier 0, and what is split of it; neither where nothing in it is split and all its cells have one label.
  struct Base {
    std::optional<Label> label;
    std::optional<Window> window;
    BlockSplits splits;  // empty: nothing
    size_t memory() const { return sizeof *this + splits.memory() + (window ? window->memory() : 0); }
  };
  // Those of prepare() are kept for a while, and those that will be asked for `again`.
  std::shared_ptr<const Base> base(const Index3& block, bool again) const;
  // Of a tier above 0; empty: nothing is split.
  std::shared_ptr<const BlockSplits> get(const RefinedBlock& block) const;
  Label label_of(const Index3& cell) const;  // of level 0, by u, v, w

 private:
  struct KeyHash {
    size_t operator()(const RefinedBlock& b) const {
      return ChunkKeyHash{}({b.tier, static_cast<uint32_t>(b.at[0]), static_cast<uint32_t>(b.at[1]), static_cast<uint32_t>(b.at[2])});
    }
  };
  struct Marks;  // what makes a block
  struct Record {
    uint64_t offset;
    uint32_t bytes;
  };

  int levels_of(int tier) const { return std::min(2, coarsest() - 2 * tier); }
  Box window(const RefinedBlock& block) const;
  std::vector<Box> blocks_for(const Box& cells) const;
  std::optional<Label> only_label(const Box& cells, int level) const;
  std::optional<Label> quiet(const Box& cells, int level) const;
  BlockSplits climb(const RefinedBlock& block, Marks marks, Bytes* record) const;
  Base make_base(const Index3& block, Bytes* record) const;
  std::optional<BlockSplits> make_above(const RefinedBlock& block, Bytes* record) const;
  template <class Next>
  void make_records(int threads, const std::function<void(double share)>& progress, Next next);
  void prepare_base(const Box& blocks, int threads, const std::function<void(double share)>& progress);
  void prepare_above(int tier, const Box& blocks, int threads, const std::function<void(double share)>& progress);
  Record written(const Bytes& record);
  std::shared_ptr<const Chunk> chunk(const ChunkKey& key) const;

  const GridReader& reader_;
  const Refinement refinement_;
  const Wants wants_;
  mutable KeptChunks chunks_;
  SpillFile file_;
  uint64_t size_ = 0;                                                  // of the file
  std::vector<std::unordered_map<RefinedBlock, Record, KeyHash>> records_;  // by tier
  std::vector<std::vector<Box>> prepared_;                             // each by tier, of blocks
  mutable LruCache<RefinedBlock, BlockSplits, KeyHash> made_;
  mutable LruCache<RefinedBlock, Base, KeyHash> bases_;  // of tier 0
};

}  // namespace teracell::store

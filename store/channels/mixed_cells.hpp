// What mixed cells are made of: the share of every label, counted over a lattice of sub-samples. It is the channel `fractions` (FORMAT.md).
// A cell is mixed when its sub-samples have more than one label, or one that is not the cell's own.
#pragma once
#include <memory>

#include "store/base/populate.hpp"
#include "store/base/sequence_table.hpp"
#include "store/grid/metadata.hpp"
#include "store/runs/run.hpp"

namespace teracell::inline store {

// The name of the channel, its coding, and that of files up to version 3.1.
inline constexpr char kFractions[] = "fractions", kStretches[] = "stretches", kShares[] = "shares";

// How many sub-samples a cell has along x, y and z: powers of two from 1 to 256, with a product of at most 65536.
using Subdivision = std::array<uint32_t, 3>;
inline uint32_t sub_samples(const Subdivision& s) { return s[0] * s[1] * s[2]; }
// Why this is no subdivision, as a sentence for people; empty if it is one.
std::string beyond_bounds(const Subdivision& s);

// The mixed cells of a block of rays, as runs of cells with equal shares. Rays are numbered like those of a RayBlock. A stretch is runs of a ray of
// which each begins where the one before it ends. Most runs have one cell, so those that have more are listed.
struct MixedCells {
  // The cells [from, to) of a ray. They have the labels sets[set], of which label i has counts[first + i] sub-samples.
  struct Run {
    uint32_t from, to, set, first;
  };
  struct Stretch {
    uint32_t from, first_run;  // its first cell; its runs go on to the first one of the next stretch
    friend bool operator==(const Stretch&, const Stretch&) = default;
  };
  struct Longer {
    uint32_t run, cells;
    friend bool operator==(const Longer&, const Longer&) = default;
  };
  struct Shares {
    uint32_t set, first;  // as in Run
  };
  uint32_t nu = 0, nv = 0, length = 0, total = 1;  // total: sub-samples of a cell, a power of two
  std::vector<uint32_t> begin{0};                  // rays + 1: where a ray's stretches start
  UnfilledVector<Stretch> stretches;               // ascending within a ray, with a cell or more between two of them
  uint32_t runs = 0;
  std::vector<Longer> longer;       // runs of more than one cell, ascending
  SequenceTable sets;               // labels, ascending
  std::vector<Shares> shares;       // of each run; empty while all runs have set 0
  UnfilledVector<uint32_t> counts;  // each above 0; those of a run add up to `total`, and follow those of the run before it

  void reset(uint32_t new_nu, uint32_t new_nv, uint32_t new_length, uint32_t new_total);
  // Appends a run to the ray that is being filled; joins it to the run before it if that has the same shares and ends where it begins.
  // REQUIRES: `labels` ascend.
  void add(uint32_t from, uint32_t to, std::span<const uint32_t> labels, std::span<const uint32_t> counts);
  // Appends the runs of a ray of other cells. REQUIRES: the ray that is being filled is empty.
  void add_ray(const MixedCells& other, uint32_t ray);
  void end_ray() { begin.push_back(static_cast<uint32_t>(stretches.size())); }
  // Gives the next runs, whose stretches and counts are there, their set. Their counts start at `first`.
  void name_set(uint32_t more_runs, uint32_t set, size_t first);
  // Run `run` gets so many cells more. REQUIRES: it is the latest one of all.
  void lengthen(uint32_t run, uint32_t cells) {
    if (longer.empty() || longer.back().run != run) longer.push_back({run, 1});
    longer.back().cells += cells;
  }
  bool empty() const { return runs == 0; }
  size_t memory() const {
    return sizeof *this + sets.memory() + (begin.capacity() + counts.capacity()) * 4 +
           (stretches.capacity() + longer.capacity() + shares.capacity()) * 8;
  }
  uint32_t first_run(size_t stretch) const { return stretch < stretches.size() ? stretches[stretch].first_run : runs; }
  Shares shares_of(uint32_t run) const { return shares.empty() ? Shares{0, run * static_cast<uint32_t>(sets[0].size())} : shares[run]; }
  std::span<const uint32_t> labels(const Run& run) const { return sets[run.set]; }
  std::span<const uint32_t> counts_of(const Run& run) const { return {counts.data() + run.first, sets[run.set].size()}; }

  // The runs of a ray in order, one by one.
  class RunsOfRay {
   public:
    struct End {
      uint32_t run;
    };
    class Iterator {
     public:
      Iterator(const MixedCells& cells, uint32_t stretch);
      Run operator*() const {
        const Shares s = cells_->shares_of(run_);
        return {from_, to_, s.set, s.first};
      }
      Iterator& operator++();
      bool operator==(const End& end) const { return run_ == end.run; }

     private:
      void take_cells();
      const MixedCells* cells_;
      uint32_t stretch_, run_, from_ = 0, to_ = 0;
      size_t longer_ = 0;  // the next longer run
    };
    RunsOfRay(const MixedCells& cells, uint32_t ray) : cells_(cells), ray_(ray) {}
    Iterator begin() const { return {cells_, cells_.begin[ray_]}; }
    End end() const { return {cells_.first_run(cells_.begin[ray_ + 1])}; }
    bool empty() const { return cells_.begin[ray_] == cells_.begin[ray_ + 1]; }

   private:
    const MixedCells& cells_;
    const uint32_t ray_;
  };
  RunsOfRay of_ray(uint32_t ray) const { return {*this, ray}; }

 private:
  uint32_t end_ = 0;  // where the latest run ends
};

// The cells [from, to) of every ray, renumbered from 0.
MixedCells cut(const MixedCells& cells, uint32_t from, uint32_t to);

// Keeps scratch memory between calls: each thread has its own.
class MixedCellsEncoder {
 public:
  MixedCellsEncoder();
  ~MixedCellsEncoder();
  // The frame of a chunk. Throws InputError when it is too complex. REQUIRES: not empty.
  Bytes encode(const MixedCells& cells);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> s_;
};

// Throws FormatError unless `frame` is a valid one of nu x nv rays of `length` cells with labels below `labels` and `total` sub-samples.
void decode_mixed_cells(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, uint32_t total, MixedCells& out);
// The same for the coding kShares.
void decode_shares(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, uint32_t total, MixedCells& out);

}  // namespace teracell::store

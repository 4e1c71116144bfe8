// What mixed cells are made of: the share of every label, counted over a lattice of sub-samples. It is the channel `fractions` (FORMAT.md).
// A cell is mixed when its sub-samples have more than one label, or one that is not the cell's own.
#pragma once
#include <memory>

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

// The mixed cells of a block of rays, as runs of cells with equal shares. Rays are numbered like those of a RayBlock.
struct MixedCells {
  // The cells [from, to) of a ray. They have the labels sets[set], of which label i has counts[first + i] sub-samples.
  struct Run {
    uint32_t from, to, set, first;
  };
  uint32_t nu = 0, nv = 0, length = 0, total = 1;  // total: sub-samples of a cell, a power of two
  std::vector<uint32_t> begin{0};                  // rays + 1: where a ray's runs start
  std::vector<Run> runs;                           // ascending within a ray, without overlap
  SequenceTable sets;                              // labels, ascending
  std::vector<uint32_t> counts;                    // each above 0; those of a run add up to `total`, and follow those of the run before it

  void reset(uint32_t new_nu, uint32_t new_nv, uint32_t new_length, uint32_t new_total);
  // Appends a run to the ray that is being filled; joins it to the run before it if that has the same shares and ends where it begins.
  // REQUIRES: `labels` ascend.
  void add(uint32_t from, uint32_t to, std::span<const uint32_t> labels, std::span<const uint32_t> counts);
  void end_ray() { begin.push_back(static_cast<uint32_t>(runs.size())); }
  bool empty() const { return runs.empty(); }
  size_t memory() const { return sizeof *this + sets.memory() + (begin.capacity() + counts.capacity()) * 4 + runs.capacity() * sizeof(Run); }
  std::span<const Run> of_ray(uint32_t ray) const { return {runs.data() + begin[ray], begin[ray + 1] - begin[ray]}; }
  std::span<const uint32_t> labels(const Run& run) const { return sets[run.set]; }
  std::span<const uint32_t> counts_of(const Run& run) const { return {counts.data() + run.first, sets[run.set].size()}; }
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

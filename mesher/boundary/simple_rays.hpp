// The mixed cells of simple rays, eight rays at once. A ray is simple if its sub-rays change as it does itself, all by crossings of one layer, up and
// down by turns, and if no cell has two of its changes: nearly all rays of a scene with one body.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "mesher/engines/engine.hpp"
#include "store/channels/mixed_cells.hpp"

namespace teracell::mesher {

// Not thread-safe.
class SimpleRays {
 public:
  // How many cells a change of a ray may be spread over.
  static constexpr uint32_t kMostCells = 64;
  static constexpr uint32_t kLanes = 8;  // rays that are counted at once

  SimpleRays(const RayFrame& frame, const Subdivision& samples, std::vector<Label> label_of_layer)
      : su_(samples[frame.u]), sv_(samples[frame.v]), per_ray_(samples[frame.w]), label_of_layer_(std::move(label_of_layer)) {}

  // A row of rays of the grid, those from `first` on in `runs`, and what their sub-rays cross: of row `row` of the rays in `planes`, which have
  // `sub_rays` sub-rays in a row and `length` sub-samples each.
  struct Row {
    const RayBlock& runs;
    uint32_t first, size;
    const CrossingPlanes& planes;
    uint32_t row;
    size_t sub_rays;
    int32_t length;
  };
  // Finds which of them are simple.
  void find(const Row& row);
  // None of so many rays is simple.
  void find_none(uint32_t rays);
  bool has(uint32_t ray) const { return simple_[ray] != 0; }
  // Appends the simple rays of the row from `begin` on, up to one that is not simple or has other labels. Returns where they end. REQUIRES: this one
  // is simple; the simple ones before it have been added.
  uint32_t add(uint32_t begin, MixedCells& out);

 private:
  // Rays [begin, end) of the row: they have the same pattern, of a body and the background by turns, and their sub-rays have as many crossings
  // each. What is known of them lies from `spans` on in spans_, for eight rays at a time.
  struct Alike {
    uint32_t begin, end, changes;
    Label label;
    size_t spans;
    uint32_t cells;  // the most mixed cells that they may have
  };
  // The cells [from, to) that a change of each of eight rays is spread over, and whether two of them side by side have as many sub-samples of the
  // background (not 0). From `counts` on, backgrounds_ has how many those are in the first cell, ray by ray, then in the second, and so on.
  struct Spans {
    int32_t from[kLanes], to[kLanes], has_equal[kLanes];
    size_t counts;
  };
  size_t corner_of(const Row& row, uint32_t ray) const;
  uint32_t find_alike(const Row& row, uint32_t begin, uint32_t end);
  void count(const Row& row, Alike& rays);
  void append(const Alike& rays, uint32_t begin, uint32_t end, MixedCells& out) const;

  const uint32_t su_, sv_, per_ray_;  // sub-rays of a ray along u and along v, and sub-samples of a cell along it
  const std::vector<Label> label_of_layer_;
  // Of the row.
  std::vector<uint8_t> simple_;
  std::vector<Alike> alike_;
  size_t added_ = 0;  // of alike_
  std::vector<Spans> spans_;
  std::vector<int32_t> places_, backgrounds_;
  size_t backgrounds_size_ = 0;  // of what backgrounds_ has
};

}  // namespace teracell::mesher

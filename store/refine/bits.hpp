// A box of cells of one level, a bit each, in rows of words along w. What is near a bit that is set is found for 64 cells at once.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "store/grid/grid.hpp"

namespace teracell::inline store {

// Places are those of the level, by u, v, w of the rays' frame (RayFrame). The box may reach beyond the grid.
class Bits {
 public:
  Bits() = default;
  explicit Bits(const Box& box);

  const Box& box() const { return box_; }
  bool none() const;
  // REQUIRES: the cell lies in the box.
  bool get(int64_t u, int64_t v, int64_t w) const {
    const auto at = static_cast<size_t>(w - box_.lo[2]);
    return (words_[row(u, v) + at / 64] >> at % 64 & 1) != 0;
  }
  // Sets the cells [w0, w1) of a row that lie in the box.
  void set(int64_t u, int64_t v, int64_t w0, int64_t w1);
  void set(const Box& cells);
  // Sets what is set in the other, where the boxes overlap.
  void add(const Bits& other);
  // The same for 32 cells of a row from w on, which may lie outside the box.
  void add(int64_t u, int64_t v, int64_t w, uint32_t cells);
  // The 32 cells of a row from w on. REQUIRES: they lie in the box, and w - box().lo[2] is a multiple of 32.
  uint32_t get32(int64_t u, int64_t v, int64_t w) const;

  // Sets each cell within `cells` of one that is set, on each axis. What lies outside the box isn't known, so the box loses as many cells
  // at each of its sides.
  void dilate(int64_t cells);
  // The cells of the next level that hold one that is set. REQUIRES: the box begins and ends at even places.
  Bits coarser() const;
  // A part of the box.
  Bits cropped(const Box& box) const;

  size_t memory() const { return sizeof *this + words_.capacity() * sizeof words_[0]; }

 private:
  size_t row(int64_t u, int64_t v) const { return static_cast<size_t>((v - box_.lo[1]) * wide_ + (u - box_.lo[0])) * row_words_; }

  Box box_;
  int64_t wide_ = 0;      // rows from v to v + 1: those that were asked for, while the box gets smaller
  size_t row_words_ = 0;
  std::vector<uint64_t> words_;
};

// The box with so many cells more at each side.
Box grown(const Box& box, int64_t cells);

}  // namespace teracell::store

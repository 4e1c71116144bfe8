// Where anything visible is: a bit for each cell of a level, and of all coarser ones. It takes 20 MB at most, whatever the grid.
#pragma once
#include <bit>
#include <functional>

#include "server/render/cells/visible.hpp"
#include "store/read/reader.hpp"

namespace teracell::server {

class Occupancy {
 public:
  // Reads one level: the finest, from `level` on, whose bits are not too many.
  Occupancy(const GridReader& reader, const Visible& visible, int level, int threads);
  // The same of the cells of which seen(level, cell) is not 0. Of others no finer cell is asked for.
  Occupancy(const GridReader& reader, int level, const std::function<uint32_t(int, const Index3&)>& seen);

  int level() const { return first_; }  // the finest that there are bits of
  // REQUIRES: level() <= level < reader.levels(), and the cell, by (u, v, w) of the grid's rays, lies in it.
  bool at(int level, uint32_t u, uint32_t v, uint32_t w) const {
    const Bits& b = levels_[level - first_];
    return b.words[(size_t{v} * b.nu + u) * b.per_ray + w / 64] >> (w % 64) & 1;
  }
  // How many of the cells from `w` to `w + count` have something visible. REQUIRES: `count` is 1, 2, 4 ... 64 and divides `w`.
  int count(int level, uint32_t u, uint32_t v, uint32_t w, uint32_t count) const {
    const Bits& b = levels_[level - first_];
    return std::popcount(b.words[(size_t{v} * b.nu + u) * b.per_ray + w / 64] >> (w % 64) & ~uint64_t{0} >> (64 - count));
  }
  size_t memory() const;  // bytes on the heap

 private:
  // The bits of a ray begin with a word of their own.
  struct Bits {
    uint32_t nu, nv, nw;
    size_t per_ray;  // words
    std::vector<uint64_t> words;
    explicit Bits(const LevelShape& shape);
  };
  static constexpr size_t kMostWords = size_t{1} << 21;
  void size_for(const GridReader& reader);
  void read(const GridReader& reader, const Visible& visible, int threads);
  void halve(const Bits& fine, Bits& coarse) const;

  int first_;
  std::vector<Bits> levels_;
};

}  // namespace teracell::server

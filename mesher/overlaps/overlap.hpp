// What two bodies have in common: the cells whose sample points are inside both, whoever owns them. Sheets and kept cells (marks.hpp) take no
// part, since no sample point is inside a sheet, or inside a body in a cell that it only keeps.
//
// All that is known of a pair depends on the cells alone. So it is the same for any ray axis, tiles and order in which they are added.
#pragma once
#include <array>
#include <optional>

#include "store/base/bytes.hpp"
#include "store/grid/grid.hpp"

namespace teracell::mesher {

struct Overlap {
  std::array<uint32_t, 2> bodies{};  // the lower number first
  bool third = false;                // a third body owns some of the cells; otherwise the stronger of the two owns all of them
  unsigned __int128 cells = 0;
  Box box;    // of the cells
  Index3 at{};  // the cell with the least z, then y, then x

  void add(const Overlap& other);  // of the same bodies, other cells
  friend bool operator==(const Overlap&, const Overlap&) = default;
};

// Overlaps as bytes, about 20 each. REQUIRES: their bodies ascend.
class OverlapPacker {
 public:
  void put(const Overlap& overlap);
  size_t bytes() const { return bytes_.size(); }
  Bytes take();  // and begins anew

 private:
  Bytes bytes_;
  uint64_t last_ = 0;
};

class OverlapUnpacker {
 public:
  explicit OverlapUnpacker(std::span<const uint8_t> bytes) : in_(bytes, "the overlaps") {}
  // Throws FormatError unless the bytes are those of a packer.
  std::optional<Overlap> next();

 private:
  ByteReader in_;
  uint64_t last_ = 0;
};

}  // namespace teracell::mesher

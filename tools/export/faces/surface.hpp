// The boundary of the cells of some materials as a closed surface of triangles, found block by block. What lies outside the exported box
// counts as empty, so the surface is closed at the box's sides too.
//
// Blocks through which the surface can't pass are skipped by what a coarse level of the pyramid says of them. The others are held one at
// a time, with a margin. So the memory does not depend on the number of cells: 80 bytes per block that the surface passes through are kept.
// (A sweep over layers, as for OpenFOAM's meshes, would expand every cell, and hold a whole layer of vertices for smoothing.)
#pragma once
#include <type_traits>

#include "store/base/bytes.hpp"
#include "tools/export/faces/smooth.hpp"
#include "tools/export/format.hpp"

namespace teracell::exports::faces {

// A block of cells with vertices or facets. Vertices on its lower sides are its own, those on its upper sides belong to the next blocks.
struct Block {
  Index3 at;           // counted in blocks from that of cell (0, 0, 0)
  uint64_t first = 0;  // the number of its first vertex
  // Where its groups of vertices begin, and the end, counted from `first`. Bit d of a group says whether its vertices lie on the lower
  // side across axis d. The members of such a group are seen from the block below too, so it can tell their numbers.
  std::array<uint32_t, 9> group{};
};

// A part of an export's progress, as shares.
struct Leg {
  double from, to;
};

// What a format has room for.
struct Room {
  const char* format;
  uint64_t vertices, facets;
  const char* advice;  // what to take when that is too little
};

class Surface {
 public:
  // Finds the blocks and counts vertices and facets. Throws UsageError when an option is wrong, there is no facet, or there are more vertices or
  // facets than there is room for: of much larger surfaces the runs tell that at once.
  Surface(const Export& e, Leg leg, const Room& room);
  uint64_t vertices() const { return vertices_; }
  uint64_t facets() const { return facets_; }

  struct Part {
    Box box;  // its own cells, and a layer beyond the exported box at the upper sides
    const Cells& cells;
    const Piece& piece;
    std::vector<Vec3> places;       // of the piece's vertices, smoothed if that is asked for
    std::vector<uint32_t> own;      // the vertices of the block, by number
    std::vector<uint64_t> numbers;  // of the vertices of the block's facets, in the whole surface
  };
  // Call f for each block in order: with `places` and `own`, or with `numbers`. A part is good until f returns.
  void for_each_placed(Leg leg, const std::function<void(const Part&)>& f);
  void for_each_numbered(Leg leg, const std::function<void(const Part&)>& f);

 private:
  Box box_of(const Index3& block) const;
  void expect_room(uint64_t vertices, uint64_t facets) const;
  void find_blocks(Leg leg);
  void read(const Box& box, int64_t margin);
  void count(const Index3& block);
  void for_each_block(Leg leg, int64_t margin, const std::function<void(const Block&, Part&)>& f);
  Planes planes() const;
  std::vector<uint64_t> numbers_of(const Block& block) const;

  const Export& e_;
  const Room room_;
  const std::vector<bool> chosen_;  // by material
  const int rounds_;                // of smoothing
  const SetValue material_;
  Cells cells_;
  Piece piece_;
  std::vector<Block> blocks_;
  uint64_t vertices_ = 0, facets_ = 0;
};

// The number of facets' squares across the rays, or less where chunks meet. The surface has as many vertices at least, since no more than four of
// them share a corner, and twice as many facets. Counts no further than a chunk beyond `enough`.
uint64_t least_vertices(const Export& e, const std::vector<bool>& chosen, uint64_t enough);

// Appends a number as bytes, in the order of memory: little endian, like every machine this runs on.
template <class T>
void put_raw(Bytes& out, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* const bytes = reinterpret_cast<const uint8_t*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}

// The options of formats that hold a surface.
std::vector<ExportOption> surface_options();

}  // namespace teracell::exports::faces

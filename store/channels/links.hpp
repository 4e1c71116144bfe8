// Where, between the sample points of two neighbouring cells with different labels, the one label ends and the other begins, and which patch of
// the surface lies there. It is the channel `links` (FORMAT.md), a frame for each chunk that has any. A link belongs to its lower cell.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "store/base/bytes.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::inline store {

inline constexpr char kLinks[] = "links", kDistances[] = "distances";  // the name and the coding of the channel

// Between a cell of a chunk and its upper neighbour along an axis. `end` and `begin` are in 65536ths of the distance of the two sample points:
// 1 <= end <= begin <= 65536, or both are 0 where surfaces don't tell.
struct Link {
  uint64_t line;  // of cells along the axis (ChunkLinks)
  uint32_t cell;  // the lower one, in the line
  uint32_t end, begin;
  uint32_t patch;  // kNoPatch: none is known
  friend bool operator==(const Link&, const Link&) = default;
};

// The links of a chunk. Along each axis of the ray frame they ascend by line, then by cell. Neighbouring lines follow each other:
//   along u, line w * nv + v;  along v, line w * nu + u;  along w (the rays), line v * nu + u.
struct ChunkLinks {
  uint32_t nu = 0, nv = 0, length = 0;
  std::array<std::vector<Link>, 3> along;  // u, v, w

  // Of lines along the axis: how many stand in a row, how many there are, how many cells each has.
  uint32_t row(int axis) const { return axis == 0 ? nv : nu; }
  uint64_t lines(int axis) const { return uint64_t{row(axis)} * (axis == 2 ? nv : length); }
  uint32_t cells(int axis) const { return axis == 0 ? nu : axis == 1 ? nv : length; }
  bool empty() const { return along[0].empty() && along[1].empty() && along[2].empty(); }
  size_t memory() const { return sizeof *this + (along[0].capacity() + along[1].capacity() + along[2].capacity()) * sizeof(Link); }
};

// Keeps scratch memory between calls: each thread has its own.
class LinksEncoder {
 public:
  LinksEncoder();
  ~LinksEncoder();
  // The frame of a chunk. Throws InputError when it is too complex. REQUIRES: not empty.
  Bytes encode(const ChunkLinks& links);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> s_;
};

Channel links_channel();
// The channel of a grid; null if it has none.
const Channel* find_links(const Metadata& meta);
// Decodes the frame of a chunk. Throws FormatError unless it is a valid one.
void decode_links(const Metadata& meta, const ChunkKey& key, std::span<const uint8_t> frame, ChunkLinks& out);

}  // namespace teracell::store

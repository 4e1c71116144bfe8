// Facets that are too many to be looked at together lie in bins, on disk or in memory. A bin is a node of the tree of rays with so few facets that it
// can be loaded: one group of tiles or many, or, of a group with very many facets that are small compared with it, a part. A facet lies in every bin
// that has a ray that it may meet, and in the bins of its vertices. So facets that share a vertex share a bin, and two bins are connected by the
// facets that lie in both.
//
// A part of which there are many copies lies in bins as one record, and its facets are read from their shape when a bin is loaded.
#pragma once
#include <cstring>
#include <functional>
#include <vector>

#include "mesher/tiles/piece_log.hpp"
#include "mesher/tiles/rays.hpp"
#include "mesher/tiles/welded_records.hpp"

namespace teracell::mesher {

// Facets of a bin that come one after another and have the same origin.
struct BinnedFacets {
  struct One {
    std::array<uint32_t, 3> vertices{};  // which of the block's
    RayRange rays{};
    uint32_t bins = 1;  // that it lies in; where it is not at home, 2 stands for several
    bool at_home = true;  // in exactly one of the bins that it lies in
    bool leads = true;  // in exactly one of those bins of a tile group in which the facet lies
  };
  std::span<const One> facets;
  // The vertices of a block of facets, in their file's coordinates; some may be equal. While `block` is the same, they are.
  std::span<const Vec3> vertices;
  uint32_t block = 0;
  bool of_block = false;  // all facets of the block have the same origin
  std::span<const Facet> moved;  // the facets as the grid sees them, unless that is as their file has them
  uint32_t layer = 0;  // of their body (closing.hpp)
  uint32_t patch = 0;  // as in SceneFacet; 0 if they are not kept
  bool added = false;  // they close a hole and are not in the body's file
  bool ignored = false;  // they count for nothing

  Facet in_file(const One& f) const { return {{vertices[f.vertices[0]], vertices[f.vertices[1]], vertices[f.vertices[2]]}}; }
  Facet placed(size_t i) const { return moved.empty() ? in_file(facets[i]) : moved[i]; }
};

// A part that stands for its facets.
struct BinnedPart {
  uint64_t facets;
  Vec3 lo, hi;  // the box of its facets, as the grid sees them
  uint32_t layer, patch;
  std::function<void(const std::function<void(const Facet&)>&)> read;  // calls with each facet, in its file's coordinates; for any thread
};

// Not thread-safe while it is filled; then threads may take different bins at once.
class FacetBins {
 public:
  using Move = std::function<Facet(const Facet&, uint32_t layer)>;
  // For about `facets` facets, `whole` of them surely not in parts, in single precision if `float32`. `move` transforms a facet to where the grid
  // sees it; none: all are there. A loaded bin takes about a sixteenth of the budget, and all buffers of bins together an eighth at most while they
  // are filled. With `own_writer` another thread writes them. If all fits into half of the budget, it stays in memory. `widened` bodies as in
  // rays.hpp. Facets that lie outside `range` alone are dropped. `patches`: facets keep theirs.
  FacetBins(const Metadata& meta, uint64_t facets, uint64_t whole, bool float32, const Budget& budget, bool own_writer, Move move,
            std::vector<uint8_t> widened, const TreeRange& range = {}, bool patches = false);

  // Where a facet comes from: the body's file, closing (in the file's coordinates), or closing (as the grid sees it).
  enum Origin { kOfFile, kAdded, kPlaced };
  // make_ready() appends facets to `out`, each with the units that it lies in, on any thread; add() takes what it appended. REQUIRES: the facets'
  // coordinates are in single precision if those that are kept are.
  struct Ready {
    UnfilledVector<uint8_t> facets, blocks;  // blocks: of facets that lie in one bin together
    size_t bytes() const { return facets.size() + blocks.size(); }
    void clear() { facets.clear(), blocks.clear(); }
  };
  void make_ready(std::span<const Facet> facets, uint32_t layer, Origin origin, uint32_t patch, Ready& out) const;
  // The same for blocks of a FacetWelder, in single precision if `float32`, of facets of a body's file.
  void make_ready(std::span<const uint8_t> blocks, bool float32, uint32_t layer, uint32_t patch, Ready& out) const;
  void add(const Ready& ready);
  void add(BinnedPart part);
  // To be called after the last facet.
  void finish();

  // After finish(). A node of the tree is a bin, has bins below it, or lies in a bin.
  bool is_split(const TreePlace& place) const { return !bin_at(place).children.empty(); }
  uint64_t facets(const TreePlace& place) const { return bin_at(place).facets; }  // of parts an estimate; 0 if the place is split
  bool has_facets(const TreePlace& place) const { return has_facets(bin_at(place)); }
  // Calls f with each bin of a place that has facets; this may be the place itself.
  void for_each_bin(const TreePlace& place, const std::function<void(const TreePlace&)>& f) const;
  // Calls f with all facets of a bin, some at a time. Call once.
  void take(const TreePlace& place, const std::function<void(const BinnedFacets&)>& f);
  uint64_t bytes() const { return log_.bytes(); }  // ever written
  bool in_memory() const { return log_.in_memory(); }

 private:
  struct Bin {
    TreePlace place;
    bool wanted = true;  // it lies in the range, at least in part
    uint64_t facets = 0;
    // Of a group, or less than one: facets that stand for all, and how many bins they would lie in if it were split, at two depths.
    uint64_t looked_at = 0, copies = 0, copies_next = 0;
    size_t room = 0;  // of the buffer, in bytes
    std::vector<uint8_t> buffer;  // records come from its front, blocks from its back
    size_t of_records = 0, of_blocks = 0;
    std::vector<PieceLog::Piece> pieces;  // each has blocks
    std::vector<Bin> children;  // none or kChildren
  };
  const Bin& bin_at(const TreePlace& place) const;
  static bool has_facets(const Bin& bin) {
    return bin.children.empty() ? bin.facets > 0 : std::ranges::any_of(bin.children, [](const Bin& b) { return has_facets(b); });
  }
  uint64_t bins_at(int depth) const;
  uint64_t bins_below(const TreePlace& place, int depth) const;
  void open(Bin& bin, int depth, size_t room) const;
  // The units (rays.hpp) with a facet's rays and vertices. Unlike RayRange it includes the last ones.
  struct UnitRange {
    uint32_t first_u, last_u, first_v, last_v;
  };
  UnitRange units_of(const RayRange& rays) const;
  UnitRange units_of(std::span<const uint8_t> record) const;
  uint64_t bins_met(const TreePlace& place, const UnitRange& units, int depth) const;
  bool meets(const TreePlace& place, const UnitRange& units) const;
  uint64_t facets_here(const TreePlace& place, const UnitRange& units, const BinnedPart& part) const;
  // Comes before each of the blocks that are ready.
  struct ReadyBlock {
    uint32_t u, v;  // the node that it lies in, of a depth that is known
    uint32_t looked_at, copies, copies_next;  // as a bin's
  };
  template <class F>
  static void for_each_ready(std::span<const uint8_t> blocks, F&& f) {
    ReadyBlock facts;
    while (!blocks.empty()) {
      std::memcpy(&facts, blocks.data(), sizeof facts);
      blocks = blocks.subspan(sizeof facts);
      const auto block = blocks.first(WeldedRecords::bytes_of(blocks));
      blocks = blocks.subspan(block.size());
      f(facts, block);
    }
  }
  uint64_t first_bin_of(uint64_t unit) const { return unit >> rays_.shift(first_); }  // by as many bits as a unit has, if there is one bin
  void put(Bin& bin, const UnitRange& units, std::span<const uint8_t> record, const BinnedPart* part);
  void put_here(Bin& bin, const UnitRange& units, std::span<const uint8_t> record, const BinnedPart* part);
  void put_block(Bin& bin, const ReadyBlock& facts, std::span<const uint8_t> block);
  void put_below(Bin& bin, std::span<const uint8_t> block);
  void put_facets(Bin& bin, const WeldedRecords& block);
  void split_if_large(Bin& bin);
  // The children [u0, u1] x [v0, v1] in which a facet with these units lies. REQUIRES: it lies in the bin.
  struct Children {
    uint32_t u0, u1, v0, v1;
    uint32_t count() const { return (u1 - u0 + 1) * (v1 - v0 + 1); }
  };
  Children children_of(const Bin& bin, const UnitRange& units) const;
  uint32_t bins_of(const Bin& bin, const UnitRange& units) const;
  void flush(Bin& bin);
  void flush_all(Bin& bin);
  int below(int depth) const;
  int split_depth(const Bin& bin) const;
  void split(Bin& bin);
  void split_large(Bin& bin);
  size_t room_in(uint64_t bytes) const;
  size_t room_of(const TreePlace& place, int depth, size_t room) const;
  uint64_t rooms_of(const TreePlace& place, int depth, size_t room) const;
  void take_blocks(Bin& bin, const std::function<void(std::span<const uint8_t>)>& f);
  class Dividing;  // bins_ready.cpp
  class Taking;  // bins_taken.cpp
  // A record is nine coordinates, a tag (the layer, with two bits for the origin), and the patch if patches are kept. The record of a part
  // begins with its number, and its tag has the bits that no facet has.
  static constexpr uint32_t kNotOfFile = uint32_t{1} << 31, kInPlace = uint32_t{1} << 29;
  static bool is_part(uint32_t tag) { return (tag & (kNotOfFile | kInPlace)) == kInPlace; }
  static uint32_t layer_in(uint32_t tag) { return tag & ~(kNotOfFile | kIgnored | kInPlace); }
  // The facet as the grid sees it: itself, or in `room`.
  const Facet& placed(const Facet& facet, uint32_t tag, Facet& room) const {
    return tag & kInPlace || !move_ ? facet : room = move_(facet, layer_in(tag));
  }
  void encode(const Facet& facet, uint32_t tag, uint32_t patch, std::span<uint8_t> record) const;
  static uint32_t tag_in(std::span<const uint8_t> rest);  // of a record: what follows its vertices
  uint32_t patch_in(std::span<const uint8_t> rest) const;
  const BinnedPart& part_in(std::span<const uint8_t> record) const;
  Vec3 vertex_in(std::span<const uint8_t> bytes) const;

  GridRays rays_;
  const TreeRange range_;
  const bool float32_, patches_;
  const RecordShape shape_;
  const size_t record_bytes_;
  const uint64_t most_facets_;  // of a bin that is loaded
  int fine_;  // the depth at which there are likely to be as many bins as are needed
  uint64_t rooms_, most_rooms_;  // bytes of the buffers of all bins
  const Move move_;
  RecordWelder welder_;
  UnfilledVector<uint8_t> block_;  // that was welded last
  PieceLog log_;
  std::vector<BinnedPart> parts_;
  Bin root_;
  int first_;  // the depth of the bins that there were first
  uint32_t first_u_;  // how many of them lie side by side
  std::vector<Bin*> first_bins_;  // row by row: facets need not go down to them from the root
};

}  // namespace teracell::mesher

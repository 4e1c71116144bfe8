// Counts the shells of a surface and its degenerate and duplicate facets.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "mesher/closing/facet_set.hpp"
#include "mesher/closing/vertex_hash.hpp"
#include "mesher/engines/predicates.hpp"
#include "mesher/surface/facet.hpp"
#include "store/base/groups.hpp"
#include "store/base/populate.hpp"
#include "store/grid/report.hpp"

namespace teracell::mesher {

// The numbers of vertices that came lately. Successive facets often share vertices, so this small cache avoids two of three look-ups. It has its full
// size only after some hundred vertices, because scenes of 100,000 bodies mostly have bodies with few.
// (Hashes are passed by their halves: GCC 12 writes the halves of a parameter to the stack and reads them from there as a whole, which can't be done
// before both have arrived in the cache. With 25.6 million facets a thirtieth of the samples of a profile waited for that in node_of() alone.)
class RecentVertices {
 public:
  static constexpr uint32_t kNone = ~uint32_t{0};
  // The number that was kept for the vertex; kNone if there is none.
  uint32_t number(uint64_t low, uint64_t high) const {
    const Recent& recent = recent_[low >> shift_];
    return recent.low == low && recent.high == high ? recent.number : kNone;
  }
  void keep(uint64_t low, uint64_t high, uint32_t number) {
    if (number >= kFew && recent_.size() < 512) grow();
    recent_[low >> shift_] = {low, high, number};
  }

 private:
  static constexpr uint32_t kFew = 256;
  struct Recent {
    uint64_t low = 0, high = 0;
    uint32_t number = kNone;
  };
  [[gnu::noinline]] void grow() {
    recent_.assign(512, {});
    shift_ = 55;
  }
  std::vector<Recent> recent_ = std::vector<Recent>(8);
  int shift_ = 61;  // recent_ has 2^(64 - shift) entries
};

// Numbers vertices in the order of first appearance. Vertices are equal when their coordinates are, which a 128-bit hash
// decides. A hash table with open addressing and without erasure. It grows as it fills: a table for the worst case would be
// slow in the usual case, because most of it would not be in the cache.
class VertexNumbers {
 public:
  uint32_t find_or_add(const VertexHash& hash);
  // The same for some dozens of vertices.
  void find_or_add(std::span<const VertexHash> hashes, uint32_t* numbers);
  // A call for that hash comes soon: its place in the table is asked for, and some time later what the place leads to.
  void prefetch(const VertexHash& hash) const {
    if (!table_.empty()) __builtin_prefetch(&table_[hash.low & (table_.size() - 1)]);
  }
  void prefetch_known(const VertexHash& hash) const {
    if (table_.empty()) return;
    if (const uint32_t place = table_[hash.low & (table_.size() - 1)]; place != 0) __builtin_prefetch(&hashes_[place - 1]);
  }
  // REQUIRES: a vertex with that hash has a number.
  uint32_t find(const VertexHash& hash) const;
  const VertexHash& hash(uint32_t number) const { return hashes_[number]; }
  // REQUIRES: no vertex has a number.
  void expect(uint64_t vertices) {
    rehash(std::bit_ceil(2 * vertices + 1024));
    hashes_.reserve(vertices);
  }
  uint32_t count() const { return static_cast<uint32_t>(hashes_.size()); }

 private:
  static constexpr size_t kLeastTable = 64;
  void grow();
  void rehash(size_t size);
  std::vector<VertexHash> hashes_;  // by number
  std::vector<uint32_t, Populated<uint32_t>> table_;  // number + 1; 0 is free
};

// Counts the shells of a surface: groups of facets connected by equal vertices. Facets come in any order. Memory: some 20 bytes per facet
// of a closed surface, and 40 if its facets come at random. Not thread-safe.
class ShellCounter {
 public:
  void add(const std::array<VertexHash, 3>& facet) {
    std::array<uint32_t, 3> nodes;
    for (size_t i = 0; i < 3; ++i) nodes[i] = node_of(facet[i].low, facet[i].high);
    nodes_.join(nodes[0], nodes[1], nodes[2]);
  }
  // A facet of a file that names vertices by number: a vertex is hashed once only.
  void add(const Facet& facet, const std::array<uint32_t, 3>& numbers);
  uint64_t shells();
  // The shell of a vertex: the same number for all vertices of a shell. REQUIRES: a facet with that vertex was added.
  uint32_t shell_of(const VertexHash& vertex);

 private:
  static constexpr size_t kWaiting = 16;
  struct Waiting {
    VertexHash vertex;
    uint32_t node;
  };
  uint32_t node_of(uint64_t low, uint64_t high) {
    if (const uint32_t known = recent_.number(low, high); known != RecentVertices::kNone) return known;
    const uint32_t node = first_seen(low, high);
    recent_.keep(low, high, node);
    return node;
  }
  uint32_t first_seen(uint64_t low, uint64_t high);
  void settle(const Waiting& waiting);
  void settle_all();

  Groups nodes_;  // those of one shell. A vertex has one or more
  RecentVertices recent_;  // the nodes of vertices
  std::vector<uint32_t> known_;  // node + 1 of the vertices by their numbers in the file; 0: it has not come yet
  // A vertex that was not seen lately has a new node at once. Some time later, when its place in the table has reached the cache, it is looked up
  // there, and joined to the node that it had before.
  std::array<Waiting, kWaiting> waiting_{};
  uint64_t waited_ = 0, settled_ = 0;
  VertexNumbers numbers_;
  std::vector<uint32_t> first_node_;  // of a vertex, by its number
  uint64_t numbered_ = 0;  // facets that came with numbers
};

// Decided exactly.
inline bool has_no_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (const auto& [s, t] : {std::pair(0, 1), std::pair(1, 2), std::pair(2, 0)})  // a projection with an area is enough
    if (sure_turn(a[s], a[t], b[s], b[t], c[s], c[t]) != 0) return false;
  const Facet f{{a, b, c}};
  return normal_sign(f, 2) == 0 && normal_sign(f, 1) == 0 && normal_sign(f, 0) == 0;
}
inline bool has_no_area(const Facet& f) { return has_no_area(f.vertex[0], f.vertex[1], f.vertex[2]); }

// Counts the shells of a surface and its degenerate and duplicate facets. Facets come in any order, best some dozens at once. Not thread-safe.
class SurfaceCounter {
 public:
  // Reserves memory, so that the tables need not grow. A closed surface has about half as many vertices as facets. REQUIRES: no facet was added.
  void expect(uint64_t facets) { vertices_.expect(facets / 2), shells_.reserve(facets / 2), facets_.expect(facets); }
  // Gives vertices numbers; equal ones have equal numbers.
  void number(std::span<const VertexHash> vertices, uint32_t* numbers) {
    vertices_.find_or_add(vertices, numbers);
    while (shells_.size() < vertices_.count()) shells_.add();
  }
  // Adds facets whose vertices have these numbers.
  void join(const std::array<uint32_t, 3>& numbers) { shells_.join(numbers[0], numbers[1], numbers[2]); }
  // They are counted apart, because counters of several parts of a surface may see the same facet. `keys` are FacetSet's.
  void count(std::span<const uint64_t> keys, uint64_t degenerate) { facets_.add(keys), degenerate_ += degenerate; }
  void add(const Facet& facet);

  // Facets without area, facets with the three vertices of an earlier one, those of them whose orientation is opposite to the first one's, and
  // shells.
  SurfaceCounts totals() {
    const EqualFacets equal = facets_.equal();
    return {degenerate_, equal.duplicates, equal.opposite, shells_.count()};
  }
  // The shell of the vertex with that number: the same for all vertices of a shell.
  uint32_t shell_of(uint32_t number) { return shells_.of(number); }

 private:
  VertexNumbers vertices_;
  Groups shells_;  // of vertices, by number
  FacetSet facets_;
  uint64_t degenerate_ = 0;
};

}  // namespace teracell::mesher

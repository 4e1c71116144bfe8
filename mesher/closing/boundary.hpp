// Is a surface closed? If not, which edges are its boundary?
//
// The proof takes one pass and constant memory, and facets may come in any order. Every directed edge a -> b adds a hash
// h(a, b) to a 128-bit sum, and its reverse subtracts it. So the sum is zero when every edge is matched by its reverse. (A
// zero for any other reason is a collision, with probability 2^-128 unless the surface is made to cause it.) Likewise an XOR
// over undirected edges is zero when every edge is used an even number of times. Only if a proof fails are the boundary edges
// located. Edges are put into buckets, each with such sums. Most buckets sum to zero; only edges of the others are examined.
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "mesher/closing/vertex_hash.hpp"
#include "mesher/surface/facet.hpp"
#include "store/base/populate.hpp"

namespace teracell::mesher {

class BoundaryProof {
 public:
  void add(const std::array<VertexHash, 3>& facet);
  // Every edge is matched by its reverse: the winding number is the same along every ray.
  bool directed_boundary_is_empty() const { return sum_[0] == 0 && sum_[1] == 0; }
  // Every edge is used an even number of times: so is the parity.
  bool undirected_boundary_is_empty() const { return parity_[0] == 0 && parity_[1] == 0; }

 private:
  std::array<uint64_t, 2> sum_{}, parity_{};
};

// Do facets lie on each other with opposite orientation? This is tested on a sample: all facets of a small surface, some
// 33,000 to 65,536 of a large one. They are chosen by a hash of their vertices, so that the sample holds both facets of such a pair or
// neither. The answer does not depend on the order of the facets.
class OppositeSample {
 public:
  void add(const std::array<VertexHash, 3>& facet) {
    const uint64_t low = FacetKey::low_of(facet);
    if (low > most_ || !three_different(facet)) return;
    uint64_t& waiting = waiting_[turn_++ % kWaiting];
    if (waiting != 0) keep(waiting);
    waiting = (low & ~kOrientations) | (uint64_t{1} << FacetKey::is_odd(facet));
    __builtin_prefetch(&table_[place_of(waiting)]);
  }
  // Empties the sample.
  bool take_answer();

 private:
  static constexpr size_t kMost = size_t{1} << 16, kLeastTable = 32, kWaiting = 16;
  static constexpr uint64_t kOrientations = 3;
  size_t place_of(uint64_t facet) const { return facet >> 2 & (table_.size() - 1); }
  void keep(uint64_t facet);
  void rehash(size_t size);
  uint64_t most_ = ~uint64_t{0};  // the sample holds all keys up to this one, which ends in ones: orientations don't matter
  // A hash table with open addressing, at most half full. Of a facet it has the key, whose lowest two bits are the orientations that came.
  std::vector<uint64_t, Populated<uint64_t>> table_ = std::vector<uint64_t, Populated<uint64_t>>(kLeastTable);
  size_t facets_ = 0;  // in the table
  // Facets go into the table some calls later, when their places have reached the cache.
  std::array<uint64_t, kWaiting> waiting_{};
  size_t turn_ = 0;
};

// An edge that is used more often from -> to than to -> from.
struct BoundaryEdge {
  Vec3 from, to;
  uint64_t net;   // how much more often
  uint64_t uses;  // in both directions
  bool odd() const { return uses % 2 != 0; }  // so it is a boundary by parity as well
};

// Calls its argument with every facet. May be called several times.
using FacetPass = std::function<void(const std::function<void(const Facet&)>&)>;

// The directed boundary, in ascending order of each edge's lesser vertex; the edges that are odd() are the undirected one.
// Takes two passes, and more when the edges to examine exceed `memory` bytes. Throws InputError when the boundary does.
std::vector<BoundaryEdge> boundary_edges(const FacetPass& facets, uint64_t memory, const std::string& name);

}  // namespace teracell::mesher

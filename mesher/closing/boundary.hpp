// Is a surface closed? And where it isn't: which edges are its boundary?
//
// The proof takes one pass, constant memory, any order of facets. Every directed edge a -> b adds h(a, b) to a 128-bit
// sum, its reverse subtracts it: the sum is zero when every edge is matched by its reverse (up to a collision of the
// hash, 2^-128 for surfaces not made to fool it). Likewise an XOR over undirected edges is zero when every edge is
// used an even number of times. Only when that fails are the boundary edges located, by sums over buckets of edges:
// all but those of a few buckets cancel, and only these few are looked at one by one.
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "mesher/closing/vertex_hash.hpp"

namespace teracell {

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

// Do facets lie on each other with opposite orientation? A sample of them by a hash of their vertices, so that both of such
// a pair are in it or none: all facets of a small surface, some 65,536 of a large one. The answer does not depend on the
// order of the facets.
class OppositeSample {
 public:
  void add(const std::array<VertexHash, 3>& facet) {
    const uint64_t low = FacetKey::low_of(facet);
    if (low <= most_ && three_different(facet)) keep((low & ~uint64_t{1}) | FacetKey::is_odd(facet));
  }
  // Then it is empty again.
  bool take_answer();

 private:
  static constexpr size_t kFacets = size_t{1} << 16;
  void keep(uint64_t facet);
  void shrink();
  uint64_t most_ = ~uint64_t{0};  // the sample has the keys up to this one
  std::vector<uint64_t> facets_;  // keys; the lowest bit tells which way round
};

// An edge that is used more often from -> to than to -> from.
struct BoundaryEdge {
  Vec3 from, to;
  uint64_t net;   // by how much
  uint64_t uses;  // in all
  bool odd() const { return uses % 2 != 0; }  // so it bounds the parity as well
};

// Calls its argument with every facet, each time anew.
using FacetPass = std::function<void(const std::function<void(const Facet&)>&)>;

// The directed boundary, ascending by its lesser vertex; the undirected one is the part of it that is odd(). Takes two
// passes, more when the edges to look at exceed `memory` bytes at once. InputError when the boundary itself does.
std::vector<BoundaryEdge> boundary_edges(const FacetPass& facets, uint64_t memory, const std::string& name);

}  // namespace teracell

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
#include <span>
#include <vector>

#include "mesher/closing/vertex_hash.hpp"
#include "mesher/surface/facet.hpp"

namespace teracell::mesher {

class BoundaryProof {
 public:
  void add(const std::array<VertexHash, 3>& facet);
  // The same for facets that come together, faster for some dozens.
  void add(std::span<const std::array<VertexHash, 3>> facets);
  // The facets of another part of the surface.
  void add(const BoundaryProof& other) {
    for (size_t i = 0; i < 2; ++i) sum_[i] += other.sum_[i], parity_[i] ^= other.parity_[i];
  }
  // Every edge is matched by its reverse: the winding number is the same along every ray.
  bool directed_boundary_is_empty() const { return sum_[0] == 0 && sum_[1] == 0; }
  // Every edge is used an even number of times: so is the parity.
  bool undirected_boundary_is_empty() const { return parity_[0] == 0 && parity_[1] == 0; }

 private:
  std::array<uint64_t, 2> sum_{}, parity_{};
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

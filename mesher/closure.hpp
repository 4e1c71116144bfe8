// Is a surface closed? One pass, constant memory, any order of facets.
//
// Every directed edge a -> b adds h(a, b) to a 128-bit sum, its reverse subtracts it: the sum is zero when every edge is
// matched by its reverse (up to a collision of the hash, 2^-128 for surfaces not made to fool it). Likewise an XOR
// over undirected edges is zero when every edge is used an even number of times. Only when neither is zero are the
// boundary edges located, which costs memory by the edge.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "mesher/facets.hpp"

namespace teracell {

class BoundaryProof {
 public:
  void add(const Facet& facet);
  // Every edge is matched by its reverse: the winding number is the same along every ray.
  bool directed_boundary_is_empty() const { return sum_[0] == 0 && sum_[1] == 0; }
  // Every edge is used an even number of times: so is the parity.
  bool undirected_boundary_is_empty() const { return parity_[0] == 0 && parity_[1] == 0; }

 private:
  std::array<uint64_t, 2> sum_{}, parity_{};
};

// The edges that leave a surface open under one of the rules.
class BoundaryEdges {
 public:
  struct Edge {
    Vec3 from, to;
    int count;  // directed: net number of uses from -> to, positive; undirected: number of uses
  };
  void add(const Facet& facet);
  std::vector<Edge> directed() const;    // net count not 0
  std::vector<Edge> undirected() const;  // used an odd number of times

 private:
  struct Use {
    Vec3 lo, hi;  // lo < hi lexicographically
    bool forward;
  };
  mutable std::vector<Use> uses_;
};

}  // namespace teracell

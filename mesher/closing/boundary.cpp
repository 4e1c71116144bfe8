#include "mesher/closing/boundary.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/system/vector_units.hpp"

namespace teracell::mesher {
namespace {

// Calls f(hash, forward, i) for the edge from vertex i to the next one. An edge and its reverse have the same hash; `forward`
// is true for one of the two.
template <class F>
void for_each_edge(const std::array<VertexHash, 3>& h, F&& f) {
  for (int i = 0; i < 3; ++i) {
    VertexHash a = h[i], b = h[(i + 1) % 3];
    if (a == b) continue;  // an edge without length is none
    const bool forward = a < b;
    if (!forward) std::swap(a, b);
    f(std::array{fold(a.low ^ kHashKeys[0], b.low ^ kHashKeys[1]), fold(a.high ^ kHashKeys[2], b.high ^ kHashKeys[3])}, forward, i);
  }
}

struct Bucket {
  uint64_t sum = 0, parity = 0, uses = 0;
};
constexpr int kBucketBits = 16;

// One use of an edge by a facet; lo < hi lexicographically.
struct Use {
  Vec3 lo, hi;
  bool forward;
};

void append_boundary(std::vector<Use>& uses, std::vector<BoundaryEdge>& out) {
  std::ranges::sort(uses, [](const Use& a, const Use& b) { return std::tie(a.lo, a.hi) < std::tie(b.lo, b.hi); });
  for (size_t i = 0; i < uses.size();) {
    const Use& edge = uses[i];
    int64_t net = 0;
    const size_t first = i;
    for (; i < uses.size() && uses[i].lo == edge.lo && uses[i].hi == edge.hi; ++i) net += uses[i].forward ? 1 : -1;
    if (net > 0) out.push_back({edge.lo, edge.hi, static_cast<uint64_t>(net), i - first});
    if (net < 0) out.push_back({edge.hi, edge.lo, static_cast<uint64_t>(-net), i - first});
  }
}

// Of an edge, by halves of the hashes of its ends, one or some side by side: what is added to a sum, and to a parity. Without a branch, since which
// end has the greater hash can't be predicted. An edge without length adds nothing. The sum of the ends is mixed as MurmurHash3, by A. Appleby, ends:
// by multiplications of 64 bits, which vector units have.
template <class Words>
TERACELL_IN_LINE inline void add_edge(const Words& a, const Words& b, Words& sum, Words& parity) {
  Words edge = a + b;
  edge = (edge ^ edge >> 33) * 0xff51afd7ed558ccd;
  edge = (edge ^ edge >> 33) * 0xc4ceb9fe1a85ec53;
  edge ^= edge >> 33;
  Words forward, backward;
  if constexpr (sizeof(Words) == sizeof(uint64_t)) forward = a < b ? edge : 0, backward = b < a ? edge : 0;
  else forward = edge & (Words)(a < b), backward = edge & (Words)(b < a);
  sum += forward - backward;
  parity ^= forward | backward;
}

}  // namespace

// Each half of the vertices' hashes has a sum and a parity of its own.
void BoundaryProof::add(const std::array<VertexHash, 3>& facet) {
  for (size_t k = 0; k < 3; ++k) {
    const VertexHash &a = facet[k], &b = facet[(k + 1) % 3];
    add_edge(a.low, b.low, sum_[0], parity_[0]);
    add_edge(a.high, b.high, sum_[1], parity_[1]);
  }
}

void BoundaryProof::add(std::span<const std::array<VertexHash, 3>> facets) {
  constexpr size_t kAtOnce = 64;
  using Lanes [[gnu::vector_size(64)]] = uint64_t;
  constexpr size_t kLanes = sizeof(Lanes) / sizeof(uint64_t);
  for (; !facets.empty(); facets = facets.subspan(std::min(kAtOnce, facets.size()))) {
    const auto some = facets.first(std::min(kAtOnce, facets.size()));
    const size_t blocks = (some.size() + kLanes - 1) / kLanes;
    alignas(Lanes) uint64_t halves[2][3][kAtOnce];  // by half and vertex; vertices of facets that there are not are equal
    for (size_t i = 0; i < blocks * kLanes; ++i)
      for (size_t k = 0; k < 3; ++k) {
        const VertexHash hash = i < some.size() ? some[i][k] : VertexHash();
        halves[0][k][i] = hash.low, halves[1][k][i] = hash.high;
      }
    on_vector_unit([&, this]() TERACELL_IN_LINE {
      for (size_t half = 0; half < 2; ++half) {
        Lanes sum{}, parity{};
        for (size_t i = 0; i < blocks * kLanes; i += kLanes) {
          Lanes v[3];
          for (size_t k = 0; k < 3; ++k) __builtin_memcpy(&v[k], &halves[half][k][i], sizeof v[k]);
          for (size_t k = 0; k < 3; ++k) add_edge(v[k], v[(k + 1) % 3], sum, parity);
        }
        for (size_t lane = 0; lane < kLanes; ++lane) sum_[half] += sum[lane], parity_[half] ^= parity[lane];
      }
    });
  }
}

std::vector<BoundaryEdge> boundary_edges(const FacetPass& facets, uint64_t memory, const std::string& name) {
  std::vector<Bucket> buckets(size_t{1} << kBucketBits);
  const auto bucket_of = [](const std::array<uint64_t, 2>& edge) { return edge[1] >> (64 - kBucketBits); };
  facets([&](const Facet& facet) {
    for_each_edge(vertex_hashes(facet), [&](const std::array<uint64_t, 2>& edge, bool forward, int) {
      Bucket& b = buckets[bucket_of(edge)];
      b.sum += forward ? edge[0] : -edge[0];
      b.parity ^= edge[0];
      ++b.uses;
    });
  });

  std::vector<BoundaryEdge> out;
  std::vector<Use> uses;
  std::vector<bool> wanted(buckets.size());
  for (size_t next = 0; next < buckets.size();) {
    uint64_t bytes = 0;
    std::fill(wanted.begin(), wanted.end(), false);
    for (; next < buckets.size() && bytes <= memory; ++next) {
      if (buckets[next].sum == 0 && buckets[next].parity == 0) continue;
      wanted[next] = true;
      bytes += buckets[next].uses * sizeof(Use);
    }
    if (bytes == 0) break;
    uses.clear();
    uses.reserve(bytes / sizeof(Use));
    facets([&](const Facet& facet) {
      for_each_edge(vertex_hashes(facet), [&](const std::array<uint64_t, 2>& edge, bool, int i) {
        if (!wanted[bucket_of(edge)]) return;
        const Vec3 &a = facet.vertex[i], &b = facet.vertex[(i + 1) % 3];
        uses.push_back(a < b ? Use{a, b, true} : Use{b, a, false});
      });
    });
    append_boundary(uses, out);
    if (out.size() * sizeof(BoundaryEdge) > memory)
      throw InputError(fmt::format(
          "{}: the surface has more than {} open edges, too many for the memory given. If its facets are loose, weld equal vertices; if not, allow more memory",
          name, out.size()));
  }
  std::ranges::sort(out, {}, [](const BoundaryEdge& e) { return std::pair(std::min(e.from, e.to), std::max(e.from, e.to)); });
  return out;
}

}  // namespace teracell::mesher

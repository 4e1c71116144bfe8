#include "mesher/closure.hpp"

#include <algorithm>

#include <xxhash.h>

namespace teracell {
namespace {

// The folded 128-bit product: a cheap mix that depends on the order of its arguments through the constants.
uint64_t fold(uint64_t a, uint64_t b) {
  const unsigned __int128 p = static_cast<unsigned __int128>(a) * b;
  return static_cast<uint64_t>(p) ^ static_cast<uint64_t>(p >> 64);
}

constexpr uint64_t kMix[4] = {0xA0761D6478BD642F, 0xE7037ED1A0B428DB, 0x8EBC6AF09C88C6E3, 0x589965CC75374CC3};

}  // namespace

void BoundaryProof::add(const Facet& facet) {
  XXH128_hash_t h[3];
  for (int i = 0; i < 3; ++i) h[i] = XXH3_128bits(facet.vertex[i].data(), sizeof(Vec3));
  for (int i = 0; i < 3; ++i) {
    XXH128_hash_t a = h[i], b = h[(i + 1) % 3];
    if (facet.vertex[i] == facet.vertex[(i + 1) % 3]) continue;  // no length, no edge
    const bool forward = a.low64 < b.low64 || (a.low64 == b.low64 && a.high64 < b.high64);
    if (!forward) std::swap(a, b);
    const uint64_t edge[2] = {fold(a.low64 ^ kMix[0], b.low64 ^ kMix[1]), fold(a.high64 ^ kMix[2], b.high64 ^ kMix[3])};
    for (int lane = 0; lane < 2; ++lane) {
      sum_[lane] += forward ? edge[lane] : -edge[lane];
      parity_[lane] ^= edge[lane];
    }
  }
}

void BoundaryEdges::add(const Facet& facet) {
  for (int i = 0; i < 3; ++i) {
    const Vec3 &a = facet.vertex[i], &b = facet.vertex[(i + 1) % 3];
    if (a < b) uses_.push_back({a, b, true});
    else if (b < a) uses_.push_back({b, a, false});
  }
}

namespace {

template <class Use, class F>
void for_each_edge(std::vector<Use>& uses, F&& f) {
  std::ranges::sort(uses, [](const Use& a, const Use& b) { return std::tie(a.lo, a.hi) < std::tie(b.lo, b.hi); });
  for (size_t i = 0; i < uses.size();) {
    int net = 0, count = 0;
    const Use& edge = uses[i];
    for (; i < uses.size() && uses[i].lo == edge.lo && uses[i].hi == edge.hi; ++i) {
      net += uses[i].forward ? 1 : -1;
      ++count;
    }
    f(edge, net, count);
  }
}

}  // namespace

std::vector<BoundaryEdges::Edge> BoundaryEdges::directed() const {
  std::vector<Edge> edges;
  for_each_edge(uses_, [&](const Use& e, int net, int) {
    if (net > 0) edges.push_back({e.lo, e.hi, net});
    if (net < 0) edges.push_back({e.hi, e.lo, -net});
  });
  return edges;
}

std::vector<BoundaryEdges::Edge> BoundaryEdges::undirected() const {
  std::vector<Edge> edges;
  for_each_edge(uses_, [&](const Use& e, int, int count) {
    if (count % 2 != 0) edges.push_back({e.lo, e.hi, count});
  });
  return edges;
}

}  // namespace teracell

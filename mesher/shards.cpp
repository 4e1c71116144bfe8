#include "mesher/shards.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace teracell {
namespace {

constexpr uint32_t kMostNodes = 256;  // along u and v
// In units of a quarter of the time that a crossing takes, measured with one thread. A group without facets still has chunks to be made
// and places in the index. A facet costs something in each tile that it may meet.
constexpr uint64_t kCrossing = 4, kFacetInTile = 4, kGroup = 1500;

double doubled_area(const Facet& f, int u, int v) {
  const auto& [a, b, c] = f.vertex;
  return std::abs((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]));
}

}  // namespace

std::string Shard::name() const { return fmt::format("shard-{}-of-{}", number, of); }

CostMap::CostMap(const Metadata& meta, std::vector<bool> widened) : rays_(meta, std::move(widened)) {
  const auto count = [&](uint32_t rays) { return static_cast<uint32_t>((rays + rays_.size(height_) - 1) / rays_.size(height_)); };
  while (count(std::max(rays_.shape.nu, rays_.shape.nv)) > kMostNodes) ++height_;
  nodes_u_ = count(rays_.shape.nu), nodes_v_ = count(rays_.shape.nv);
  cost_.resize(size_t{nodes_u_} * nodes_v_);
  const uint64_t side = rays_.size(height_), group = rays_.size(0);
  for (uint32_t v = 0; v < nodes_v_; ++v)
    for (uint32_t u = 0; u < nodes_u_; ++u) {
      const auto groups = [&](uint32_t c, uint32_t rays) { return (std::min<uint64_t>(side, rays - c * side) + group - 1) / group; };
      cost_[size_t{v} * nodes_u_ + u] = kGroup * groups(u, rays_.shape.nu) * groups(v, rays_.shape.nv);
    }
}

// The crossings of a facet are spread evenly over the box of its rays.
void CostMap::add(const Facet& facet, uint32_t layer) {
  if (layer & kIgnored) return;
  const RayRange r = rays_.range_of(facet, layer);
  if (r.empty()) return;
  const auto& [a, b, c] = facet.vertex;
  const auto extent = [&](int d) { return std::max({a[d], b[d], c[d]}) - std::min({a[d], b[d], c[d]}); };
  const int u = rays_.frame.u, v = rays_.frame.v;
  const double box = extent(u) * extent(v);
  const double share = box > 0 ? std::min(1.0, doubled_area(facet, u, v) / 2 / box) : 0;  // of the rays in the box that meet the facet
  const uint64_t side = rays_.size(height_);
  for (uint64_t j = r.v0 / side; j * side < r.v1; ++j)
    for (uint64_t i = r.u0 / side; i * side < r.u1; ++i) {
      const uint64_t wide = std::min<uint64_t>(r.u1, (i + 1) * side) - std::max<uint64_t>(r.u0, i * side),
                     high = std::min<uint64_t>(r.v1, (j + 1) * side) - std::max<uint64_t>(r.v0, j * side), tile = rays_.shape.chunk_rays;
      const auto crossings = static_cast<uint64_t>(share * static_cast<double>(kCrossing * wide * high));
      cost_[j * nodes_u_ + i] += crossings + kFacetInTile * ((wide + tile - 1) / tile) * ((high + tile - 1) / tile);
    }
}

// Within a node the cost is taken to be even.
TreeRange CostMap::stretch(const Shard& shard) const {
  std::vector<std::pair<uint64_t, uint64_t>> nodes;  // key, cost
  for (uint32_t v = 0; v < nodes_v_; ++v)
    for (uint32_t u = 0; u < nodes_u_; ++u) nodes.push_back({tree_key(u, v), cost_[size_t{v} * nodes_u_ + u]});
  std::ranges::sort(nodes);
  unsigned __int128 all = 0;
  for (const auto& [key, cost] : nodes) all += cost;
  const int shift = 2 * kFanOutBits * height_;
  const auto cut = [&](uint32_t number) -> uint64_t {  // the key at which part `number` begins
    if (number == 0) return 0;
    if (number == shard.of) return ~uint64_t{0};
    unsigned __int128 wanted = all * number / shard.of;
    for (const auto& [key, cost] : nodes) {
      if (wanted < cost) return (key << shift) + static_cast<uint64_t>((wanted << shift) / cost);
      wanted -= cost;
    }
    return ~uint64_t{0};
  };
  return {cut(shard.number), cut(shard.number + 1)};
}

}  // namespace teracell

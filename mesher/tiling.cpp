#include "mesher/tiling.hpp"

#include <numeric>

namespace teracell {

Tiling::Tiling(const Metadata& meta) : rays_(meta) {
  units_u_ = (rays_.shape.chunks_u + 3) / 4;
  units_v_ = (rays_.shape.chunks_v + 3) / 4;
  units_ = uint64_t{units_u_} * units_v_;
}

Tiling::Tiling(std::shared_ptr<const FacetStore> facets, const Metadata& meta) : Tiling(meta) {
  path_.push_back(node_of(rays_.root(), std::move(facets)));
}

Tiling::Tiling(std::unique_ptr<FacetBins> bins, BinObserver observer, const Metadata& meta) : Tiling(meta) {
  bins_ = std::move(bins);
  observer_ = std::move(observer);
  path_.push_back({rays_.root(), nullptr, {}});
}

// The node lists facets from the lowest to the highest along the rays, to a 4096th of the grid, and every list made
// from it does so too: the crossings of a ray then come out nearly sorted, which makes sorting them four times cheaper.
Tiling::Node Tiling::node_of(const TreePlace& place, std::shared_ptr<const FacetStore> facets) const {
  constexpr uint32_t kHeights = 4096;
  constexpr uint16_t kNone = kHeights;  // slips between the rays
  const int w = rays_.frame.w;
  const double lowest = rays_.w.min(), per_height = kHeights / (rays_.w.max() - lowest);
  const auto block = std::make_shared<FacetBlock>();
  std::vector<uint16_t> heights;
  std::vector<uint32_t> order(kHeights + 2);
  block->rays.reserve(facets->size());
  heights.reserve(facets->size());
  facets->for_each(0, facets->size(), [&](const SceneFacet& facet) {
    const auto& [a, b, c] = facet.facet.vertex;
    const RayRange r = rays_.range_of(facet.facet);
    const double height = (std::min({a[w], b[w], c[w]}) - lowest) * per_height;
    const uint16_t h = r.empty() ? kNone : static_cast<uint16_t>(std::clamp(height, 0.0, kHeights - 1.0));
    block->rays.push_back(r);
    heights.push_back(h);
    ++order[h + 1];
  });
  std::partial_sum(order.begin(), order.end(), order.begin());
  Node node{place, block, std::vector<uint32_t>(order[kNone])};
  for (uint32_t i = 0; i < heights.size(); ++i)
    if (heights[i] != kNone) node.facets[order[heights[i]]++] = i;
  block->facets = std::move(facets);
  return node;
}

Tiling::Node Tiling::load(const TreePlace& place) {
  const auto binned = std::make_shared<std::vector<BinnedFacet>>();
  const auto store = std::make_shared<FacetStore>();
  bins_->take(place, [&](const BinnedFacet& f, const Facet& moved) {
    if (!rays_.range_of(moved).empty()) store->append({&moved, 1}, f.layer);
    binned->push_back(f);
  });
  observer_(binned);
  return node_of(place, store);
}

std::optional<Unit> Tiling::next() {
  while (!path_.empty()) {
    Node node = std::move(path_.back());
    path_.pop_back();
    if (!node.block && !bins_->is_split(node.place)) node = load(node.place);
    if (node.place.depth == 0) return Unit{node.place.cu, node.place.cv, std::move(node.block), std::move(node.facets)};
    push_children(std::move(node));
  }
  return std::nullopt;
}

namespace {

// Calls f(child, facet) for all of a place's 4 x 4 children, of `size` rays, in the rows [first_row, last_row], that a facet may meet.
template <class F>
void bin(const std::vector<uint32_t>& facets, const std::vector<RayRange>& rays, uint32_t cu, uint32_t cv, uint32_t size, uint32_t first_row, uint32_t last_row, F&& f) {
  const uint32_t first_u = cu * 4, first_v = cv * 4;
  for (const uint32_t i : facets) {
    const RayRange& r = rays[i];
    const uint32_t u0 = std::max(r.u0 / size, first_u), u1 = std::min((r.u1 - 1) / size, first_u + 3);
    const uint32_t v0 = std::max(r.v0 / size, first_v + first_row), v1 = std::min((r.v1 - 1) / size, first_v + last_row);
    for (uint32_t v = v0; v <= v1; ++v)
      for (uint32_t u = u0; u <= u1; ++u) f((v - first_v) * 4 + u - first_u, i);
  }
}

}  // namespace

void Tiling::push_children(Node node) {
  const TreePlace& at = node.place;
  const int depth = at.depth - 1;
  std::array<std::vector<uint32_t>, 16> lists;
  if (node.block)
    bin(node.facets, node.block->rays, at.cu, at.cv, static_cast<uint32_t>(rays_.size(depth)), 0, 3, [&](uint32_t child, uint32_t facet) { lists[child].push_back(facet); });
  for (uint32_t k = 16; k-- > 0;) {  // the last one first: it is a stack
    const TreePlace child{depth, at.cu * 4 + k % 4, at.cv * 4 + k / 4};
    if (uint64_t{child.cu} << (2 * depth) < units_u_ && uint64_t{child.cv} << (2 * depth) < units_v_) path_.push_back({child, node.block, std::move(lists[k])});
  }
}

std::array<std::vector<const SceneFacet*>, 4> Tiling::split(const Unit& unit, uint32_t row) const {
  std::array<std::vector<const SceneFacet*>, 4> lists;
  bin(unit.facets, unit.block->rays, unit.cu, unit.cv, rays_.shape.chunk_rays, row, row,
      [&](uint32_t chunk, uint32_t facet) { lists[chunk % 4].push_back(&(*unit.block->facets)[facet]); });
  return lists;
}

}  // namespace teracell

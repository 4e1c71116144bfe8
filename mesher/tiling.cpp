#include "mesher/tiling.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace teracell {

namespace {

// Finds rays by coordinate with a multiplication and a margin for its roundings: never too few, seldom one too many.
class RayFinder {
 public:
  explicit RayFinder(const Axis& axis) : axis_(axis) {
    if (axis.is_graded()) return;
    per_ray_ = 1 / axis.step();
    const double offset = static_cast<double>(axis.first()) + axis.sample(), n = static_cast<double>(axis.cells());
    margin_ = 0x1p-48 * (std::abs(axis.origin()) * per_ray_ + offset + n + 1);
    from_ = offset + margin_;
    to_ = offset - margin_;
  }
  uint32_t first(double lo) const { return axis_.is_graded() ? static_cast<uint32_t>(axis_.first_centre_from(lo)) : ceil((lo - axis_.origin()) * per_ray_ - from_); }
  uint32_t last(double hi) const { return axis_.is_graded() ? static_cast<uint32_t>(axis_.first_centre_from(hi)) : ceil((hi - axis_.origin()) * per_ray_ - to_); }

 private:
  uint32_t ceil(double t) const {
    t = std::clamp(t, 0.0, static_cast<double>(axis_.cells()));
    const auto whole = static_cast<int32_t>(t);
    return static_cast<uint32_t>(whole) + (t > whole);
  }
  const Axis& axis_;
  double per_ray_ = 0, margin_ = 0, from_ = 0, to_ = 0;
};

}  // namespace

Tiling::Tiling(const FacetStore& facets, const Metadata& meta) : facets_(facets), shape_(meta, 0) {
  const Frame f = meta.frame();
  const RayFinder u(meta.grid.axis[f.u]), v(meta.grid.axis[f.v]);
  // The root lists facets from the lowest to the highest along the rays, to a 4096th of the grid, and every list made
  // from it does so too: the crossings of a ray then come out nearly sorted, which makes sorting them four times cheaper.
  constexpr uint32_t kHeights = 4096;
  constexpr uint16_t kNone = kHeights;  // slips between the rays
  const Axis& w = meta.grid.axis[f.w];
  const double per_height = kHeights / (w.max() - w.min());
  std::vector<uint16_t> heights;
  std::vector<uint32_t> place(kHeights + 2);
  rays_.reserve(facets.size());
  heights.reserve(facets.size());
  facets.for_each(0, facets.size(), [&](const SceneFacet& facet) {
    const auto& [a, b, c] = facet.facet.vertex;
    const auto [u_lo, u_hi] = std::minmax({a[f.u], b[f.u], c[f.u]});
    const auto [v_lo, v_hi] = std::minmax({a[f.v], b[f.v], c[f.v]});
    const Rays r{u.first(u_lo), u.last(u_hi), v.first(v_lo), v.last(v_hi)};
    const double height = (std::min({a[f.w], b[f.w], c[f.w]}) - w.min()) * per_height;
    const uint16_t h = r.u0 < r.u1 && r.v0 < r.v1 ? static_cast<uint16_t>(std::clamp(height, 0.0, kHeights - 1.0)) : kNone;
    rays_.push_back(r);
    heights.push_back(h);
    ++place[h + 1];
  });
  std::partial_sum(place.begin(), place.end(), place.begin());
  Node root{0, 0, 0, std::vector<uint32_t>(place[kNone])};
  for (uint32_t i = 0; i < heights.size(); ++i)
    if (heights[i] != kNone) root.facets[place[heights[i]]++] = i;
  units_u_ = (shape_.chunks_u + 3) / 4;
  units_v_ = (shape_.chunks_v + 3) / 4;
  units_ = uint64_t{units_u_} * units_v_;
  while ((std::max(units_u_, units_v_) - 1) >> (2 * root.depth) != 0) ++root.depth;
  path_.push_back(std::move(root));
}

std::optional<Unit> Tiling::next() {
  while (!path_.empty()) {
    Node node = std::move(path_.back());
    path_.pop_back();
    if (node.depth == 0) return Unit{node.cu, node.cv, std::move(node.facets)};
    push_children(std::move(node));
  }
  return std::nullopt;
}

template <class F>
void Tiling::bin(const std::vector<uint32_t>& facets, uint32_t cu, uint32_t cv, uint32_t size, uint32_t first_row, uint32_t last_row, F&& f) const {
  const uint32_t first_u = cu * 4, first_v = cv * 4;
  for (const uint32_t i : facets) {
    const Rays& r = rays_[i];
    const uint32_t u0 = std::max(r.u0 / size, first_u), u1 = std::min((r.u1 - 1) / size, first_u + 3);
    const uint32_t v0 = std::max(r.v0 / size, first_v + first_row), v1 = std::min((r.v1 - 1) / size, first_v + last_row);
    for (uint32_t v = v0; v <= v1; ++v)
      for (uint32_t u = u0; u <= u1; ++u) f((v - first_v) * 4 + u - first_u, i);
  }
}

void Tiling::push_children(Node node) {
  const int depth = node.depth - 1;
  std::array<std::vector<uint32_t>, 16> lists;
  bin(node.facets, node.cu, node.cv, 4 * shape_.chunk_rays << (2 * depth), 0, 3, [&](uint32_t child, uint32_t facet) { lists[child].push_back(facet); });
  for (uint32_t k = 16; k-- > 0;) {  // the last one first: it is a stack
    const uint32_t cu = node.cu * 4 + k % 4, cv = node.cv * 4 + k / 4;
    if (uint64_t{cu} << (2 * depth) < units_u_ && uint64_t{cv} << (2 * depth) < units_v_) path_.push_back({depth, cu, cv, std::move(lists[k])});
  }
}

std::array<std::vector<const SceneFacet*>, 4> Tiling::split(const Unit& unit, uint32_t row) const {
  std::array<std::vector<const SceneFacet*>, 4> lists;
  bin(unit.facets, unit.cu, unit.cv, shape_.chunk_rays, row, row, [&](uint32_t chunk, uint32_t facet) { lists[chunk % 4].push_back(&facets_[facet]); });
  return lists;
}

}  // namespace teracell

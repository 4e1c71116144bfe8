#include "mesher/tiling.hpp"

#include <algorithm>

namespace teracell {

Tiling::Tiling(const std::vector<SceneFacet>& facets, const Metadata& meta) : facets_(facets), shape_(meta, 0), frame_w_(meta.frame().w) {
  const Frame f = meta.frame();
  const Axis &u = meta.grid.axis[f.u], &v = meta.grid.axis[f.v];
  rays_.reserve(facets.size());
  for (const SceneFacet& facet : facets) {
    const auto& [a, b, c] = facet.facet.vertex;
    const auto [u_lo, u_hi] = std::minmax({a[f.u], b[f.u], c[f.u]});
    const auto [v_lo, v_hi] = std::minmax({a[f.v], b[f.v], c[f.v]});
    rays_.push_back({static_cast<uint32_t>(u.first_centre_from(u_lo)), static_cast<uint32_t>(u.first_centre_from(u_hi)),
                     static_cast<uint32_t>(v.first_centre_from(v_lo)), static_cast<uint32_t>(v.first_centre_from(v_hi))});
  }
  units_u_ = (shape_.chunks_u + 3) / 4;
  units_v_ = (shape_.chunks_v + 3) / 4;
  units_ = uint64_t{units_u_} * units_v_;
  Node root{0, 0, 0, {}};
  while ((std::max(units_u_, units_v_) - 1) >> (2 * root.depth) != 0) ++root.depth;
  for (uint32_t i = 0; i < facets.size(); ++i)
    if (rays_[i].u0 < rays_[i].u1 && rays_[i].v0 < rays_[i].v1) root.facets.push_back(i);  // the others slip between the rays
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

void Tiling::push_children(Node node) {
  const int depth = node.depth - 1;
  const uint32_t size = 4 * shape_.chunk_rays << (2 * depth);  // of a child, in rays
  const uint32_t first_u = node.cu * 4, first_v = node.cv * 4;
  std::array<std::vector<uint32_t>, 16> lists;
  for (const uint32_t i : node.facets) {
    const Rays& r = rays_[i];
    const uint32_t u0 = std::max(r.u0 / size, first_u), u1 = std::min((r.u1 - 1) / size, first_u + 3);
    const uint32_t v0 = std::max(r.v0 / size, first_v), v1 = std::min((r.v1 - 1) / size, first_v + 3);
    for (uint32_t v = v0; v <= v1; ++v)
      for (uint32_t u = u0; u <= u1; ++u) lists[(v - first_v) * 4 + u - first_u].push_back(i);
  }
  for (uint32_t k = 16; k-- > 0;) {  // the last one first: it is a stack
    const uint32_t cu = first_u + k % 4, cv = first_v + k / 4;
    if (uint64_t{cu} << (2 * depth) < units_u_ && uint64_t{cv} << (2 * depth) < units_v_) path_.push_back({depth, cu, cv, std::move(lists[k])});
  }
}

std::array<std::vector<const SceneFacet*>, 16> Tiling::split(const Unit& unit) const {
  std::array<std::vector<const SceneFacet*>, 16> lists;
  const uint32_t size = shape_.chunk_rays, first_u = unit.cu * 4, first_v = unit.cv * 4;
  for (const uint32_t i : unit.facets) {
    const Rays& r = rays_[i];
    const uint32_t u0 = std::max(r.u0 / size, first_u), u1 = std::min((r.u1 - 1) / size, first_u + 3);
    const uint32_t v0 = std::max(r.v0 / size, first_v), v1 = std::min((r.v1 - 1) / size, first_v + 3);
    for (uint32_t v = v0; v <= v1; ++v)
      for (uint32_t u = u0; u <= u1; ++u) lists[(v - first_v) * 4 + u - first_u].push_back(&facets_[i]);
  }
  // Lowest first: the crossings of a ray then come out nearly sorted, which makes sorting them four times cheaper.
  const int w = frame_w_;
  const auto low = [w](const SceneFacet* f) { return std::min({f->facet.vertex[0][w], f->facet.vertex[1][w], f->facet.vertex[2][w]}); };
  std::vector<std::pair<double, const SceneFacet*>> order;
  for (auto& list : lists) {
    order.clear();
    for (const SceneFacet* f : list) order.emplace_back(low(f), f);
    std::ranges::sort(order);
    for (size_t i = 0; i < list.size(); ++i) list[i] = order[i].second;
  }
  return lists;
}

}  // namespace teracell

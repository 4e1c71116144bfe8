#include "mesher/overlaps/tile_overlaps.hpp"

namespace teracell::mesher {
TileOverlaps::TileOverlaps(size_t bodies, int ray_axis) : frame_(RayFrame::along(ray_axis)), left_(bodies) {
  int at = 0;
  for (int d = 0; d < 3; ++d) {
    shift_[d] = at;
    at += d == frame_.w ? 32 : 8;
  }
}

// The entry of `other`. Others are asked for by descending rank; `next` is 0 at first.
TileOverlaps::Common& TileOverlaps::common(std::vector<Common>& list, size_t& next, const Inside& other) {
  if (next == list.size() || list[next].rank != other.rank) {
    auto place = std::ranges::lower_bound(list, other.rank, std::ranges::greater{}, &Common::rank);
    if (place == list.end() || place->rank != other.rank) place = list.insert(place, {other.rank, other.body, false, {}});
    next = static_cast<size_t>(place - list.begin());
  }
  return list[next++];
}

void TileOverlaps::list_group(uint32_t rank, Left& left) {
  size_t next = 0;
  for (const Inside& other : left.group) {
    Common& c = common(left.list, next, other);
    c.stretches.add(left.of_group);
    c.third |= left.owner != std::min(rank, other.rank);
  }
  left.group.clear();
  left.of_group = {};
}

Overlap TileOverlaps::overlap(uint32_t body, const Common& common, const Box& cells) const {
  const Stretches& s = common.stretches;
  Overlap out;
  out.bodies = {std::min(body, common.body), std::max(body, common.body)};
  out.third = common.third;
  out.cells = s.cells;
  const auto along = [&](int d, uint32_t lo, uint32_t hi) { out.box.lo[d] = cells.lo[d] + lo, out.box.hi[d] = cells.lo[d] + hi; };
  along(frame_.u, s.u0, uint32_t{s.u1} + 1), along(frame_.v, s.v0, uint32_t{s.v1} + 1), along(frame_.w, s.from, s.to);
  for (int d = 0; d < 3; ++d) out.at[d] = cells.lo[d] + static_cast<int64_t>(s.first >> shift_[d] & (d == frame_.w ? 0xFFFFFFFF : 0xFF));
  return out;
}

Bytes TileOverlaps::take(const Box& cells) {
  std::vector<Overlap> all;
  for (const Inside& body : met_) {
    Left& left = left_[body.body];
    list_group(body.rank, left);
    for (const Common& c : left.list) all.push_back(overlap(body.body, c, cells));
    left = {};
  }
  met_.clear();
  std::ranges::sort(all, {}, &Overlap::bodies);
  OverlapPacker packer;
  for (size_t i = 0; i < all.size();) {  // a pair comes twice where some rays leave one body first and some the other
    Overlap& sum = all[i];
    while (++i < all.size() && all[i].bodies == sum.bodies) sum.add(all[i]);
    packer.put(sum);
  }
  return packer.take();
}

}  // namespace teracell::mesher

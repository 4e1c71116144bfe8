#include "mesher/overlaps/tile_overlaps.hpp"

#include <algorithm>

namespace teracell::mesher {
namespace {

constexpr uint32_t kNobody = ~uint32_t{0};

// The rank of the body that owns the whole stretch which begins at `from` and ends where `owner` is the owner.
uint32_t sole_owner(const Owner& owner, uint32_t from) { return owner.since <= from ? owner.rank : kNobody; }

}  // namespace

TileOverlaps::TileOverlaps(size_t bodies, int ray_axis) : frame_(RayFrame::along(ray_axis)), left_(bodies) {
  int at = 0;
  for (int d = 0; d < 3; ++d) {
    shift_[d] = at;
    at += d == frame_.w ? 32 : 8;
  }
}

void TileOverlaps::Stretches::add(const Stretches& other) {
  cells += other.cells;
  first = std::min(first, other.first);
  from = std::min(from, other.from), to = std::max(to, other.to);
  u0 = std::min(u0, other.u0), u1 = std::max(u1, other.u1);
  v0 = std::min(v0, other.v0), v1 = std::max(v1, other.v1);
}

TileOverlaps::Stretches TileOverlaps::stretch(uint32_t u, uint32_t v, uint32_t from, uint32_t to) const {
  const uint64_t key = uint64_t{from} << shift_[frame_.w] | uint64_t{u} << shift_[frame_.u] | uint64_t{v} << shift_[frame_.v];
  const auto u8 = static_cast<uint8_t>(u), v8 = static_cast<uint8_t>(v);
  return {to - from, key, from, to, u8, u8, v8, v8};
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

void TileOverlaps::leave(uint32_t ray, const Inside& body, uint32_t to, std::span<const Inside> others, const Owner& owner) {
  if (body.from >= to) return;
  const uint32_t u = ray % nu_, v = ray / nu_;
  Left& left = left_[body.body];
  const bool is_new = left.list.empty() && left.group.empty();
  size_t next = 0, before = 0;
  bool same = true;
  for (const Inside& other : others) {
    if (other.from <= body.from) {
      same = same && before < left.group.size() && left.group[before].rank == other.rank;
      ++before;
    } else if (other.from < to) {
      Common& c = common(left.list, next, other);
      c.stretches.add(stretch(u, v, other.from, to));
      c.third |= sole_owner(owner, other.from) != std::min(body.rank, other.rank);
    }
  }
  if (before > 0) {
    const uint32_t sole = sole_owner(owner, body.from);
    if (!same || before != left.group.size()) {
      list_group(body.rank, left);
      std::ranges::copy_if(others, std::back_inserter(left.group), [&](const Inside& other) { return other.from <= body.from; });
      left.owner = sole;
    }
    left.of_group.add(stretch(u, v, body.from, to));
    if (left.owner != sole) left.owner = kNobody;
  }
  if (is_new && !(left.list.empty() && left.group.empty())) met_.push_back(body);
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

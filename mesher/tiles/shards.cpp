#include "mesher/tiles/shards.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace teracell::mesher {
namespace {

constexpr uint32_t kMostNodes = 256;  // along u and v
// In nanoseconds. Fitted to the least CPU time in several runs of each group of the stadium at 20,000 cells (along x and z) and of the bust at
// 30,000^3 (along x and y), so that the longest of 64 parts is as short as can be (tools/bench/parts.py). Crossings of bodies beside the one that has
// most of them take longer, and so do crossings of rays that have many, above all of several bodies. What part 0 finds of the surfaces as a whole
// takes 130 ns per facet.
constexpr uint64_t kGroup = 93'600, kFacetInTile = 2'600, kCrossing = 12, kOfOther = 3, kCounted = 130;
// For a hundred crossings of a ray: of each of them, and of each that is of another body.
constexpr uint64_t kHundredOfRay = 14, kHundredOfOthers = 32;
// What a crossing takes when 16 chunks become one, two levels up. That is done behind the last one of them.
constexpr uint64_t kCoarser = 1;

constexpr uint64_t kPiece = 200'000'000;
constexpr uint32_t kLeastPieces = 128, kMostPieces = 1 << 16;  // few files in a folder, and many pieces per rank

double doubled_area(const Facet& f, int u, int v) {
  const auto& [a, b, c] = f.vertex;
  return std::abs((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]));
}

}  // namespace

std::string Shard::name() const { return fmt::format("shard-{}-of-{}", number, of); }

CostMap::CostMap(const Metadata& meta, std::vector<uint8_t> widened) : rays_(meta, std::move(widened)) {
  const auto count = [&](uint32_t rays) { return static_cast<uint32_t>((rays + rays_.size(height_) - 1) / rays_.size(height_)); };
  while (count(std::max(rays_.shape.nu, rays_.shape.nv)) > kMostNodes) ++height_;
  nodes_u_ = count(rays_.shape.nu), nodes_v_ = count(rays_.shape.nv);
  loads_.resize(size_t{nodes_u_} * nodes_v_);
  const uint64_t side = rays_.size(height_), group = rays_.size(0);
  for (uint32_t v = 0; v < nodes_v_; ++v)
    for (uint32_t u = 0; u < nodes_u_; ++u) {
      const auto groups = [&](uint32_t c, uint32_t rays) { return (std::min<uint64_t>(side, rays - c * side) + group - 1) / group; };
      loads_[size_t{v} * nodes_u_ + u].groups = groups(u, rays_.shape.nu) * groups(v, rays_.shape.nv);
    }
}

// The crossings of a facet are spread evenly over the box of its rays.
void CostMap::add(const Facet& facet, uint32_t layer) {
  ++facets_;
  if (layer & kIgnored) return;
  const RayRange r = rays_.range_of(facet, layer);
  if (r.empty()) return;
  const auto& [a, b, c] = facet.vertex;
  const auto extent = [&](int d) { return std::max({a[d], b[d], c[d]}) - std::min({a[d], b[d], c[d]}); };
  const int u = rays_.frame.u, v = rays_.frame.v;
  const double box = extent(u) * extent(v);
  const double share = box > 0 ? std::min(1.0, doubled_area(facet, u, v) / 2 / box) : 0;  // of the rays in the box that meet the facet
  const uint32_t body = body_of_layer(layer);
  const uint64_t side = rays_.size(height_);
  for (uint64_t j = r.v0 / side; j * side < r.v1; ++j)
    for (uint64_t i = r.u0 / side; i * side < r.u1; ++i) {
      const uint64_t wide = std::min<uint64_t>(r.u1, (i + 1) * side) - std::max<uint64_t>(r.u0, i * side),
                     high = std::min<uint64_t>(r.v1, (j + 1) * side) - std::max<uint64_t>(r.v0, j * side), tile = rays_.shape.chunk_rays;
      Load& load = loads_[j * nodes_u_ + i];
      const auto crossings = static_cast<uint64_t>(share * static_cast<double>(wide * high));
      load.crossings += crossings;
      if (load.body != body) load.body = body, load.of_latest = 0;
      load.of_latest += crossings;
      load.of_one = std::max(load.of_one, load.of_latest);
      load.facets += ((wide + tile - 1) / tile) * ((high + tile - 1) / tile);
    }
}

CostMap::Cost CostMap::of_node(const Load& load) const {
  const Cost crossings = load.crossings, others = load.of_others(), rays = Cost{side()} * side();
  return kGroup * load.groups + kFacetInTile * load.facets + crossings * (kCrossing + (height_ > 0 ? kCoarser : 0)) + others * kOfOther +
         crossings * (kHundredOfRay * crossings + kHundredOfOthers * others) / rays / 100;
}

// In the order of the tree.
std::vector<CostMap::Node> CostMap::nodes() const {
  std::vector<std::pair<uint64_t, const Load*>> all;
  for (uint32_t v = 0; v < nodes_v_; ++v)
    for (uint32_t u = 0; u < nodes_u_; ++u) all.push_back({tree_key(u, v), &loads_[size_t{v} * nodes_u_ + u]});
  std::ranges::sort(all);
  std::vector<Node> out;
  Cost crossings = 0;  // of the nodes so far that have the same parent
  for (size_t i = 0; i < all.size(); ++i) {
    const auto& [key, load] = all[i];
    out.push_back({key, of_node(*load)});
    crossings += load->crossings;
    if (i + 1 < all.size() && key / kChildren == all[i + 1].first / kChildren) continue;
    out.back().cost += kCoarser * crossings >> (2 * kFanOutBits * height_);
    crossings = 0;
  }
  return out;
}

CostMap::Cost CostMap::sum() const {
  Cost out = 0;
  for (const Node& node : nodes()) out += node.cost;
  return out;
}

// Of all of the tree, in its order. A unit is a power of kChildren.
std::vector<CostMap::Stretch> CostMap::stretches(uint64_t unit) const {
  std::vector<Stretch> out;
  const uint64_t groups = uint64_t{1} << (2 * kFanOutBits * height_);
  for (const auto& [key, cost] : nodes()) {
    const uint64_t first = key * groups / unit * unit, units = std::max<uint64_t>(1, groups / unit);
    if (out.empty() || out.back().first != first) out.push_back({first, unit, units, 0});
    out.back().of_unit += cost / units + 1;
  }
  return out;
}

// The keys at which to cut so that no part costs more than `bound`, as far as units and what the first part has to do besides allow it.
std::vector<CostMap::Cut> CostMap::cuts(std::span<const Stretch> stretches, Cost bound, Cost of_first) {
  std::vector<Cut> out;
  Cost spent = 0, room = bound > of_first ? bound - of_first : 0;
  for (const Stretch& s : stretches) {
    uint64_t left = s.units;
    for (; s.of_unit * left > room; room = bound) {
      const uint64_t taken = std::max(static_cast<uint64_t>(room / s.of_unit), uint64_t{room == bound});
      left -= taken;
      out.push_back({s.first + (s.units - left) * s.unit, spent + s.of_unit * taken});
      spent = 0;
    }
    room -= s.of_unit * left, spent += s.of_unit * left;
  }
  return out;
}

// The costliest part costs as little as it can. Part 0 also counts the facets.
TreeRange CostMap::stretch(const Shard& shard) const {
  if (shard.of == 1) return {};
  const std::vector<Stretch> all = stretches(1);
  const Cost of_first = Cost{kCounted} * facets_;
  Cost most = 0;
  for (const Stretch& s : all) most = std::max(most, s.of_unit);
  Cost low = std::max(most, (sum() + of_first) / shard.of), high = low + most + sum() / (shard.of - 1);  // enough if part 0 is empty
  while (high - low > low / 1024) {
    const Cost middle = low + (high - low) / 2;
    if (cuts(all, middle, of_first).size() < shard.of) high = middle;
    else low = middle + 1;
  }
  const std::vector<Cut> keys = cuts(all, high, of_first);
  const auto cut = [&](size_t i) { return i < keys.size() ? keys[i].key : TreeRange().end; };
  return {shard.number == 0 ? 0 : cut(shard.number - 1), cut(shard.number)};
}

std::vector<CostMap::Piece> CostMap::pieces() const {
  const auto number = static_cast<uint32_t>(std::clamp<Cost>(sum() / kPiece, kLeastPieces, kMostPieces));
  const uint64_t pages = (uint64_t{rays_.shape.nu} * rays_.shape.nv) / (rays_.size(1) * rays_.size(1));
  uint64_t unit = pages >= uint64_t{2} * kLeastPieces ? kChildren : 1;  // the groups of an index page of level 0
  // What joins many pieces is left to one process: as little as possible.
  while (number == kMostPieces && pages / unit >= kMostPieces / 2) unit *= kChildren;
  std::vector<Piece> out(1);
  Cost left = sum();
  for (const auto& [key, cost] : cuts(stretches(unit), sum() / number, 0)) {
    out.back().range.end = key;
    out.back().cost = static_cast<uint64_t>(cost);
    left -= std::min(left, cost);
    out.push_back({{key, TreeRange().end}, static_cast<uint64_t>(left)});
  }
  return out;
}

}  // namespace teracell::mesher

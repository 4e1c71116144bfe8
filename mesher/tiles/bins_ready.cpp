// What is made ready for bins, on any thread: facets, and blocks of them.
#include <algorithm>
#include <cstring>

#include "mesher/tiles/bins.hpp"

namespace teracell::mesher {
namespace {

// The nine coordinates of a facet, each a T. Returns where they end. (Gathered first, they were copied in larger words than those that they had
// just been written in, and waited until those had reached the cache.)
template <class T>
uint8_t* put_coordinates(const Facet& facet, uint8_t* to) {
  for (const Vec3& vertex : facet.vertex)
    for (const double coordinate : vertex) {
      const T value = static_cast<T>(coordinate);
      std::memcpy(to, &value, sizeof value);
      to += sizeof value;
    }
  return to;
}
}  // namespace

FacetBins::UnitRange FacetBins::units_of(const RayRange& r) const {
  const uint32_t u = rays_.shape.nu - 1, v = rays_.shape.nv - 1;
  const Side& unit = rays_.unit;
  return {unit.of(std::min(r.u0, u)), unit.of(std::min(r.u1, u)), unit.of(std::min(r.v0, v)), unit.of(std::min(r.v1, v))};
}

void FacetBins::encode(const Facet& facet, uint32_t tag, uint32_t patch, std::span<uint8_t> record) const {
  uint8_t* const to = float32_ ? put_coordinates<float>(facet, record.data()) : put_coordinates<double>(facet, record.data());
  std::memcpy(to, &tag, sizeof tag);
  if (patches_) std::memcpy(to + sizeof tag, &patch, sizeof patch);
}

void FacetBins::make_ready(std::span<const Facet> facets, uint32_t layer, Origin origin, uint32_t patch, Ready& out) const {
  const uint32_t tag = layer | (origin == kOfFile ? 0 : kNotOfFile) | (origin == kPlaced ? kInPlace : 0);
  const size_t before = out.facets.size(), each = sizeof(UnitRange) + record_bytes_;
  out.facets.resize(before + facets.size() * each);
  uint8_t* to = out.facets.data() + before;
  constexpr size_t kAtOnce = 32;
  std::array<Facet, kAtOnce> moved;
  std::array<RayRange, kAtOnce> ranges;
  const bool moves = move_ && origin != kPlaced;
  for (; !facets.empty(); facets = facets.subspan(std::min(kAtOnce, facets.size()))) {
    const std::span<const Facet> some = facets.first(std::min(kAtOnce, facets.size()));
    if (moves) std::ranges::transform(some, moved.begin(), [&](const Facet& f) { return move_(f, layer_in(tag)); });
    rays_.ranges_of(
        some.size(), [placed = moves ? moved.data() : some.data()](size_t i) TERACELL_IN_LINE -> const Facet& { return placed[i]; },
        [layer](size_t) { return layer; }, ranges.data());
    for (size_t i = 0; i < some.size(); ++i, to += each) {
      const UnitRange units = units_of(ranges[i]);
      std::memcpy(to, &units, sizeof units);
      encode(some[i], tag, patch, {to + sizeof units, record_bytes_});
    }
  }
}

// Divides blocks of facets, which are not moved, among the nodes of a depth.
class FacetBins::Dividing {
 public:
  explicit Dividing(const FacetBins& bins) : bins_(bins), rays_(bins.rays_) {}

  // Appends what lies in each node to `out`, as a block with these other bytes in its records, and before it a ReadyBlock. False if there would be
  // more than some nodes, or more than two copies of a facet on average: then it appends nothing.
  bool divide(WeldedRecords& block, std::span<const uint8_t> rest, int depth, UnfilledVector<uint8_t>& out) {
    layer_ = layer_in(tag_in(rest)), shift_ = rays_.shift(depth);
    vertices_.resize(block.vertices()), of_vertices_.resize(block.vertices());
    for (size_t v = 0; v < vertices_.size(); ++v) vertices_[v] = bins_.vertex_in(block.vertex(v));
    rays_.ranges_of(vertices_, of_vertices_.data());
    RayRange all = of_vertices_[0];
    for (const RayRange& r : of_vertices_) all = {std::min(all.u0, r.u0), std::max(all.u1, r.u1), std::min(all.v0, r.v0), std::max(all.v1, r.v1)};
    const UnitRange nodes = nodes_of(bins_.units_of(rays_.range_of(all, all, all, layer_)));
    const uint32_t wide = nodes.last_u - nodes.first_u + 1, high = nodes.last_v - nodes.first_v + 1;
    if (wide > kMostParts || high > kMostParts / wide) return false;
    if (wide * high == 1) {
      append_facts(block, {depth, nodes.first_u, nodes.first_v}, {}, out);
      block.append_all(rest, out);
      return true;
    }
    nodes_.resize(block.vertices());
    for (size_t v = 0; v < nodes_.size(); ++v) {
      const RayRange& r = of_vertices_[v];
      const UnitRange in = nodes_of(bins_.units_of(rays_.range_of(r, r, r, layer_)));
      nodes_[v] =
          Nodes{static_cast<int32_t>(in.first_u), static_cast<int32_t>(in.first_v), static_cast<int32_t>(in.last_u), static_cast<int32_t>(in.last_v)};
    }
    for (uint32_t i = 0; i < wide * high; ++i) parts_[i].clear();
    uint64_t copies = 0;
    for (uint32_t i = 0; i < block.records(); ++i) {
      const auto& [a, b, c] = block.vertices_of(i);
      const Nodes p = nodes_[a], q = nodes_[b], r = nodes_[c];
      Nodes first = p < q ? p : q, last = p < q ? q : p;
      first = first < r ? first : r, last = last < r ? r : last;
      copies += static_cast<uint64_t>(last[2] - first[0] + 1) * static_cast<uint64_t>(last[3] - first[1] + 1);
      for (int32_t v = first[1]; v <= last[3]; ++v)
        for (int32_t u = first[0]; u <= last[2]; ++u)
          parts_[(static_cast<uint32_t>(v) - nodes.first_v) * wide + static_cast<uint32_t>(u) - nodes.first_u].push_back(i);
    }
    if (copies > uint64_t{2} * block.records()) return false;
    const std::vector<uint32_t>* part = parts_.data();
    for (uint32_t v = nodes.first_v; v <= nodes.last_v; ++v)
      for (uint32_t u = nodes.first_u; u <= nodes.last_u; ++u, ++part)
        if (!part->empty()) {
          append_facts(block, {depth, u, v}, *part, out);
          block.append_some(*part, rest, out);
        }
    return true;
  }

 private:
  static constexpr uint32_t kMostParts = 16;
  UnitRange nodes_of(const UnitRange& r) const {
    const auto node = [this](uint64_t unit) { return static_cast<uint32_t>(unit >> shift_); };  // by as many bits as a unit has, if there is one node
    return {node(r.first_u), node(r.last_u), node(r.first_v), node(r.last_v)};
  }
  UnitRange units_of(const WeldedRecords& block, size_t facet) const {
    const auto& [a, b, c] = block.vertices_of(facet);
    return bins_.units_of(rays_.range_of(of_vertices_[a], of_vertices_[b], of_vertices_[c], layer_));
  }
  // One of eight facets stands for all: not each eighth one, since a file may repeat what it has after so many.
  static bool is_one_of_eight(uint32_t facet) { return facet * 0x9E37'79B1U >> 29 == 0; }
  // Of all facets if `which` is empty.
  void append_facts(const WeldedRecords& block, const TreePlace& place, std::span<const uint32_t> which, UnfilledVector<uint8_t>& out) const {
    ReadyBlock facts{place.cu, place.cv, 0, 0, 0};
    const auto look = [&](size_t facet) {
      const UnitRange units = units_of(block, facet);
      facts.looked_at += 8;
      facts.copies += static_cast<uint32_t>(8 * bins_.bins_met(place, units, bins_.below(place.depth)));
      facts.copies_next += static_cast<uint32_t>(8 * bins_.bins_met(place, units, place.depth - 1));
    };
    if (place.depth <= 0 && place.depth > rays_.lowest) {
      if (which.empty())
        for (uint32_t i = 0; i < block.records(); ++i)
          if (is_one_of_eight(i)) look(i);
      for (const uint32_t i : which)
        if (is_one_of_eight(i)) look(i);
    }
    const size_t before = out.size();
    out.resize(before + sizeof facts);
    std::memcpy(out.data() + before, &facts, sizeof facts);
  }

  const FacetBins& bins_;
  const GridRays& rays_;
  uint32_t layer_ = 0;
  int shift_ = 0;
  std::vector<Vec3> vertices_;
  std::vector<RayRange> of_vertices_;
  using Nodes [[gnu::vector_size(16)]] = int32_t;  // first_u, first_v, last_u, last_v of a vertex alone
  std::vector<Nodes> nodes_;
  std::array<std::vector<uint32_t>, kMostParts> parts_;
};

// A block goes into bins in as many parts as there are bins that it lies in, so that its facets need not be looked at one by one there.
void FacetBins::make_ready(std::span<const uint8_t> blocks, bool float32, uint32_t layer, uint32_t patch, Ready& out) const {
  std::array<uint8_t, 2 * sizeof(uint32_t)> rest;
  std::memcpy(rest.data(), &layer, sizeof layer), std::memcpy(rest.data() + sizeof layer, &patch, sizeof patch);
  Dividing dividing(*this);
  WeldedRecords block({3 * (float32 ? sizeof(float) : sizeof(double)), 0});
  std::vector<Facet> facets;
  WeldedRecords::for_each(blocks, [&](std::span<const uint8_t> bytes) {
    block.read(bytes);
    if (!move_ && float32 == float32_ && dividing.divide(block, std::span(rest).first(shape_.rest), first_, out.blocks)) return;
    block.facets(facets);
    make_ready(facets, layer, kOfFile, patch, out);
  });
}

// Puts a block into the bins below one. A few facets would take more room as parts than one by one, since then they are welded with others.
void FacetBins::put_below(Bin& bin, std::span<const uint8_t> bytes) {
  WeldedRecords block(shape_);
  block.read(bytes);
  UnfilledVector<uint8_t> parts;
  constexpr size_t kWorthParts = 16;
  const auto rest = block.rest_of_all();
  if (block.records() < kWorthParts || move_ || !rest || is_part(tag_in(*rest)) || !Dividing(*this).divide(block, *rest, bin.place.depth - 1, parts))
    return put_facets(bin, block);
  for_each_ready(parts, [&](const ReadyBlock& facts, std::span<const uint8_t> part) {
    if (facts.u / kFanOut == bin.place.cu && facts.v / kFanOut == bin.place.cv)
      put_block(bin.children[facts.v % kFanOut * kFanOut + facts.u % kFanOut], facts, part);
  });
}

}  // namespace teracell::mesher

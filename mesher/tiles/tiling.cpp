#include "mesher/tiles/tiling.hpp"

#include <numeric>

#include "store/base/in_order.hpp"

namespace teracell::mesher {
namespace {

// Calls f(child) for the children of a place that a facet with chunks `r` may meet. A child has 2^shift x 2^shift chunks.
template <class F>
void for_each_child(const ChunkRange& r, uint32_t cu, uint32_t cv, int shift, F&& f) {
  const uint32_t u0 = cu * kFanOut, v0 = cv * kFanOut;
  const uint32_t first_u = std::max(r.first_u >> shift, u0), last_u = std::min(r.last_u >> shift, u0 + kFanOut - 1);
  const uint32_t first_v = std::max(r.first_v >> shift, v0), last_v = std::min(r.last_v >> shift, v0 + kFanOut - 1);
  for (uint32_t v = first_v; v <= last_v; ++v)
    for (uint32_t u = first_u; u <= last_u; ++u) f((v - v0) * kFanOut + u - u0);
}

// How many heights are told apart. The nearest 4096th of the grid will do: crossings of a ray come out nearly sorted, and sorting them is four
// times as fast as if they came in any order.
constexpr uint32_t kHeights = 4096;

}  // namespace

Tiling::Tiling(const Metadata& meta, std::vector<uint8_t> widened, const TreeRange& range) : rays_(meta, std::move(widened)), range_(range) {
  groups_u_ = (rays_.shape.chunks_u + kFanOut - 1) / kFanOut;
  groups_v_ = (rays_.shape.chunks_v + kFanOut - 1) / kFanOut;
  groups_ = groups_below(rays_.root());
  has_all_ = groups_ == uint64_t{groups_u_} * groups_v_;
}

// The groups of the range that lie below a node, and in the grid.
uint64_t Tiling::groups_below(const TreePlace& place) const {
  const auto inside = [&](uint32_t c, uint32_t groups) {  // of the node's side, in groups
    const uint64_t from = uint64_t{c} << (kFanOutBits * place.depth),
                   to = std::min<uint64_t>(from + (uint64_t{1} << (kFanOutBits * place.depth)), groups);
    return to > from ? to - from : 0;
  };
  const uint64_t all = inside(place.cu, groups_u_) * inside(place.cv, groups_v_);
  if (all == 0 || !wanted(place)) return 0;
  if (range_.has_all(place.depth, place.cu, place.cv)) return all;
  uint64_t sum = 0;
  for (uint32_t k = 0; k < kChildren; ++k) sum += groups_below(place.child(k));
  return sum;
}

// Makes a node of facets in memory.
class Tiling::NodeBuilder {
 public:
  explicit NodeBuilder(const GridRays& rays)
      : rays_(rays), w_(rays.frame.w), lowest_(rays.w.min()), per_height_(kHeights / (rays.w.max() - lowest_)) {}
  void expect(uint64_t facets) {
    block_->chunks.reserve(facets);
    block_->heights.reserve(facets);
    list_.reserve(facets);
  }
  // To be called for the facets of the store in their order.
  void add(const Facet& facet, const RayRange& r) {
    const auto& [a, b, c] = facet.vertex;
    add(a[w_], b[w_], c[w_], r);
  }
  // The same, of facets of a bin, for those that may meet rays, which it puts into the store.
  void add(const BinnedFacets& some, GridFacets& store) {
    for (size_t i = 0; i < some.facets.size(); ++i) {
      const BinnedFacets::One& f = some.facets[i];
      if (!f.leads || f.rays.empty()) continue;
      SceneFacet& to = store.append();
      to.layer = some.layer, to.patch = some.patch;
      if (some.moved.empty()) {
        const Vec3 &a = some.vertices[f.vertices[0]], &b = some.vertices[f.vertices[1]], &c = some.vertices[f.vertices[2]];
        to.facet.vertex[0] = a, to.facet.vertex[1] = b, to.facet.vertex[2] = c;
        add(a[w_], b[w_], c[w_], f.rays);
      } else {
        to.facet = some.moved[i];
        add(some.moved[i], f.rays);
      }
    }
  }
  Node finish(const TreePlace& place, std::shared_ptr<const GridFacets> facets) {
    block_->facets = std::move(facets);
    return {place, std::move(block_), std::move(list_)};
  }

 private:
  void add(double a, double b, double c, const RayRange& r) {  // where its vertices lie along the rays
    const double height = (std::min(std::min(a, b), c) - lowest_) * per_height_;
    if (!r.empty()) list_.push_back(static_cast<uint32_t>(block_->chunks.size()));
    block_->chunks.push_back(r.empty() ? ChunkRange{} : rays_.chunks_of(r));
    block_->heights.push_back(r.empty() ? uint16_t{0} : static_cast<uint16_t>(std::clamp(height, 0.0, kHeights - 1.0)));
  }
  const GridRays& rays_;
  const int w_;
  const double lowest_, per_height_;
  std::shared_ptr<FacetBlock> block_ = std::make_shared<FacetBlock>();
  std::vector<uint32_t> list_;
};

Tiling::Tiling(std::shared_ptr<const GridFacets> facets, const Metadata& meta, std::vector<uint8_t> widened, const TreeRange& range)
    : Tiling(meta, std::move(widened), range) {
  NodeBuilder root(rays_);
  root.expect(facets->size());
  constexpr size_t kAtOnce = 64;
  std::array<const SceneFacet*, kAtOnce> some;
  size_t count = 0;
  const auto add_some = [&] {
    std::array<RayRange, kAtOnce> ranges;
    rays_.ranges_of(
        count, [&some](size_t i) TERACELL_IN_LINE -> const Facet& { return some[i]->facet; }, [&some](size_t i) { return some[i]->layer; },
        ranges.data());
    for (size_t i = 0; i < count; ++i) root.add(some[i]->facet, some[i]->layer & kIgnored ? RayRange{} : within_range(ranges[i]));
    count = 0;
  };
  facets->for_each(0, facets->size(), [&](const SceneFacet& f) {
    some[count++] = &f;
    if (count == kAtOnce) add_some();
  });
  add_some();
  path_.push_back(root.finish(rays_.root(), std::move(facets)));
}

// Empty if they are outside the range. A key never falls when a coordinate grows, so all groups of a box have keys between those of
// its corners.
RayRange Tiling::within_range(const RayRange& r) const {
  if (has_all_ || r.empty()) return r;
  const ChunkRange c = rays_.chunks_of(r);
  const auto key = [](uint32_t cu, uint32_t cv) { return tree_key(cu / kFanOut, cv / kFanOut); };
  return key(c.first_u, c.first_v) < range_.end && key(c.last_u, c.last_v) >= range_.first ? r : RayRange{};
}

Tiling::Tiling(std::unique_ptr<FacetBins> bins, BinnedCounter* counter, int ahead, const Metadata& meta, const TreeRange& range)
    : Tiling(meta, {}, range) {
  bins_ = std::move(bins);
  counter_ = counter;
  ahead_ = static_cast<size_t>(ahead);
  path_.push_back({rays_.root(), nullptr, {}});
}

Tiling::Node Tiling::load(const TreePlace& place) const {
  const auto store = std::make_shared<GridFacets>();
  NodeBuilder node(rays_);
  node.expect(bins_->facets(place));  // none of a group with several bins: most of its facets meet no ray
  const bool kept = wanted(place);
  bins_->for_each_bin(place, [&](const TreePlace& bin) {
    std::optional<BinnedCounter::Bin> counts;
    if (counter_) counts.emplace(*counter_, bins_->facets(bin));
    bins_->take(bin, [&](const BinnedFacets& some) {
      if (counts) counts->add(some);
      if (kept && !some.ignored) node.add(some, *store);
    });
    if (counts) counts->finish();
  });
  return node.finish(place, store);
}

Tiling::Node Tiling::take_bin(const TreePlace& place) {
  if (!bins_->has_facets(place) || next_bins_.empty()) return load(place);
  std::future<Node> loading = std::move(next_bins_.front());
  next_bins_.pop_front();
  return loading.get();
}

// Goes along the path as next() will, and puts children in the place of nodes that are split.
std::function<void()> Tiling::next_load() {
  if (next_bins_.size() >= ahead_) return nullptr;
  size_t bins = 0;
  for (size_t n = path_.size(); n > 0;) {
    const Node& node = path_[--n];
    if (node.block) continue;
    if (is_loaded_whole(node.place)) {
      if (!bins_->has_facets(node.place) || ++bins <= next_bins_.size()) continue;
      const auto task = std::make_shared<std::packaged_task<Node()>>([this, at = node.place] { return load(at); });
      next_bins_.push_back(task->get_future());
      return [task] { (*task)(); };
    }
    std::vector<Node> children = children_of(node);
    path_.erase(path_.begin() + static_cast<ptrdiff_t>(n));
    path_.insert(path_.begin() + static_cast<ptrdiff_t>(n), std::make_move_iterator(children.begin()), std::make_move_iterator(children.end()));
    n += children.size();
  }
  return nullptr;
}

void Tiling::pass(uint64_t groups, int threads, const std::function<void(uint64_t taken)>& went_on) {
  uint64_t left = groups, taken = 0;
  in_order(
      threads,
      [&]() -> std::optional<bool> {
        if (left == 0) return std::nullopt;
        const auto group = next();
        if (!group) return std::nullopt;
        left -= !group->passed;
        return group->passed;
      },
      [](bool passed, int) { return passed; },
      [&](bool passed) {
        if (!passed) went_on(++taken);
      },
      2, nullptr, [this] { return next_load(); });
}

std::optional<TileGroup> Tiling::next() {
  while (!path_.empty()) {
    Node node = std::move(path_.back());
    path_.pop_back();
    if (!node.block && is_loaded_whole(node.place)) node = take_bin(node.place);
    if (!wanted(node.place) && (node.block || is_loaded_whole(node.place))) {  // its facets were only counted
      if (bins_ && bins_->has_facets(node.place)) return TileGroup{.cu = 0, .cv = 0, .block = nullptr, .facets = {}, .passed = true};
      continue;
    }
    if (node.place.depth == 0) {
      std::vector<ListedFacet> facets = listed(node);
      return TileGroup{node.place.cu, node.place.cv, std::move(node.block), std::move(facets)};
    }
    std::ranges::move(children_of(node), std::back_inserter(path_));
  }
  return std::nullopt;
}

// The last one first, because path_ is a stack.
std::vector<Tiling::Node> Tiling::children_of(const Node& node) const {
  const TreePlace& at = node.place;
  const int depth = at.depth - 1;
  std::array<std::vector<uint32_t>, kChildren> lists;
  std::array<bool, kChildren> here;
  for (uint32_t k = 0; k < kChildren; ++k) {
    here[k] = wanted(at.child(k));
    if (here[k])
      lists[k].reserve(node.facets.size() / 8);  // memory that is reserved and unused is never touched; growing would touch all of it twice
  }
  for (const uint32_t facet : node.facets)
    for_each_child(node.block->chunks[facet], at.cu, at.cv, kFanOutBits * at.depth, [&](uint32_t k) {
      if (here[k]) lists[k].push_back(facet);
    });
  std::vector<Node> out;
  for (uint32_t k = kChildren; k-- > 0;) {
    const TreePlace child = at.child(k);
    if (!wanted(child) && (node.block || !counter_)) continue;
    if (uint64_t{child.cu} << (kFanOutBits * depth) < groups_u_ && uint64_t{child.cv} << (kFanOutBits * depth) < groups_v_)
      out.push_back({child, node.block, std::move(lists[k])});
  }
  return out;
}

// The facets of a node that is a group.
std::vector<ListedFacet> Tiling::listed(const Node& node) {
  std::vector<ListedFacet> out(node.facets.size());
  const auto list = [&,
                     within = [](uint32_t chunk, uint32_t first) { return static_cast<uint16_t>(std::clamp(chunk, first, first + kFanOut) - first); },
                     u = node.place.cu * kFanOut, v = node.place.cv * kFanOut](uint32_t facet) {
    const ChunkRange& r = node.block->chunks[facet];
    return ListedFacet{
        facet, node.block->heights[facet], within(r.first_u, u), within(r.last_u + 1, u), within(r.first_v, v), within(r.last_v + 1, v)};
  };
  if (out.size() < kHeights / 16) {  // a place for each height would take longer
    std::ranges::transform(node.facets, out.begin(), list);
    std::ranges::sort(out, {}, [](const ListedFacet& f) { return uint64_t{f.height} << 32 | f.number; });
    return out;
  }
  std::array<uint32_t, kHeights + 1> places{};
  for (const uint32_t facet : node.facets) ++places[node.block->heights[facet] + 1];
  std::partial_sum(places.begin(), places.end(), places.begin());
  for (const uint32_t facet : node.facets) out[places[node.block->heights[facet]]++] = list(facet);
  return out;
}

std::array<std::vector<const SceneFacet*>, kFanOut> Tiling::split(const TileGroup& group, uint32_t row) const {
  std::array<std::vector<const SceneFacet*>, kFanOut> lists;
  for (const ListedFacet& f : group.facets) {
    if (row < f.v0 || row >= f.v1) continue;
    for (uint32_t u = f.u0; u < f.u1; ++u) lists[u].push_back(&(*group.block->facets)[f.number]);
  }
  return lists;
}

}  // namespace teracell::mesher

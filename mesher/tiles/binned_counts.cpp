#include "mesher/tiles/binned_counts.hpp"

#include <utility>

#include "mesher/closing/closing.hpp"

namespace teracell::mesher {

BinnedCounter::Bin::Bin(BinnedCounter& all, uint64_t facets) : all_(all) {
  if (all.bodies_.size() == 1 && all.wanted_[0]) counters_[0].expect(facets);
}

// Finds hashes and numbers of those of the facets' vertices that have none yet.
void BinnedCounter::Bin::know(const BinnedFacets& facets) {
  if (known_.size() < facets.vertices.size()) known_.resize(facets.vertices.size());
  std::array<uint32_t, kAtOnce> unknown, numbers;
  std::array<VertexHash, kAtOnce> hashes;
  size_t count = 0;
  const auto settle = [&] {
    for (size_t i = 0; i < count; ++i) hashes[i] = vertex_hash(facets.vertices[unknown[i]]);
    latest_->number(std::span(hashes).first(count), numbers.data());
    for (size_t i = 0; i < count; ++i) known_[unknown[i]] = {hashes[i], numbers[i], stamp_};
    count = 0;
  };
  const auto add = [&](uint32_t vertex) {
    unknown[count++] = vertex;
    if (count == kAtOnce) settle();
  };
  if (facets.of_block) {  // all of the block's vertices, before the first of its facets
    if (std::exchange(is_new_, false))
      for (uint32_t v = 0; v < facets.vertices.size(); ++v) add(v);
  } else {
    for (const BinnedFacets::One& f : facets.facets)
      for (const uint32_t v : f.vertices)
        if (known_[v].stamp != stamp_) known_[v].stamp = stamp_, add(v);
  }
  settle();
}

void BinnedCounter::Bin::add(const BinnedFacets& facets) {
  const uint32_t body = body_of_layer(facets.layer);
  if (facets.added || !all_.wanted_[body]) return;  // those that were added are not in the file
  if (latest_ == nullptr || body != latest_body_ || facets.block != block_) {
    latest_ = &counters_[body], latest_body_ = body, block_ = facets.block;
    is_new_ = true, ++stamp_;
  }
  know(facets);
  for (auto all = facets.facets; !all.empty(); all = all.subspan(std::min(kAtOnce, all.size()))) {
    const auto some = all.first(std::min(kAtOnce, all.size()));
    std::array<uint64_t, kAtOnce> keys;
    size_t at_home = 0;
    uint64_t degenerate = 0;
    for (const BinnedFacets::One& f : some) {
      const Known &a = known_[f.vertices[0]], &b = known_[f.vertices[1]], &c = known_[f.vertices[2]];
      latest_->join({a.number, b.number, c.number});
      keys[at_home] = FacetSet::key_of({a.hash.low, b.hash.low, c.hash.low});
      at_home += f.at_home;
      if (f.bins > 1) share(f, a, FacetKey::low_of({a.hash.low, b.hash.low, c.hash.low}), body);
    }
    for (const BinnedFacets::One& f : some)
      degenerate += f.at_home && has_no_area(facets.vertices[f.vertices[0]], facets.vertices[f.vertices[1]], facets.vertices[f.vertices[2]]);
    latest_->count(std::span(keys).first(at_home), degenerate);
  }
}

void BinnedCounter::Bin::share(const BinnedFacets::One& f, const Known& first, uint64_t hash, uint32_t body) {
  hash |= 1;  // so no few times it is 0
  shared_.push_back({body, first.number, first.hash, f.at_home ? (f.bins - 1) * hash : -hash});
}

void BinnedCounter::Bin::finish() {
  std::vector<std::pair<uint32_t, SurfaceCounts>> counts;
  for (auto& [b, counter] : counters_) counts.emplace_back(b, counter.totals());
  std::lock_guard lock(all_.mutex_);
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> node_of;  // by body and shell within the bin
  for (const Shared& f : shared_) {
    Body& body = all_.bodies_[f.body];
    const auto [node, is_new] = body.nodes.try_emplace(f.vertex, Node{body.shells.size()});
    if (is_new) body.shells.add();
    node->second.to_come += f.to_come;
    const auto [in_bin, first_of_shell] = node_of.try_emplace({f.body, counters_[f.body].shell_of(f.number)}, node->second.number);
    if (first_of_shell) --body.totals.shells;
    else body.shells.join(node->second.number, in_bin->second);
  }
  for (const Shared& f : shared_) {
    auto& nodes = all_.bodies_[f.body].nodes;
    if (const auto node = nodes.find(f.vertex); node != nodes.end() && node->second.to_come == 0) nodes.erase(node);
  }
  for (const auto& [b, found] : counts) {
    SurfaceCounts& totals = all_.bodies_[b].totals;
    totals.degenerate += found.degenerate;
    totals.duplicates += found.duplicates;
    totals.opposite += found.opposite;
    totals.shells += found.shells;
  }
}

std::vector<SurfaceCounts> BinnedCounter::totals() const {
  std::vector<SurfaceCounts> out;
  for (const Body& body : bodies_) {
    out.push_back(body.totals);
    out.back().shells += body.shells.count();
  }
  return out;
}

size_t BinnedCounter::waiting() const {
  size_t out = 0;
  for (const Body& body : bodies_) out += body.nodes.size();
  return out;
}

}  // namespace teracell::mesher

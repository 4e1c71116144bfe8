#include "mesher/tiles/binned_counts.hpp"

#include "mesher/closing/closing.hpp"

namespace teracell::mesher {

BinnedCounter::Bin::Bin(BinnedCounter& all, uint64_t facets) : all_(all) {
  if (all.bodies_.size() == 1 && all.wanted_[0]) counters_[0].expect(facets);
}

void BinnedCounter::Bin::add(const BinnedFacet& f) {
  if (f.added) return;  // not in the file
  const uint32_t body = body_of_layer(f.layer);
  if (!all_.wanted_[body]) return;
  if (latest_ == nullptr || body != latest_body_) latest_ = &counters_[body], latest_body_ = body, ++stamp_;
  if (f.block != block_) block_ = f.block, ++stamp_;
  std::array<VertexHash, 3> vertices;
  std::array<uint32_t, 3> nodes;
  for (int i = 0; i < 3; ++i) {
    if (f.block == 0) {
      vertices[i] = vertex_hash(f.facet.vertex[i]), nodes[i] = latest_->node_of(vertices[i]);
      continue;
    }
    if (f.vertices[i] >= known_.size()) known_.resize(2 * f.vertices[i] + 64);
    Known& known = known_[f.vertices[i]];
    if (known.stamp != stamp_) {
      const VertexHash hash = vertex_hash(f.facet.vertex[i]);
      known = {hash.low, stamp_, latest_->node_of(hash), hash.high};
    }
    vertices[i] = {known.low, known.high}, nodes[i] = known.node;
  }
  latest_->add(f.facet, vertices, nodes, f.at_home);
  if (f.bins == 1) return;
  const uint64_t hash = FacetKey::low_of(vertices) | 1;  // so no few times it is 0
  shared_.push_back({body, vertices[0], f.at_home ? (f.bins - 1) * hash : -hash});
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
    const auto [in_bin, first_of_shell] = node_of.try_emplace({f.body, counters_[f.body].shell_of(f.vertex)}, node->second.number);
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

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
  counters_[body].add(f.facet, f.at_home);
  if (f.shared) shared_.emplace_back(body, f.facet.vertex[0]);
}

void BinnedCounter::Bin::finish() {
  std::lock_guard lock(all_.mutex_);
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> node_of;  // by body and shell within the bin
  for (const auto& [b, vertex] : shared_) {
    Body& body = all_.bodies_[b];
    const uint32_t node = body.nodes(vertex);
    if (node == body.shells.size()) body.shells.add();
    const auto [in_bin, first_of_shell] = node_of.try_emplace({b, counters_[b].shell_of(vertex)}, node);
    if (first_of_shell) --body.totals.shells;
    else body.shells.join(node, in_bin->second);
  }
  for (auto& [b, counter] : counters_) {
    SurfaceCounts& totals = all_.bodies_[b].totals;
    totals.degenerate += counter.degenerate();
    totals.duplicates += counter.duplicates();
    totals.opposite += counter.opposite();
    totals.shells += counter.shells();
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

}  // namespace teracell::mesher

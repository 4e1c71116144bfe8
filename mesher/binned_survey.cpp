#include "mesher/binned_survey.hpp"

#include <algorithm>
#include <map>

#include <xxhash.h>

namespace teracell {
namespace {

uint32_t root(std::vector<uint32_t>& parent, uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

}  // namespace

void BinnedSurvey::add_bin(const std::vector<BinnedFacet>& facets) {
  std::map<size_t, Survey> surveys;  // by body
  for (size_t i = 0; i < facets.size();) {  // a body's facets mostly follow each other
    const size_t body = facets[i].layer / 2;
    Survey& survey = surveys[body];
    if (survey.vertices() == 0) survey.expect(std::ranges::count(facets, body, [](const BinnedFacet& f) { return f.layer / 2; }));
    for (; i < facets.size() && facets[i].layer / 2 == body; ++i) survey.add(facets[i].facet, facets[i].at_home);
  }
  std::map<std::pair<size_t, uint32_t>, uint32_t> node_of;  // by body and shell within the bin
  for (const BinnedFacet& f : facets) {
    if (!f.shared) continue;
    Body& body = bodies_[f.layer / 2];
    const auto fresh = static_cast<uint32_t>(body.parent.size());
    const auto [node, first] = body.nodes.try_emplace(XXH3_64bits(f.facet.vertex[0].data(), sizeof(Vec3)), fresh);
    if (first) body.parent.push_back(fresh);
    const auto [in_bin, first_of_shell] = node_of.try_emplace({f.layer / 2, surveys[f.layer / 2].shell_of(f.facet.vertex[0])}, node->second);
    if (first_of_shell) --body.totals.shells;
    else body.parent[root(body.parent, node->second)] = root(body.parent, in_bin->second);
  }
  for (auto& [b, survey] : surveys) {
    SurveyTotals& totals = bodies_[b].totals;
    totals.degenerate += survey.degenerate();
    totals.duplicates += survey.duplicates();
    totals.shells += survey.shells();
  }
}

std::vector<SurveyTotals> BinnedSurvey::totals() const {
  std::vector<SurveyTotals> out;
  for (const Body& body : bodies_) {
    out.push_back(body.totals);
    for (uint32_t v = 0; v < body.parent.size(); ++v) out.back().shells += body.parent[v] == v;
  }
  return out;
}

}  // namespace teracell

#include "mesher/feed.hpp"

#include <algorithm>

namespace teracell {
namespace {

std::vector<bool> which_move(const Scene& scene) {
  std::vector<bool> out;
  for (const SceneBody& body : scene.bodies) out.push_back(body.matrix != kIdentity);
  return out;
}

Facet moved_facet(const Facet& facet, const SceneBody& body) {
  return {{moved(facet.vertex[0], body), moved(facet.vertex[1], body), moved(facet.vertex[2], body)}};
}

}  // namespace

Feed::Feed(const Scene& scene, Bodies& bodies, const Metadata& meta, const std::vector<bool>& wide, const Budget& budget, int threads,
           const std::function<void(double)>& tick)
    : scene_(scene), bodies_(bodies), meta_(meta), binned_(scene.bodies.size()) {
  if (bodies.in_memory) {
    use_memory(wide);
    return;
  }
  auto bins = fill_bins(wide, budget, threads, tick);
  spilled_ = bins->bytes();
  tiling_.emplace(std::move(bins), binned_, threads > 1 ? threads : 0, meta);
}

void Feed::use_memory(const std::vector<bool>& wide) {
  if (const auto moves = which_move(scene_); std::ranges::count(moves, true) > 0) {
    bodies_.helper->finish_all();  // the survey takes the files' coordinates
    bodies_.facets->for_each(0, bodies_.facets->size(), [&](SceneFacet& f) {
      if (moves[f.layer / 2]) f.facet = moved_facet(f.facet, scene_.bodies[f.layer / 2]);
    });
  }
  tiling_.emplace(bodies_.facets, meta_, wide);
}

std::vector<SurveyTotals> Feed::surveys() {
  return bodies_.in_memory ? bodies_.survey_totals() : binned_.totals();
}

// They are read once more, from their files.
std::unique_ptr<FacetBins> Feed::fill_bins(const std::vector<bool>& wide, const Budget& budget, int threads, const std::function<void(double)>& tick) {
  const auto move = [&scene = scene_, moves = which_move(scene_)](const Facet& f, uint32_t layer) { return moves[layer / 2] ? moved_facet(f, scene.bodies[layer / 2]) : f; };
  auto bins = std::make_unique<FacetBins>(meta_, bodies_.facet_count(), bodies_.float32(), budget, threads > 1, move, wide);
  const double all = static_cast<double>(bodies_.facet_count());
  uint64_t done = 0;
  for (size_t b = 0; b < scene_.bodies.size(); ++b) {
    const BodyFacets& found = bodies_.bodies[b];
    Background background(threads > 1);
    read_again(scene_.bodies[b], found, budget, [&](std::span<const Facet> facets) {
      background.run([&, b, batch = std::vector<Facet>(facets.begin(), facets.end())] {
        for (const Facet& f : batch) bins->add(f, layer_of(b, found.shells ? found.shells->evenodd(f.vertex[0]) : found.rules[1].used), false);
      });
      done += facets.size();
      tick(static_cast<double>(done) / all);
    });
    background.finish();
    for (const bool parity : {false, true})
      for (const Facet& f : found.rules[parity].caps.facets) bins->add(f, layer_of(b, parity), true);
  }
  bins->finish();
  return bins;
}

}  // namespace teracell

// Traditional ray casting: every ray is tested against every facet of the scene, so the time is proportional to rays times
// facets. As the simplest engine, it is the baseline for measurements and the reference for checks.
//
// Which side of an edge a ray passes is an orientation test without division, as in T. Ma, T. Ma, L. Hao, "Large-Scale Finite
// Difference Grid Generation and Visualization Method Based on Ray Casting Algorithm" (MSAM 2020).
#include "mesher/engines/engines.hpp"
#include "mesher/engines/ray.hpp"

namespace teracell::mesher {

class BruteEngine : public Engine {
 public:
  // `scene` holds all facets of the scene; cast() ignores those it is given.
  explicit BruteEngine(std::shared_ptr<const std::vector<const SceneFacet*>> scene) : scene_(std::move(scene)) {}
  bool searches_scene() const override { return true; }
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;

 private:
  std::shared_ptr<const std::vector<const SceneFacet*>> scene_;
};

void BruteEngine::cast(const Tile& tile, std::span<const SceneFacet* const>, Crossings& out) {
  out.begin.assign(1, 0);
  out.all.clear();
  for (const double v : tile.v) {
    for (const double u : tile.u) {
      for (const SceneFacet* facet : *scene_) cross_ray(*facet, tile, u, v, out.all, exact_decisions_);
      check_crossings(tile, out.all.size());
      out.begin.push_back(static_cast<uint32_t>(out.all.size()));
    }
  }
}

namespace {

EngineMaker brute_maker(const RayFrame&, const AllFacets& all_facets) {
  return [scene = std::make_shared<const std::vector<const SceneFacet*>>(all_facets())] { return std::make_unique<BruteEngine>(scene); };
}

}  // namespace

const EngineKind kBruteEngine = {"brute", true, brute_maker};

}  // namespace teracell::mesher

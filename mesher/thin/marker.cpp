#include "mesher/thin/marker.hpp"

#include <algorithm>

#include "mesher/closing/closing.hpp"

namespace teracell::mesher {

bool has_marks(const Scene& scene) {
  return std::ranges::any_of(scene.bodies, [](const SceneBody& body) { return body.kind == Kind::kSheet || body.thin == Thin::kKeep; });
}

std::vector<uint8_t> widened_bodies(const Scene& scene, bool all_solids, bool links) {
  if (links) return std::vector<uint8_t>(scene.bodies.size(), has_marks(scene) ? 2 : 1);
  std::vector<uint8_t> widened;
  for (const SceneBody& body : scene.bodies) widened.push_back(body.kind == Kind::kSheet || ThinParts::wanted(body, all_solids));
  return std::ranges::count(widened, 0) < static_cast<int64_t>(widened.size()) ? widened : std::vector<uint8_t>{};
}

Marker::Marker(const Scene& scene, const Metadata& meta, const Labels& labels, bool count_thin) : scene_(scene) {
  const auto any = [&](auto&& is) { return std::ranges::any_of(scene.bodies, is); };
  if (any([](const SceneBody& body) { return body.kind == Kind::kSheet; })) sheets_.emplace(meta.grid, meta.ray_axis);
  if (any([&](const SceneBody& body) { return ThinParts::wanted(body, count_thin); }))
    thin_.emplace(scene, labels, meta.grid, meta.ray_axis, count_thin);
}

std::span<const SceneFacet* const> Marker::solids(std::span<const SceneFacet* const> facets) {
  of_solids_.clear(), of_sheets_.clear();
  if (!sheets_) return solids_ = facets;
  for (const SceneFacet* facet : facets) (scene_.bodies[body_of_layer(facet->layer)].kind == Kind::kSheet ? of_sheets_ : of_solids_).push_back(facet);
  return solids_ = of_solids_;
}

void Marker::mark(const Tile& tile, const Box& cells, Crossings& crossings) {
  if (!thin_ && of_sheets_.empty()) return;
  marks_.reset(tile.rays());
  if (thin_) thin_->find(cells, solids_, crossings, marks_, tallies_);
  if (!of_sheets_.empty()) sheets_->mark(cells, of_sheets_, marks_, tallies_);
  marks_.join(tile, crossings);
}

}  // namespace teracell::mesher

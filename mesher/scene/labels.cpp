#include "mesher/scene/labels.hpp"

#include <algorithm>
#include <numeric>

namespace teracell::mesher {
namespace {

std::vector<uint32_t> ranks_of_bodies(const Scene& scene) {
  std::vector<uint32_t> order(scene.bodies.size()), rank(scene.bodies.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](uint32_t a, uint32_t b) { return is_stronger(scene, a, b); });
  for (uint32_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
  return rank;
}

std::vector<MaterialInfo> ranked_materials(const Scene& scene, const std::vector<uint32_t>& body_rank) {
  std::vector<uint64_t> key(scene.materials.size());  // materials with a body, then those without, then the background
  for (size_t m = 0; m < key.size(); ++m) key[m] = (uint64_t{1} << 32) + m;
  for (size_t b = 0; b < scene.bodies.size(); ++b) key[scene.bodies[b].material] = std::min<uint64_t>(key[scene.bodies[b].material], body_rank[b]);
  key[0] = ~uint64_t{0};
  std::vector<uint32_t> order(key.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](uint32_t m) { return key[m]; });
  std::vector<MaterialInfo> out;
  for (const SceneMaterial& m : scene.materials) out.push_back({m.name, m.color, 0});
  for (uint32_t rank = 0; rank < order.size(); ++rank) out[order[rank]].rank = rank;
  return out;
}

}  // namespace

bool is_stronger(const Scene& scene, uint32_t a, uint32_t b) {
  const int64_t pa = scene.bodies[a].priority, pb = scene.bodies[b].priority;
  return pa != pb ? pa > pb : a > b;
}

Labels make_labels(const Scene& scene) {
  Labels out;
  out.rank = ranks_of_bodies(scene);
  out.materials = ranked_materials(scene, out.rank);
  const auto add = [&](LabelInfo label) {
    out.labels.push_back(std::move(label));
    return static_cast<Label>(out.labels.size() - 1);
  };
  if (scene.label_by == LabelBy::kMaterial) {
    for (uint32_t m = 0; m < scene.materials.size(); ++m) add({m, ""});
    for (const SceneBody& body : scene.bodies) out.of_body.push_back(body.material);
    out.of_overlap = out.of_body;
    return out;
  }
  add({0, ""});
  for (const SceneBody& body : scene.bodies) {
    out.of_body.push_back(add({body.material, body.name}));
    out.of_overlap.push_back(scene.label_by == LabelBy::kOverlap ? add({body.material, body.name, true}) : out.of_body.back());
  }
  return out;
}

}  // namespace teracell::mesher

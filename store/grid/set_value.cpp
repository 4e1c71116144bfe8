#include "store/grid/set_value.hpp"

#include <algorithm>

namespace teracell::inline store {

SetValue strongest_material(const Metadata& meta) {
  return [&meta](const std::vector<Label>& set) {
    uint32_t best = meta.labels[set[0]].material;
    for (const Label label : set) {
      const uint32_t m = meta.labels[label].material;
      if (meta.materials[m].rank < meta.materials[best].rank) best = m;
    }
    return best;
  };
}

std::vector<uint32_t> materials_of(const Metadata& meta, const std::vector<Label>& set) {
  std::vector<uint32_t> materials;
  for (const Label label : set) materials.push_back(meta.labels[label].material);
  std::ranges::sort(materials);
  materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
  return materials;
}

}  // namespace teracell::store

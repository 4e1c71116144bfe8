// Which body wins where bodies overlap, and which label its cells get.
#pragma once
#include "mesher/scene/scene.hpp"
#include "store/grid/label.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::mesher {

struct Labels {
  std::vector<uint32_t> rank;           // of each body; rank 0 wins over all others
  std::vector<Label> of_body;           // label 0 is the background
  std::vector<Label> of_overlap;        // of each body's cells that lie in other bodies as well; the same where these are not kept apart
  std::vector<LabelInfo> labels;        // by label
  std::vector<MaterialInfo> materials;  // in the order of the scene, with their ranks
};

// Bodies rank by priority, the highest first; of bodies with equal priority, the later one ranks first. A material ranks as
// its strongest body does. Materials without a body follow in the order of the scene, and the background is last.
Labels make_labels(const Scene& scene);
// Whether body a ranks before body b.
bool is_stronger(const Scene& scene, uint32_t a, uint32_t b);

}  // namespace teracell::mesher

// Which body wins where several are, and what its cells are called.
#pragma once
#include "mesher/scene/scene.hpp"
#include "store/label.hpp"
#include "store/metadata.hpp"

namespace teracell {

struct Labels {
  std::vector<uint32_t> strength;       // of each body: 0 wins over all others
  std::vector<Label> of_body;           // label 0 is the background
  std::vector<LabelInfo> labels;        // by label
  std::vector<MaterialInfo> materials;  // as in the scene, with ranks
};

// Bodies: the highest priority first, of equals the later one. A material ranks as its strongest body; those without one
// after these, in the scene's order; the background last.
Labels make_labels(const Scene& scene);

}  // namespace teracell

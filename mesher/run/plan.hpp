// What is decided once the bodies are read: the grid, the axis of the rays, the labels, the size of the chunks.
#pragma once
#include <optional>

#include "mesher/bodies/bodies.hpp"
#include "mesher/scene/labels.hpp"
#include "store/channels/mixed_cells.hpp"

namespace teracell::mesher {

// Which axis the rays run along, and why.
struct AxisChoice {
  int axis = 2;
  bool asked_for = false;
  Vec3 crossings;  // expected along each axis
};

struct Plan {
  Metadata meta;
  AxisChoice rays;
  Labels labels;
  std::optional<PlanesReport> planes;  // when they were made
  bool all_patches = true;  // whether the file has room for all patches
};

// `axis` is the axis that the user asks for, if any. `fractions`: the sub-samples that mixed cells are counted by, if they are.
// `links`: the file has them.
Plan make_plan(const Scene& scene, const Bodies& bodies, std::optional<int> axis, uint32_t chunk_rays, std::optional<Subdivision> fractions = {},
               bool links = false);

}  // namespace teracell::mesher

// Bodies whose files hold exact surfaces: how fine their facets are to be, and their box, which is that of the exact surfaces.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "mesher/scene/scene.hpp"
#include "mesher/surface/read_options.hpp"

namespace teracell::mesher {

struct ExactSurfaces {
  std::vector<std::shared_ptr<const CadOptions>> of_body;  // null: its file has facets. Empty when all have
  std::optional<std::array<Vec3, 2>> box;                  // of all bodies with exact surfaces, as the grid sees them, where the grid needs it
  bool has(size_t body) const { return !of_body.empty() && of_body[body]; }
};

// `cad` has what is not the scene's: threads, limits, folder. A deflection in cells needs the grid, so where that follows from the bodies' box,
// surfaces with facets are read for their box, too; one that comes through a pipe is refused then.
ExactSurfaces plan_exact_surfaces(const Scene& scene, const CadOptions& cad, const Budget& budget);

}  // namespace teracell::mesher

// The surfaces of a scene, as every run begins with them.
#pragma once
#include <functional>

#include "mesher/bodies/bodies.hpp"
#include "mesher/run/mesh_options.hpp"

namespace teracell::mesher {

int threads_of(const MeshOptions& options);

// Reads all bodies, with the facets of exact surfaces as fine as the scene wants them, and finds their flat faces where planes are made. `progress`
// is called with "facets" or "read" and a share, and may throw. `count` and `again`: as for read_bodies().
Bodies read_scene(const Scene& scene, const MeshOptions& options, int threads, const Budget& budget, bool count, bool again,
                  const std::function<void(const char* phase, double share)>& progress);

}  // namespace teracell::mesher

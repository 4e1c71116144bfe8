// The bodies of a scene in memory: their facets in the grid's coordinates, and what reading them found.
#pragma once
#include <functional>
#include <vector>

#include "mesher/compose.hpp"
#include "mesher/facet_store.hpp"
#include "mesher/scene.hpp"

namespace teracell {

struct BodyFacets {
  SurfaceFile file;
  Fill rule = Fill::kNonzero;  // the one used: never kAuto
  std::string why;             // in words
  uint64_t first = 0;          // its facets in Bodies::facets are [first, first + file.facets)
};

struct Bodies {
  FacetStore facets;  // by body
  std::vector<BodyFacets> bodies;
  std::vector<Layer> layers;  // one a body
  Vec3 lo, hi;                // the box of all vertices
};

// Reads every mesh, on one thread or two. An open surface is an InputError that describes its boundary.
// `tick` is called every few thousand facets, with the bodies read so far as a share of 1.
Bodies read_bodies(const Scene& scene, int threads, const std::function<void(double)>& tick);

// What casting along an axis would cost: facet crossings expected, and rays.
struct AxisCost {
  double crossings, rays;
  double nanoseconds() const { return 25 * crossings + 3 * rays; }  // measured on smooth and on empty grids
};
std::array<AxisCost, 3> axis_costs(const FacetStore& facets, const Grid& grid);

}  // namespace teracell

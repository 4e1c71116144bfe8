#include "mesher/run/plan.hpp"

#include <algorithm>

#include "mesher/boundary/fractions.hpp"
#include "mesher/boundary/sub_axis.hpp"
#include "mesher/planes/make_planes.hpp"
#include "store/channels/fractions.hpp"
#include "store/channels/links.hpp"

namespace teracell::mesher {
namespace {

// Chunks are as long as the rays, up to the format's default. They are shorter where a chunk would hold millions of changes, or of links along
// any axis, so that reading one stays cheap. `crossings`: how many of these to expect in all.
uint32_t chunk_length(double crossings, double rays, int64_t cells, uint32_t chunk_rays) {
  uint32_t length = Metadata{}.chunk_cells;
  const double per_cell = crossings / rays * chunk_rays * chunk_rays / static_cast<double>(cells);
  while (length > 1024 && per_cell * std::min<double>(length, static_cast<double>(cells)) > 2e6) length /= 2;
  return length;
}

double rays_along(const Grid& grid, int axis) {
  const RayFrame f = RayFrame::along(axis);
  return static_cast<double>(grid.axis[f.u].cells()) * static_cast<double>(grid.axis[f.v].cells());
}

// The crossings to expect along each axis, and the axis that costs least: 25 ns per crossing and 3 ns per ray, measured on
// smooth and on empty grids. Among equals z is taken before y, and y before x: then rows of a picture along x stay rows. Sub-rays are rays.
AxisChoice choose_axis(const Grid& grid, const Vec3& area, std::optional<int> asked_for, const Subdivision& samples) {
  AxisChoice out;
  Vec3 cost;
  for (int w = 0; w < 3; ++w) {
    const RayFrame f = RayFrame::along(w);
    double rays_per_area = 1;
    for (const int d : {f.u, f.v}) rays_per_area *= static_cast<double>(grid.axis[d].cells()) / (grid.axis[d].max() - grid.axis[d].min());
    out.crossings[w] = area[w] * rays_per_area;
    cost[w] = (25 * out.crossings[w] + 3 * rays_along(grid, w)) * samples[f.u] * samples[f.v];
  }
  for (const int w : {1, 0})
    if (cost[w] < cost[out.axis]) out.axis = w;
  out.asked_for = asked_for.has_value();
  out.axis = asked_for.value_or(out.axis);
  return out;
}

}  // namespace

Plan make_plan(const Scene& scene, const Bodies& bodies, std::optional<int> axis, uint32_t chunk_rays, std::optional<Subdivision> fractions,
               bool links) {
  Plan plan;
  Metadata& meta = plan.meta;
  meta.units = scene.units;
  MadePlanes made;
  if (makes_planes(scene)) {
    std::vector<ShapeOfBody> shapes;
    for (const BodyFacets& body : bodies.bodies) shapes.push_back({body.lo, body.hi, &body.flat});
    made = make_planes(scene, shapes, bodies.lo, bodies.hi);
    plan.planes = std::move(made.report);
  }
  meta.grid = resolve_grid(scene, bodies.lo, bodies.hi, made.planes);
  plan.rays = choose_axis(meta.grid, bodies.area, axis, fractions.value_or(Subdivision{1, 1, 1}));
  const int w = plan.rays.axis;
  meta.ray_axis = w;
  meta.chunk_rays = chunk_rays;
  meta.chunk_cells = chunk_length(links ? plan.rays.crossings[0] + plan.rays.crossings[1] + plan.rays.crossings[2] : plan.rays.crossings[w],
                                  rays_along(meta.grid, w), meta.grid.cells()[w], chunk_rays);
  if (links && scene.label_by == LabelBy::kOverlap)
    throw UsageError("links lie where bodies end, not where overlaps do: with links, \"label_by\" is \"material\" or \"body\", not \"overlap\"");
  plan.labels = make_labels(scene);
  meta.materials = plan.labels.materials;
  meta.labels = plan.labels.labels;
  if (fractions) {
    check_sub_samples(meta.grid, *fractions);
    meta.channels.push_back(fractions_channel(*fractions));
  }
  if (links) meta.channels.push_back(links_channel());
  return plan;
}

}  // namespace teracell::mesher

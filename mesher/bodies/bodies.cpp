#include "mesher/bodies/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "mesher/closing/extrude.hpp"
#include "mesher/scene/placement.hpp"
#include "mesher/tiles/welded_records.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {

uint64_t Bodies::facet_count() const {
  uint64_t count = 0;
  for (const BodyFacets& b : bodies) count += b.file.facets;
  return count;
}

bool Bodies::float32() const {
  return std::ranges::all_of(bodies, [](const BodyFacets& b) { return b.file.float32; });
}

std::vector<SurfaceCounts> Bodies::wait_for_counts() {
  helper->finish_all();
  std::vector<SurfaceCounts> out;
  for (size_t b = 0; b < shells->size(); ++b) {
    out.push_back(bodies[b].facet_counts);
    out.back().shells = (*shells)[b];
  }
  return out;
}

void close_bodies(const Scene& scene, const Grid& grid, const Budget& budget, Bodies& bodies, const std::function<void(double)>& progress) {
  ClosingGrid closing_grid{HUGE_VAL, {}};
  for (const Axis& axis : grid.axis) closing_grid.shortest_edge = std::min(closing_grid.shortest_edge, axis.shortest_cell());
  constexpr size_t kMostLooks = 64;  // each reads a whole file; the first open parts are enough to say what is wrong with such a file
  size_t open_parts = 0;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    BodyFacets& found = bodies.bodies[b];
    if (body.kind == Kind::kSheet) continue;
    progress(static_cast<double>(b) / static_cast<double>(scene.bodies.size()));
    if (body.closing.way == Closing::Way::kExtrude) closing_grid.beyond = beyond(body.closing.axis, grid, bodies.lo, bodies.hi);
    open_parts += !body.part.empty() && !found.boundary.directed_boundary_is_empty();
    const Surface surface = {[&](const auto& f) { for_each_facet(body, found, bodies, budget, f); },
                             found.file.facets,
                             found.file.float32,
                             found.file.units,
                             bodies.in_memory,
                             found.boundary,
                             found.opposites,
                             open_parts <= kMostLooks,
                             bodies.kept.get(),
                             cad_or_usual(found.cad)};
    found.closed = close_body(body, surface, closing_grid, budget);
    if (!bodies.in_memory) continue;
    const ClosedBody& closed = found.closed;
    const uint64_t last = found.first + found.file.facets;
    if (uint64_t i = 0; closed.rules) bodies.facets->for_each(found.first, last, [&](SceneFacet& f) { f.layer = closed.rules->layer(b, i++); });
    else if (closed.layer(b) != layer_of(b, body.fill == Fill::kEvenodd))
      bodies.facets->for_each(found.first, last, [&](SceneFacet& f) { f.layer = closed.layer(b); });
    for (const bool parity : {false, true}) bodies.facets->append_all(closed.added[parity], layer_of(b, parity), kCapPatch);
  }
}

void for_each_facet(const SceneBody& body, const BodyFacets& found, const Bodies& bodies, const Budget& budget,
                    const std::function<void(const Facet&)>& f) {
  if (bodies.in_memory && !bodies.facets) throw std::logic_error("for_each_facet: the facets were handed on");
  if (bodies.in_memory) return bodies.facets->for_each(found.first, found.first + found.file.facets, [&](const SceneFacet& s) { f(s.facet); });
  const auto each = [&](std::span<const Facet> facets) {
    for (const Facet& facet : facets) f(facet);
  };
  if (!found.logged.empty()) {
    for (const LoggedFacets& logged : found.logged) read_logged(bodies, found, logged, each);
    return;
  }
  read_again(body, found, each, {.budget = budget, .kept = bodies.kept.get()});
}

void for_each_placed(const Scene& scene, const Bodies& bodies, const Budget& budget, const std::function<void(const Facet&, uint32_t layer)>& f) {
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const ClosedBody& closed = bodies.bodies[b].closed;
    const bool moves = body.matrix != kIdentity;
    uint64_t number = 0;
    for_each_facet(body, bodies.bodies[b], bodies, budget, [&](const Facet& facet) {
      f(moves ? moved(facet, body) : facet, closed.rules ? closed.rules->layer(b, number++) : closed.layer(b));
    });
    for (const bool parity : {false, true}) {
      for (const Facet& facet : closed.added[parity]) f(moved(facet, body), layer_of(b, parity));
      for (const Facet& facet : closed.walls[parity]) f(facet, layer_of(b, parity));
    }
  }
}

void read_logged(const Bodies& bodies, const BodyFacets& found, const LoggedFacets& logged, const FacetSink& sink) {
  std::vector<uint8_t> room;
  WeldedRecords block({3 * (found.file.float32 ? sizeof(float) : sizeof(double)), 0});
  std::vector<Facet> facets;
  WeldedRecords::for_each(bodies.log->read(logged.piece, room), [&](std::span<const uint8_t> bytes) {
    block.read(bytes);
    block.facets(facets);
    sink(facets);
  });
}

void read_again(const SceneBody& body, const BodyFacets& found, const FacetSink& sink, ReadOptions options) {
  options.units = found.file.units;
  options.cad = cad_or_usual(found.cad);
  options.face_patches = body.face_patches;
  const SurfaceFile file = read_facets(body.mesh, body.part, sink, options);
  if (file.cad && file.cad->hash != found.file.cad->hash)
    throw InputError(fmt::format("{}: the CAD kernel made other facets while it was meshed: their hash was {} and is {} now", body.mesh.string(),
                                 found.file.cad->hash, file.cad->hash));
  if (file.hash != found.file.hash)
    throw InputError(
        fmt::format("{}: the file changed while it was meshed: its hash was {} and is {} now", body.mesh.string(), found.file.hash, file.hash));
}

}  // namespace teracell::mesher

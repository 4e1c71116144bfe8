#include "mesher/bodies/exact_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <fmt/format.h>

#include "mesher/closing/lengths.hpp"
#include "mesher/scene/placement.hpp"
#include "mesher/surface/read_facets.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

void unite(std::optional<std::array<Vec3, 2>>& box, const Vec3& lo, const Vec3& hi) {
  if (!box) box = {lo, hi};
  extend((*box)[0], (*box)[1], lo);
  extend((*box)[0], (*box)[1], hi);
}

bool follows_from_box(const Scene& scene) {
  return std::ranges::any_of(scene.axis, [](const SceneAxis& a) { return a.planes.empty() && !a.min; });
}

// Of bodies whose files have facets.
void add_box_of_facets(const SceneBody& body, const Scene& scene, const Budget& budget, KeptTrees& kept, std::optional<std::array<Vec3, 2>>& box) {
  std::error_code ignored;
  if (std::filesystem::is_other(body.mesh, ignored))
    throw InputError(
        fmt::format("{}: expected a file: its box decides how fine the facets of other bodies are, so it is read twice: give the grid a domain, or "
                    "\"deflection\" as a length",
                    body.mesh.string()));
  read_facets(body.mesh, body.part,
              [&](std::span<const Facet> facets) {
                for (const Facet& f : facets)
                  for (const Vec3& v : f.vertex) {
                    const Vec3 p = moved(v, body);
                    unite(box, p, p);
                  }
              },
              {.budget = budget, .units = scene.units, .kept = &kept});
}

}  // namespace

ExactSurfaces plan_exact_surfaces(const Scene& scene, const CadOptions& cad, const Budget& budget) {
  std::map<std::filesystem::path, bool> files;
  std::vector<bool> exact;
  for (const SceneBody& body : scene.bodies) {
    const auto [known, fresh] = files.try_emplace(body.mesh, false);
    if (fresh) known->second = has_exact_surfaces(body.mesh);
    exact.push_back(known->second);
  }
  ExactSurfaces out;
  if (std::ranges::count(exact, true) == 0) return out;
  if (follows_from_box(scene)) {
    std::map<std::filesystem::path, std::vector<TakenParts>> taken;
    for (size_t b = 0; b < scene.bodies.size(); ++b)
      if (exact[b]) taken[scene.bodies[b].mesh].push_back({scene.bodies[b].part, scene.bodies[b].matrix});
    const auto options = std::make_shared<const CadOptions>(cad);
    for (const auto& [file, parts] : taken)
      if (const auto box = exact_box(file, parts, {.budget = budget, .units = scene.units, .cad = options})) unite(out.box, (*box)[0], (*box)[1]);
  }
  std::optional<double> cell;  // the shortest cell edge
  const auto shortest_cell = [&] {
    if (cell) return *cell;
    std::optional<std::array<Vec3, 2>> all = out.box;
    KeptTrees kept;
    if (follows_from_box(scene))
      for (size_t b = 0; b < scene.bodies.size(); ++b)
        if (!exact[b]) add_box_of_facets(scene.bodies[b], scene, budget, kept, all);
    std::array<std::vector<double>, 3> finest;  // of axes whose planes are made later
    for (int a = 0; a < 3; ++a)
      if (scene.axis[a].made) finest[a] = {0, scene.axis[a].made->finest};
    const Grid grid = resolve_grid(scene, all ? (*all)[0] : Vec3{}, all ? (*all)[1] : Vec3{}, finest);
    cell = HUGE_VAL;
    for (const Axis& axis : grid.axis) cell = std::min(*cell, axis.shortest_cell());
    return *cell;
  };
  std::map<std::pair<double, double>, std::shared_ptr<const CadOptions>> known;  // by deflection and angle: bodies that have the same share facets
  out.of_body.resize(scene.bodies.size());
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    if (!exact[b]) continue;
    const SceneBody& body = scene.bodies[b];
    const double length = body.deflection.in_cells ? body.deflection.value * shortest_cell() : body.deflection.value;
    const double deflection = length / longest_column(body.matrix);
    const auto [place, fresh] = known.try_emplace({deflection, body.angle});
    if (fresh) {
      auto options = std::make_shared<CadOptions>(cad);
      options->deflection = deflection;
      options->angle = body.angle;
      place->second = std::move(options);
    }
    out.of_body[b] = place->second;
  }
  return out;
}

}  // namespace teracell::mesher

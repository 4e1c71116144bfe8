#include "mesher/bodies/patches.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <fmt/format.h>

#include "mesher/scene/placement.hpp"
#include "mesher/surface/area.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

constexpr std::string_view kSides[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};

double area_of(const std::array<std::vector<Facet>, 2>& facets, const SceneBody* placed_by) {
  double sum = 0;
  for (const auto& of_rule : facets)
    for (const Facet& f : of_rule) sum += area(placed_by ? moved(f, *placed_by) : f);
  return sum;
}

constexpr size_t kRoomForNumber = 16;

// A name that fits into a file, with room for a body's name and a number.
std::string stored_name(const std::string& name) { return std::string(first_bytes(printable(first_bytes(name, kMostStem)), kMostStem / 2)); }

}  // namespace

Patches::Patches(const Scene& scene, const Bodies& bodies, const Grid& grid) {
  for (int side = 0; side < 6; ++side) {
    const Axis &a = grid.axis[(side / 2 + 1) % 3], &b = grid.axis[(side / 2 + 2) % 3];
    all_.push_back({std::string(kSides[side]), "", (a.max() - a.min()) * (b.max() - b.min())});
  }
  bodies_.resize(scene.bodies.size());
  std::unordered_map<std::string, uint32_t> bodies_with;  // how many have a patch of this name
  for (const std::string_view side : kSides) bodies_with[std::string(side)] = 2;
  for (const SceneBody& body : scene.bodies) ++bodies_with[body.name];
  const auto file_patches = [&](size_t b) -> std::span<const std::string> { return bodies.bodies[b].file.patches; };
  const auto is_body = [&](size_t b, const std::string& patch) { return !scene.bodies[b].patches || patch.empty() || patch == scene.bodies[b].name; };
  for (size_t b = 0; b < scene.bodies.size(); ++b)
    for (const std::string& patch : file_patches(b))
      if (!is_body(b, patch)) ++bodies_with[stored_name(patch)];

  std::unordered_map<std::string, int> used;
  for (const SceneBody& body : scene.bodies) used[body.name] = 1;
  for (const std::string_view side : kSides) used[std::string(side)] = 2;
  const auto unique = [&](std::string name) {
    while (used[name]++ > 0) name += fmt::format("-{}", used[name]);
    return name;
  };
  // What a file has room for beside the patches that every body may need: its own, a cap, and walls.
  size_t patches = kMostPatches - 6, bytes = kMostPatchNames;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const auto has = [](const auto& facets) { return !facets[0].empty() || !facets[1].empty(); };
    const size_t others = 1 + has(bodies.bodies[b].closed.added) + has(bodies.bodies[b].closed.walls);
    const size_t of_others = others * (2 * scene.bodies[b].name.size() + kRoomForNumber);
    if (patches < others || bytes < of_others) {
      whole_ = false;
      bodies_.assign(scene.bodies.size(), {});
      return;
    }
    patches -= others, bytes -= of_others;
  }
  const auto fits = [&](const std::string& name, const SceneBody& body) {
    const size_t size = 2 * body.name.size() + name.size() + kRoomForNumber;
    if (patches == 0 || bytes < size) return whole_ = false;
    --patches, bytes -= size;
    return true;
  };
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const BodyFacets& found = bodies.bodies[b];
    const auto add = [&](std::string name, double size) {
      all_.push_back({std::move(name), body.name, size});
      return static_cast<uint32_t>(all_.size() - 1);
    };
    OfBody& of = bodies_[b];
    uint32_t whole = kNoPatch;  // the body's own
    const auto own = [&](double size) {
      if (whole == kNoPatch) whole = add(std::ranges::find(kSides, body.name) == std::end(kSides) ? body.name : unique(body.name), 0);
      all_[whole].area += size;
      return whole;
    };
    for (size_t i = 0; i < file_patches(b).size(); ++i) {
      const std::string& patch = file_patches(b)[i];
      const std::string name = stored_name(patch);
      if (is_body(b, patch) || !fits(name, body)) of.of_file.push_back(own(found.areas[i]));
      else of.of_file.push_back(add(unique(bodies_with[name] > 1 ? fmt::format("{}:{}", stored_name(body.name), name) : name), found.areas[i]));
    }
    const auto added = [&](const auto& facets, const char* what, const SceneBody* placed_by) {
      if (facets[0].empty() && facets[1].empty()) return kNoPatch;
      const double size = area_of(facets, placed_by);
      return is_body(b, "-") ? own(size) : add(unique(fmt::format("{}:{}", first_bytes(body.name, kMostStem), what)), size);
    };
    of.cap = added(found.closed.added, "cap", &body);
    of.side = added(found.closed.walls, "side", nullptr);
  }
}

uint32_t Patches::of(uint32_t body, uint32_t patch) const {
  const OfBody& b = bodies_[body];
  if (patch == kCapPatch) return b.cap | kAddedFacet;
  if (patch == kSidePatch) return b.side | kAddedFacet;
  return patch < b.of_file.size() ? b.of_file[patch] : kNoPatch;
}

}  // namespace teracell::mesher

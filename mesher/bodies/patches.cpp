#include "mesher/bodies/patches.hpp"

#include <algorithm>
#include <unordered_map>

#include <fmt/format.h>

#include "mesher/scene/placement.hpp"
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

// Names that no two patches have.
class PatchNames {
 public:
  explicit PatchNames(const Scene& scene) {
    for (const SceneBody& body : scene.bodies) used_[body.name] = 1, ++bodies_with_[body.name];
    for (const std::string_view side : kSides) used_[std::string(side)] = 2, bodies_with_[std::string(side)] += 2;
  }
  // To be called for the patches of all bodies before of_file().
  void count(const std::string& name) { ++bodies_with_[name]; }
  std::string unique(std::string name) {
    while (used_[name]++ > 0) name += fmt::format("-{}", used_[name]);
    return name;
  }
  // Of a patch of a body's file.
  std::string of_file(const std::string& name, const SceneBody& body) {
    return unique(bodies_with_[name] > 1 ? fmt::format("{}:{}", stored_name(body.name), name) : name);
  }

 private:
  std::unordered_map<std::string, int> used_;
  std::unordered_map<std::string, uint32_t> bodies_with_;  // how many have a patch of this name
};

// What a file has room for.
class Room {
 public:
  // Takes room for patches with these bytes of names, if there is as much.
  bool take(size_t patches, size_t bytes) {
    if (patches_ < patches || bytes_ < bytes) return false;
    patches_ -= patches, bytes_ -= bytes;
    return true;
  }

 private:
  size_t patches_ = kMostPatches - 6, bytes_ = kMostPatchNames;
};

bool is_empty(const std::array<std::vector<Facet>, 2>& facets) { return facets[0].empty() && facets[1].empty(); }

}  // namespace

Patches::Patches(const Scene& scene, const Bodies& bodies, const Grid& grid) {
  for (int side = 0; side < 6; ++side) {
    const Axis &a = grid.axis[(side / 2 + 1) % 3], &b = grid.axis[(side / 2 + 2) % 3];
    all_.push_back({std::string(kSides[side]), "", (a.max() - a.min()) * (b.max() - b.min())});
  }
  bodies_.resize(scene.bodies.size());
  const auto is_body = [&](size_t b, const std::string& patch) { return !scene.bodies[b].patches || patch.empty() || patch == scene.bodies[b].name; };
  PatchNames names(scene);
  for (size_t b = 0; b < scene.bodies.size(); ++b)
    for (const std::string& patch : bodies.bodies[b].file.patches)
      if (!is_body(b, patch)) names.count(stored_name(patch));

  // The patches that every body may need come first: its own, a cap, and walls.
  Room room;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const size_t others = 1 + !is_empty(bodies.bodies[b].closed.added) + !is_empty(bodies.bodies[b].closed.walls);
    if (room.take(others, others * (2 * scene.bodies[b].name.size() + kRoomForNumber))) continue;
    whole_ = false;
    bodies_.assign(scene.bodies.size(), {});
    return;
  }
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
      if (whole == kNoPatch) whole = add(std::ranges::find(kSides, body.name) == std::end(kSides) ? body.name : names.unique(body.name), 0);
      all_[whole].area += size;
      return whole;
    };
    for (size_t i = 0; i < found.file.patches.size(); ++i) {
      const std::string name = stored_name(found.file.patches[i]);
      const bool is_own = is_body(b, found.file.patches[i]);
      const bool fits = is_own || room.take(1, 2 * body.name.size() + name.size() + kRoomForNumber);
      whole_ = whole_ && fits;
      of.of_file.push_back(is_own || !fits ? own(found.areas[i]) : add(names.of_file(name, body), found.areas[i]));
    }
    const auto added = [&](const auto& facets, const char* what, const SceneBody* placed_by) {
      if (is_empty(facets)) return kNoPatch;
      const double size = area_of(facets, placed_by);
      return is_body(b, "-") ? own(size) : add(names.unique(fmt::format("{}:{}", first_bytes(body.name, kMostStem), what)), size);
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

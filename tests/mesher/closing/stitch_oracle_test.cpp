// Stitching and closing against the oracle: the cells of random surfaces, torn in the ways that real ones are.
#include "tests/support/closing_oracle.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/patchworks.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;
using shapes::Facets;

bool chance(std::mt19937_64& random, int percent) { return random_int(random, 1, 100) <= percent; }

template <class T>
const T& one_of(std::mt19937_64& random, const std::vector<T>& list) {
  return list[static_cast<size_t>(random_int(random, 0, static_cast<int>(list.size()) - 1))];
}

// Everything is within [1, 11], so that float32 coordinates have few bits and the oracle is quick.
Facets closed_surface(std::mt19937_64& random) {
  const double x = random_in(random, 4.5, 7.5), y = random_in(random, 4.5, 7.5), z = random_in(random, 4.5, 7.5);
  switch (random_int(random, 0, 4)) {
    case 0: return shapes::sphere({x, y, z}, 3.2, 1);
    case 1: return shapes::sphere({x, y, z}, 2.5, 2);
    case 2: return shapes::torus({x, y, z}, 2.3, 1.1, 6, 5);
    case 3: return shapes::l_shape({x - 2.5, y - 2.5, z - 2.5}, 5, 2, 4);
    default: return shapes::box({x - 3, y - 2, z - 1}, {x + 2, y + 3, z + 3});
  }
}

// A surface whose seams gape by about `gap`.
Facets torn(std::mt19937_64& random, double gap) {
  const Facets whole = closed_surface(random);
  patchworks::Patches patches = chance(random, 50) ? patchworks::cut_by_seeds(whole, random, static_cast<size_t>(random_int(random, 1, 4)))
                                                   : patchworks::cut_by_planes(whole, random, random_int(random, 1, 2));
  for (Facets& patch : patches) {
    if (chance(random, 30)) patch = patchworks::chords(patch, random, 0.5, gap);
    if (chance(random, 40))
      patch = patchworks::split(patch, random, one_of<double>(random, {0.3, 1}), chance(random, 50) ? gap : 0, random_int(random, 1, 2));
    if (chance(random, 70)) patch = patchworks::moved(patch, random, gap);
    if (chance(random, 15)) patch = shapes::flip(patch);
    if (chance(random, 10)) patch = shapes::join({patch, shapes::flip(patch)});
    if (chance(random, 10)) patch = shapes::join({patch, {patch[0], patch[patch.size() / 2]}});
    if (chance(random, 20) && patch.size() > 2) patch.erase(patch.begin() + 1);
    if (chance(random, 10)) patch.push_back({{patch[0].vertex[0], patch[0].vertex[0], patch[0].vertex[1]}});
  }
  Facets out = shapes::join(patches);
  if (chance(random, 10)) out = shapes::join({out, shapes::flip(out)});
  return out;
}

struct TornScene {
  Facets facets;
  Fill fill;
  bool float32;
  std::optional<double> stitch;
  Matrix matrix;
  Grid grid;
  double tau() const {
    double edge = HUGE_VAL;
    for (const Axis& a : grid.axis)
      for (int64_t i = 0; i < a.cells(); ++i) edge = std::min(edge, a.is_graded() ? a.plane(i + 1) - a.plane(i) : a.step());
    return oracle::stitch_in_file(stitch.value_or(edge / 4), matrix);
  }
};

TornScene torn_scene(uint64_t seed) {
  std::mt19937_64 random(seed);
  TornScene s;
  s.float32 = chance(random, 75);
  s.fill = one_of<Fill>(random, {Fill::kAuto, Fill::kAuto, Fill::kAuto, Fill::kNonzero, Fill::kEvenodd, Fill::kDistinct});
  s.stitch = one_of<std::optional<double>>(random, {{}, {}, 0, 0.02, 0.4, 1.1});
  s.matrix = one_of<Matrix>(random, {kIdentity, kIdentity, {0, -1, 0, 12, 1, 0, 0, 0, 0, 0, 1, 0}, {0, 0, 0.5, 0, 0.75, 0, 0, 0, 0, -0.25, 0, 4}});
  const double size = s.matrix[2] == 0 ? 1 : 0.5;  // of cells: the last matrix shrinks
  s.grid = {{Axis::uniform(0.125, size, 0, 12, 0.5), Axis::uniform(0, 1.25 * size, 0, 9, 0.25), Axis::uniform(0, 1.03125 * size, 0, 11, 0.5)}};
  if (chance(random, 25)) s.grid.axis[random_int(random, 0, 2)] = Axis::graded({0.5, 1, 1.75, 2.5, 3.5, 4.75, 6, 7, 8.25, 9.5, 10.75}, 0.5);
  const double gap = std::max(s.tau(), 0.01) * one_of<double>(random, {0.3, 0.3, 0.45, 0.9, 1.5});
  std::vector<Facets> shells;
  for (int i = random_int(random, 1, 2); i > 0; --i) shells.push_back(torn(random, gap));
  if (chance(random, 30)) shells.push_back(closed_surface(random));
  if (chance(random, 15)) {
    shells.push_back(closed_surface(random));
    shells.back()[2] = shapes::flip({shells.back()[2]})[0];
  }
  s.facets = shapes::join(shells);
  std::ranges::shuffle(s.facets, random);
  if (s.float32)
    for (Facet& f : s.facets)
      for (Vec3& v : f.vertex)
        for (double& x : v) x = static_cast<float>(x);
  return s;
}

// The surface closed by the oracle, as the grid sees it.
std::vector<Body> closed_bodies(const TornScene& s) {
  const auto closed = oracle::closed(s.facets, s.fill, s.tau(), s.float32);
  std::vector<Body> bodies = {{closed.nonzero, Rule::kNonzero}, {closed.evenodd, Rule::kEvenodd}};
  for (Body& b : bodies)
    for (Facet& f : b.facets)
      for (Vec3& v : f.vertex) v = transform(s.matrix, v);
  return bodies;
}

TEST_CASE("Torn surfaces have the cells that another reading of the rules gives them") {
  const TempFolder folder;
  for (uint64_t seed = 0; seed < rounds(150); ++seed) {
    INFO("seed " << seed);
    const TornScene s = torn_scene(seed);
    Scene scene = scene_of(folder, {{s.facets}}, s.grid);
    SceneBody& body = scene.bodies[0];
    if (s.float32) {
      body.mesh = folder / "body0.ply";
      shapes::write_ply(body.mesh, s.facets, shapes::Encoding::kLittleEndian, false);
    }
    body.fill = s.fill;
    body.stitch = s.stitch;
    body.matrix = s.matrix;
    const auto expected = oracle::materials(closed_bodies(s), s.grid);
    for (int axis = 0; axis < 3; ++axis) {
      MeshOptions options{.axis = axis};
      if (static_cast<uint64_t>(axis) == seed % 3) options.memory = 1;  // spilled
      mesh_quietly(scene, folder / "g.tcell", options);
      const auto cells = all_cells(GridReader(folder / "g.tcell"));
      REQUIRE(std::ranges::mismatch(cells, expected).in1 == cells.end());
    }
  }
}

}  // namespace
}  // namespace teracell::mesher

// Leaves against their definition.
#include "store/refine/leaves.hpp"

#include "tests/support/meshed.hpp"
#include "tests/support/random.hpp"
#include "tests/support/refined.hpp"
#include "tests/support/shared_files.hpp"

namespace teracell {
namespace {

using namespace testing;

std::vector<Leaf> leaves_of(Leaves& leaves, const Box& region, int threads = 1) {
  leaves.prepare(region, threads, [](double) {});
  std::vector<Leaf> out;
  leaves.for_each(
      region, threads, [](double) {}, [&](std::span<const Leaf> some) { out.insert(out.end(), some.begin(), some.end()); });
  return out;
}

std::string text_of(const Leaf& l) { return fmt::format("level {} at {} {} {}, label {}", l.level, l.cell[0], l.cell[1], l.cell[2], l.label); }

void expect_same(const std::vector<Leaf>& found, const std::vector<Leaf>& expected) {
  for (size_t i = 0; i < std::min(found.size(), expected.size()); ++i)
    if (found[i] != expected[i]) FAIL("leaf " << i << ": found " << text_of(found[i]) << ", expected " << text_of(expected[i]));
  REQUIRE(found.size() == expected.size());
}

LeafCounts counted(const std::vector<Leaf>& leaves) {
  LeafCounts out;
  for (const Leaf& leaf : leaves) ++out[{leaf.level, leaf.label}];
  return out;
}

Refinement random_refinement(std::mt19937_64& random, const Index3& n, uint32_t materials) {
  Refinement r;
  r.coarsest = random_int(random, 0, 7);
  r.layers = random_int(random, 0, 9) == 0 ? random_int(random, 4, 9) : random_int(random, 1, 3);
  const auto level = [&] { return random() % 2 == 0 ? 0 : random_int(random, 0, r.coarsest + 1); };
  if (random() % 3 == 0) r.interfaces = level();
  const auto some = [&](std::vector<int>& levels) {
    if (random() % 4 != 0) return;
    levels.assign(materials, kNoLevel);
    levels[random() % materials] = level();
  };
  some(r.of_materials), some(r.inside);
  if (random() % 4 == 0) {
    Box box;
    for (size_t d = 0; d < 3; ++d) box.lo[d] = random_int(random, 0, static_cast<int>(n[d]) - 1), box.hi[d] = box.lo[d] + random_int(random, 1, 9);
    for (size_t d = 0; d < 3; ++d) box.hi[d] = std::min(box.hi[d], n[d]);
    r.boxes.push_back({box, level()});
  }
  return r;
}

TEST_CASE("The leaves of random grids, selectors and regions are those of the definition, for any ray axis, chunks and threads", "[long]") {
  const TempFolder folder;
  for (int seed = 0; seed < 60; ++seed) {
    std::mt19937_64 random(static_cast<uint64_t>(seed));
    Index3 n;
    for (int64_t& cells : n) cells = random_int(random, 1, 40);
    if (seed % 5 == 0) n[random() % 3] = random_int(random, 100, 420);  // several blocks
    const auto cells = random() % 4 == 0 ? random_cells(random, n, 3) : blobs(random, n, 3);
    Metadata meta = metadata_of(unit_grid(n), seed % 3, 3);
    if (random() % 2 == 0) meta = with_tiny_chunks(std::move(meta));
    const GridReader reader = reader_of(meta, cells);
    const Refinement refinement = random_refinement(random, n, 3);
    INFO("seed " << seed << ", " << n[0] << " x " << n[1] << " x " << n[2] << ", M " << refinement.coarsest << ", N " << refinement.layers);
    const Box whole = reader.meta().grid.box(0);
    const auto expected = leaves_by_definition(meta, cells, refinement, whole);
    Leaves leaves(reader, refinement, folder.path());
    expect_same(leaves_of(leaves, whole, 1 + seed % 3), expected);
    CHECK(leaves.count(whole, 2, [](double) {}) == counted(expected));

    Box region;
    for (size_t d = 0; d < 3; ++d)
      region.lo[d] = random_int(random, 0, static_cast<int>(n[d]) - 1),
      region.hi[d] = random_int(random, static_cast<int>(region.lo[d]) + 1, static_cast<int>(n[d]));
    Leaves alone(reader, refinement, folder.path());
    expect_same(leaves_of(alone, region), leaves_by_definition(meta, cells, refinement, region));
    expect_same(leaves_of(alone, whole), expected);  // what the region needed is there, and the rest is made
  }
}

TEST_CASE("Faces on a patch of the surface want its level, and those of a material the finer of both") {
  const TempFolder folder;
  const GridReader reader =
      meshed_reader({{shapes::box({3, 4, 5}, {30, 21, 22})}, {shapes::tetrahedron({20, 6, 8}, {52, 9, 10}, {24, 33, 12}, {26, 12, 36})}},
                    unit_grid({60, 40, 40}), {.links = true});
  const Metadata& meta = reader.meta();
  const LinkReader links(reader);
  std::map<std::pair<Index3, int>, uint32_t> patches;
  for (int axis = 0; axis < 3; ++axis)
    links.for_each(axis, meta.grid.box(0), [&](std::span<const CellLink> found) {
      for (const CellLink& link : found) patches[{link.cell, axis}] = link.patch;
    });
  std::vector<Label> cells;
  for (const uint32_t cell : all_cells(reader)) cells.push_back(cell);  // a label for each material
  const Box whole = meta.grid.box(0);
  for (const char* more : {"", ",material:"}) {
    std::string wants = fmt::format("interface=3,patch:{}=1", meta.patches[7].name);
    if (*more != 0) wants += fmt::format("{}{}=2", more, meta.materials[1].name);
    const Refinement refinement = parse_refinement(meta, 4, 1, wants);
    const auto expected = leaves_by_definition(meta, cells, refinement, whole, [&](const Index3& cell, int axis) {
      return patches.at({cell, axis});
    });
    CHECK(counted(expected).size() > 4);
    Leaves leaves(reader, refinement, folder.path());
    expect_same(leaves_of(leaves, whole), expected);
  }
}

TEST_CASE("The leaves of real surfaces are those of the definition, for any ray axis", "[long]") {
  const auto meshes = shared_files("meshes");
  if (!meshes) return;
  const TempFolder folder;
  for (const char* name : {"fandisk.obj", "rocker-arm.obj", "furnace/shield.obj"}) {
    std::vector<Leaf> first;
    for (int axis = 0; axis < 3; ++axis) {
      CAPTURE(name, axis);
      mesher::Scene scene = mesher::bare_scene({*meshes / name});
      for (size_t d = 0; d < 3; ++d) scene.axis[d].cells = std::array{53, 47, 71}[d];
      mesh_quietly(scene, folder / "g.tcell", {.axis = axis});
      const GridReader reader(folder / "g.tcell");
      std::vector<Label> cells;
      for (const uint32_t cell : all_cells(reader)) cells.push_back(cell);
      const Box whole = reader.meta().grid.box(0);
      Leaves leaves(reader, {.coarsest = 5, .layers = 2}, folder.path());
      const auto found = leaves_of(leaves, whole);
      if (axis == 0) expect_same(first = found, leaves_by_definition(reader.meta(), cells, {.coarsest = 5, .layers = 2}, whole));
      else expect_same(found, first);
    }
    CHECK(counted(first).size() >= 4);
  }
}

}  // namespace
}  // namespace teracell

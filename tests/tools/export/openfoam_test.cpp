#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"
#include "tests/tools/export/foam_check.hpp"
#include "tools/export/formats.hpp"

using namespace teracell;
using namespace teracell::exports;
using namespace teracell::testing;
using namespace teracell::testing::foam;
namespace fs = std::filesystem;

namespace {

using Options = std::map<std::string, std::string>;

void export_case(const GridReader& reader, const Box& box, const fs::path& folder, const Options& options = {}, int level = 0) {
  export_format_named("openfoam")->write({reader, level, box, folder, [](double) {}, {}, options});
}

Axis uneven(std::mt19937_64& random, int64_t cells) {
  std::vector<double> planes = {random_in(random, -3, 3)};
  for (int64_t i = 0; i < cells; ++i) planes.push_back(planes.back() + random_in(random, 0.1, 2));
  return Axis::graded(planes, 0.5);
}

Metadata random_meta(std::mt19937_64& random, const Index3& n, uint32_t materials) {
  Grid grid;
  for (int d = 0; d < 3; ++d)
    grid.axis[d] = random_int(random, 0, 1) == 0 ? Axis::uniform(-1.3, 0.7, random_int(random, 0, 5), n[d], 0.5) : uneven(random, n[d]);
  return with_tiny_chunks(metadata_of(grid, random_int(random, 0, 2), materials));
}

Box random_box(std::mt19937_64& random, const Index3& n) {
  Box box;
  for (int d = 0; d < 3; ++d) {
    box.lo[d] = random_int(random, 0, static_cast<int>(n[d]) - 1);
    box.hi[d] = random_int(random, static_cast<int>(box.lo[d]) + 1, static_cast<int>(n[d]));
  }
  return box;
}

}  // namespace

TEST_CASE("A mesh has the cells of its materials and a patch for each thing beyond, in parts or as a whole", "[openfoam]") {
  std::mt19937_64 random(13);
  int checked = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const TempFolder folder;
    const Index3 n{random_int(random, 1, 14), random_int(random, 1, 12), random_int(random, 1, 10)};
    const auto materials = static_cast<uint32_t>(random_int(random, 2, 5));
    Metadata meta = random_meta(random, n, materials);
    meta.units = trial % 2 == 0 ? "mm" : "m";
    store_cells(folder / "g.tcell", meta, random_cells(random, n, materials));
    const GridReader reader(folder / "g.tcell");
    const int level = random_int(random, 0, 1);
    const Box box = random_int(random, 0, 1) == 0 ? meta.grid.box(level) : random_box(random, meta.grid.cells(level));
    Options options;
    std::set<uint32_t> fluid = {0};
    if (random_int(random, 0, 1) == 0) options["--fluid"] = "m1,m0", fluid = {0, 1};
    if (random_int(random, 0, 2) == 0) {
      options["--zones"];
      if (!options.contains("--fluid"))
        for (uint32_t m = 0; m < materials; ++m) fluid.insert(m);
    }
    Expected e(reader, level, box, trial % 2 == 0 ? 0.001 : 1.0, fluid);
    if (random_int(random, 0, 1) == 0) {
      options["--drop-unreachable"];
      if (!e.cells.empty()) e.drop_unreachable();
    }
    INFO("trial " << trial);
    if (e.cells.empty()) {
      CHECK_THROWS_AS(export_case(reader, box, folder / "case", options, level), UsageError);
      CHECK_FALSE(fs::exists(folder / "case"));
      continue;
    }
    ++checked;
    export_case(reader, box, folder / "case", options, level);
    const PolyMesh whole(folder / "case" / "constant" / "polyMesh");
    check_mesh(e, whole, all_numbers(e), false);
    CHECK(whole.zones.empty() == !options.contains("--zones"));
    if (options.contains("--zones")) check_zones(e, whole, all_numbers(e));
    for (const Patch& p : whole.patches) CHECK(p.faces > 0);
    const int ranks = random_int(random, 1, static_cast<int>(std::min<size_t>(e.cells.size(), 9)));
    options["--ranks"] = std::to_string(ranks);
    export_case(reader, box, folder / "case", options, level);
    check_parts(e, whole, folder / "case", ranks, options.contains("--zones"));
  }
  CHECK(checked > 40);
}

TEST_CASE("A case gets the dictionaries that it lacks, once the mesh is complete, and those that are there stay", "[openfoam]") {
  std::mt19937_64 random(3);
  const TempFolder folder;
  const Metadata meta = random_meta(random, {4, 3, 2}, 1);
  store_cells(folder / "g.tcell", meta, std::vector<Label>(24));
  const GridReader reader(folder / "g.tcell");
  const auto told = [&](const Options& options) {
    std::string out;
    export_format_named("openfoam")
        ->write({reader, 0, meta.grid.box(0), folder / "case", [](double) {}, {}, options, [&](const std::string& sentence) { out += sentence; }});
    return out;
  };
  const fs::path system = folder / "case" / "system";
  fs::create_directories(system);
  std::ofstream(system / "fvSchemes") << "mine";
  CHECK_THAT(told({}), Catch::Contains("case: system/controlDict, system/fvSolution are written"));
  CHECK(file_bytes(system / "fvSchemes").size() == 4);
  for (const char* name : {"controlDict", "fvSolution"}) {
    const Bytes text = file_bytes(system / name);
    CHECK(std::string(text.begin(), text.end()).find(fmt::format("object      {};", name)) != std::string::npos);
  }
  CHECK_THAT(told({{"--ranks", "3"}}), Catch::Contains("case: system/decomposeParDict is written"));
  const Bytes text = file_bytes(system / "decomposeParDict");
  CHECK(std::string(text.begin(), text.end()).find("numberOfSubdomains 3;") != std::string::npos);
  CHECK_THROWS_AS(told({}), UsageError);  // there is a mesh
  fs::remove_all(folder / "case" / "constant");
  CHECK(told({}).empty());
  for (const char* mesh : {"constant", "processor0", "processor1", "processor2"}) fs::remove_all(folder / "case" / mesh);
  CHECK_THAT(told({{"--ranks", "2"}}),
             Catch::Contains("case: system/decomposeParDict says numberOfSubdomains 3, and the mesh has 2 parts: change it"));
  CHECK_THROWS_AS(told({{"--fluid", "none"}}), UsageError);
}

TEST_CASE("Walls are told apart by the patches of the surface, in parts or as a whole", "[openfoam]") {
  std::mt19937_64 random(29);
  const TempFolder folder;
  // The sides of each body are patches of their own; the second one overlaps the first one.
  for (const auto& [name, lo, hi] : {std::tuple("a", 2.3, 8.6), {"b", 5.2, 11.7}}) {
    std::ofstream out(folder / fmt::format("{}.obj", name));
    for (int i = 0; i < 8; ++i) out << fmt::format("v {} {} {}\n", i & 1 ? hi : lo, i & 2 ? hi : lo, i & 4 ? hi : lo);
    const char* faces[] = {"1 5 7 3", "2 4 8 6", "1 2 6 5", "3 7 8 4", "1 3 4 2", "5 6 8 7"};
    for (int i = 0; i < 6; ++i) out << fmt::format("g {}{}\nf {}\n", name, i, faces[i]);
  }
  for (int trial = 0; trial < 12; ++trial) {
    mesher::Scene scene = mesher::bare_scene({folder / "a.obj", folder / "b.obj"});
    for (mesher::SceneAxis& axis : scene.axis) axis.min = 0, axis.max = 14, axis.cells = 14;
    mesh_quietly(scene, folder / "g.tcell", {.axis = trial % 3, .links = true, .chunk_rays = 4});
    const GridReader reader(folder / "g.tcell");
    const Box box = trial == 0 ? reader.meta().grid.box(0) : random_box(random, {14, 14, 14});
    Options asked = {{"--patches", ""}};
    std::set<uint32_t> fluid = {0};
    if (trial % 2 == 1) asked["--fluid"] = reader.meta().materials[0].name + ",b", fluid = {0, 2};
    Expected e(reader, 0, box, 1, fluid);
    if (e.cells.empty()) continue;
    e.read_patches(reader);
    INFO("trial " << trial);
    export_case(reader, box, folder / "case", asked);
    const PolyMesh whole(folder / "case" / "constant" / "polyMesh");
    check_mesh(e, whole, all_numbers(e), false);
    if (trial == 0) CHECK(whole.patches.size() > 6 + 8);
    asked["--ranks"] = std::to_string(std::min<size_t>(e.cells.size(), 5));
    export_case(reader, box, folder / "case", asked);
    check_parts(e, whole, folder / "case", static_cast<int>(std::min<size_t>(e.cells.size(), 5)), false);
    fs::remove_all(folder / "case");
    if (trial == 0)
      CHECK_THROWS_WITH(export_case(reader, reader.meta().grid.box(1), folder / "case", asked, 1), Catch::Contains("expected --level 0"));
  }
  Metadata meta = random_meta(random, {3, 3, 3}, 2);
  store_cells(folder / "plain.tcell", meta, random_cells(random, {3, 3, 3}, 2));
  const GridReader plain(folder / "plain.tcell");
  CHECK_THROWS_WITH(export_case(plain, meta.grid.box(0), folder / "case", {{"--patches", ""}}), Catch::Contains("no links"));
  CHECK_FALSE(fs::exists(folder / "case"));
}

TEST_CASE("Every cell may be a part of its own", "[openfoam]") {
  std::mt19937_64 random(5);
  const TempFolder folder;
  const Index3 n{4, 3, 3};
  const Metadata meta = random_meta(random, n, 2);
  store_cells(folder / "g.tcell", meta, random_cells(random, n, 2));
  const GridReader reader(folder / "g.tcell");
  const Expected e(reader, 0, meta.grid.box(0), 1, {0, 1});
  export_case(reader, e.box, folder / "case", {{"--zones", ""}});
  export_case(reader, e.box, folder / "case", {{"--zones", ""}, {"--ranks", "36"}});
  check_parts(e, PolyMesh(folder / "case" / "constant" / "polyMesh"), folder / "case", 36, true);
  CHECK_THROWS_AS(export_case(reader, e.box, folder / "other", {{"--zones", ""}, {"--ranks", "37"}}), UsageError);
}

TEST_CASE("A block in one corner of a graded grid has its wall there", "[openfoam]") {
  const TempFolder folder;
  const Index3 n{7, 6, 5};
  std::mt19937_64 random(3);
  Grid grid;
  for (int d = 0; d < 3; ++d) grid.axis[d] = uneven(random, n[d]);
  for (const int ray_axis : {0, 1, 2}) {
    std::vector<Label> cells(static_cast<size_t>(n[0] * n[1] * n[2]), 0);
    for (int64_t z = 0; z < 1; ++z)
      for (int64_t y = 0; y < 2; ++y)
        for (int64_t x = 4; x < 7; ++x) cells[static_cast<size_t>((z * n[1] + y) * n[0] + x)] = 1;
    const fs::path file = folder / fmt::format("{}.tcell", ray_axis), out = folder / fmt::format("case{}", ray_axis);
    store_cells(file, with_tiny_chunks(metadata_of(grid, ray_axis, 2)), cells);
    const GridReader reader(file);
    export_case(reader, grid.box(0), out);
    const PolyMesh mesh(out / "constant" / "polyMesh");
    check_mesh(Expected(reader, 0, grid.box(0), 1, {0}), mesh, all_numbers(Expected(reader, 0, grid.box(0), 1, {0})), false);
    const auto wall = std::ranges::find(mesh.patches, "m1", &Patch::name);
    REQUIRE(wall != mesh.patches.end());
    CHECK(wall->faces == 2 * 1 + 3 * 1 + 3 * 2);  // across x, y, z: the other sides are the domain's
    CHECK(mesh.owner.size() - mesh.neighbour.size() == 2 * (7 * 6 + 7 * 5 + 6 * 5));
  }
}

TEST_CASE("More than 256 materials become patches whose names are words of OpenFOAM", "[openfoam]") {
  const TempFolder folder;
  std::mt19937_64 random(11);
  const Index3 n{12, 11, 10};
  constexpr uint32_t kManyLabels = 40;
  Metadata meta = random_meta(random, n, 700);
  meta.labels.resize(kManyLabels);
  for (uint32_t i = 1; i < kManyLabels; ++i) meta.labels[i].material = 700 - kManyLabels + i;
  store_cells(folder / "g.tcell", meta, random_cells(random, n, kManyLabels));
  const GridReader reader(folder / "g.tcell");
  export_case(reader, meta.grid.box(0), folder / "case");
  const Expected e(reader, 0, meta.grid.box(0), 1, {0});
  const PolyMesh mesh(folder / "case" / "constant" / "polyMesh");
  check_mesh(e, mesh, all_numbers(e), false);
  CHECK(mesh.patches.size() > 15);

  Metadata odd = with_tiny_chunks(metadata_of(meta.grid, 0, 6));
  const char* names[] = {"air", "a b", "a;b", "xmin", "1/2 {", "Beton für \"Wände\""};
  for (size_t i = 0; i < 6; ++i) odd.materials[i].name = names[i];
  store_cells(folder / "odd.tcell", odd, random_cells(random, n, 6));
  export_case(GridReader(folder / "odd.tcell"), meta.grid.box(0), folder / "odd");
  std::set<std::string> walls;
  for (const Patch& p : PolyMesh(folder / "odd" / "constant" / "polyMesh").patches)
    if (p.type == "wall") walls.insert(p.name);
  CHECK(walls == std::set<std::string>{"a_b", "a_b_2", "xmin_2", "_1_2__", "Beton_f__r__W__nde_"});
}

TEST_CASE("A case may hold other files, and a mesh in it is never touched", "[openfoam]") {
  const TempFolder folder;
  std::mt19937_64 random(2);
  const Index3 n{5, 4, 3};
  const Metadata meta = random_meta(random, n, 2);
  store_cells(folder / "g.tcell", meta, random_cells(random, n, 2));
  const GridReader reader(folder / "g.tcell");
  const Box box = meta.grid.box(0);
  const fs::path dir = folder / "case";
  fs::create_directories(dir / "constant" / "triSurface");
  fs::create_directories(dir / "0");
  const auto interrupted = [&](double stop, const Options& options) {
    const auto progress = [&](double share) {
      if (share >= stop) throw Interrupted("stopped");
    };
    CHECK_THROWS_AS(export_format_named("openfoam")->write({reader, 0, box, dir, progress, {}, options}), Interrupted);
  };
  for (const double stop : {0.0, 0.2, 0.5, 1.0})
    for (const Options& options : {Options{}, Options{{"--ranks", "2"}}}) {
      interrupted(stop, options);
      std::set<std::string> left;
      for (const auto& entry : fs::recursive_directory_iterator(dir)) left.insert(fs::relative(entry.path(), dir));
      CHECK((left == std::set<std::string>{"0", "constant", "constant/triSurface"}));
    }
  fs::create_directories(dir / "polyMesh-export" / "constant");  // of a run that was killed as it ended
  CHECK_THROWS_WITH(export_case(reader, box, dir), Catch::Contains("polyMesh-export: expected no folder"));
  fs::remove_all(dir / "polyMesh-export");
  export_case(reader, box, dir);
  CHECK(fs::exists(dir / "constant" / "triSurface"));
  CHECK_FALSE(fs::exists(dir / "polyMesh-export"));
  const std::string before = bytes_of(dir / "constant" / "polyMesh" / "faces");
  CHECK_THROWS_AS(export_case(reader, {{0, 0, 0}, {2, 2, 2}}, dir, {{"--zones", ""}}), UsageError);
  CHECK((bytes_of(dir / "constant" / "polyMesh" / "faces") == before));
  export_case(reader, box, dir, {{"--zones", ""}, {"--ranks", "3"}});
  // Meshes for other ranks would be mixed with those that are there.
  CHECK_THROWS_AS(export_case(reader, box, dir, {{"--zones", ""}, {"--ranks", "2"}}), UsageError);
}

TEST_CASE("Options of a mesh that can't be followed are refused with the reason", "[openfoam]") {
  const TempFolder folder;
  std::mt19937_64 random(2);
  const Index3 n{5, 4, 3};
  Metadata meta = random_meta(random, n, 3);
  meta.units = "furlong";
  store_cells(folder / "odd.tcell", meta, random_cells(random, n, 3));
  CHECK_THROWS_WITH(export_case(GridReader(folder / "odd.tcell"), meta.grid.box(0), folder / "case"), Catch::Contains("'furlong'"));
  meta.units = "m";
  store_cells(folder / "g.tcell", meta, std::vector<Label>(60, 0));
  const GridReader reader(folder / "g.tcell");
  const auto refused = [&](const Options& options, const std::string& why) {
    CHECK_THROWS_AS(export_case(reader, meta.grid.box(0), folder / "case", options), UsageError);
    CHECK_THROWS_WITH(export_case(reader, meta.grid.box(0), folder / "case", options), Catch::Contains(why));
    CHECK_FALSE(fs::exists(folder / "case"));
  };
  refused({{"--fluid", "m0,water"}}, "'water'");
  refused({{"--fluid", "m1,m2"}}, "m1, m2");
  for (const char* ranks : {"0", "-1", "two", "", "3x", "100001"}) refused({{"--ranks", ranks}}, "expected 1 to 100000");
  refused({{"--ranks", "61"}}, "60 cells");
}

TEST_CASE("A mesh beyond 32-bit labels is refused with the number of ranks that it needs", "[openfoam]") {
  const TempFolder folder;
  const Grid grid = unit_grid({700, 700, 400});
  mesh_quietly(scene_of(folder, {{.facets = shapes::box({1, 1, 1}, {9, 7, 5})}}, grid), folder / "g.tcell");
  const GridReader reader(folder / "g.tcell");
  CHECK_THROWS_WITH(export_case(reader, grid.box(0), folder / "case"), Catch::Contains("--ranks 2 or more") && Catch::Contains("536870911"));
  CHECK_THROWS_WITH(export_case(reader, grid.box(0), folder / "case", {{"--drop-unreachable", ""}}), Catch::Contains("--ranks 2 or more"));
  CHECK_FALSE(fs::exists(folder / "case"));
  // Where the number of cells says it already, no cell is looked at.
  bool looked = false;
  const auto progress = [&](double) { looked = true; };
  CHECK_THROWS_AS(export_format_named("openfoam")->write({reader, 0, grid.box(0), folder / "case", progress, {}, {}}), UsageError);
  CHECK_FALSE(looked);
}

// The reader of layers takes at most 16,777,216 cells at once.
TEST_CASE("Layers that are too large to be read at once give the mesh of a small region", "[openfoam]") {
  struct Case {
    Index3 n;
    Vec3 lo, hi;
  };
  for (const Case& c :
       {Case{{4200, 4200, 3}, {2000, 3950, 1}, {2070, 4040, 2}}, Case{{(1 << 24) + 500, 3, 3}, {(1 << 24) - 40, 1, 1}, {(1 << 24) + 30, 2, 3}}}) {
    if (kSanitized && c.n[0] < 5000) continue;
    const TempFolder folder;
    Grid grid;
    Box around;
    for (int d = 0; d < 3; ++d) {
      grid.axis[d] = Axis::uniform(0, 1, 0, c.n[d], 0.5);
      around.lo[d] = std::max<int64_t>(0, static_cast<int64_t>(c.lo[d]) - 3), around.hi[d] = std::min(c.n[d], static_cast<int64_t>(c.hi[d]) + 3);
    }
    mesh_quietly(scene_of(folder, {{.facets = shapes::box(c.lo, c.hi)}}, grid), folder / "g.tcell");
    const GridReader reader(folder / "g.tcell");
    const Options solid = {{"--fluid", reader.meta().materials.at(1).name}, {"--drop-unreachable", ""}};
    export_case(reader, grid.box(0), folder / "all", solid);
    export_case(reader, around, folder / "part", solid);
    const fs::path all = folder / "all" / "constant" / "polyMesh", part = folder / "part" / "constant" / "polyMesh";
    CHECK(PolyMesh(all).neighbour.size() > 200);
    for (const char* file : {"points", "faces", "owner", "neighbour", "boundary"}) CHECK((bytes_of(all / file) == bytes_of(part / file)));
  }
}

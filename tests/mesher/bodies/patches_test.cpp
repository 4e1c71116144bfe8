// Patches: which facets belong to which part of the boundary, and how large these are.
#include "mesher/bodies/patches.hpp"

#include "mesher/parts/merge.hpp"
#include "store/channels/link_reader.hpp"
#include "store/format/metadata_json.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/parts.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

// A cube from 2 to 8 whose faces x0, x1, y0, y1, z0, z1 have these lines before them.
void write_cube(const std::filesystem::path& path, const std::array<const char*, 6>& before) {
  std::ofstream out(path);
  for (int i = 0; i < 8; ++i) out << fmt::format("v {} {} {}\n", i & 1 ? 8 : 2, i & 2 ? 8 : 2, i & 4 ? 8 : 2);
  const char* faces[] = {"f 1 5 7 3", "f 2 4 8 6", "f 1 2 6 5", "f 3 7 8 4", "f 1 3 4 2", "f 5 6 8 7"};
  for (size_t i = 0; i < 6; ++i) out << before[i] << (*before[i] ? "\n" : "") << faces[i] << '\n';
}

Scene cube_scene(const std::vector<std::filesystem::path>& meshes) {
  Scene scene = bare_scene(meshes);
  for (SceneAxis& axis : scene.axis) axis.min = 0, axis.max = 10, axis.cells = 10;
  return scene;
}

std::map<std::string, double> areas_of(const Metadata& meta) {
  std::map<std::string, double> out;
  for (const PatchInfo& p : meta.patches)
    if (!p.body.empty()) REQUIRE(out.insert({p.name, p.area}).second);
  return out;
}

Metadata meshed(const Scene& scene, const std::filesystem::path& path, MeshOptions options = {}) {
  mesh_quietly(scene, path, options);
  return GridReader(path).meta();
}

// By axis and direction: the patches that the links of a grid name, where the lower cell is outside of the body (-) and inside (+).
std::map<std::string, std::set<std::string>> patches_of_links(const GridReader& reader) {
  const LinkReader links(reader);
  const Index3 n = reader.meta().grid.cells();
  const std::vector<uint32_t> cells = all_cells(reader);
  std::map<std::string, std::set<std::string>> out;
  for (int d = 0; d < 3; ++d)
    links.for_each(d, {{0, 0, 0}, n}, [&](std::span<const CellLink> found) {
      for (const CellLink& l : found) {
        const bool inside = cells[static_cast<size_t>((l.cell[2] * n[1] + l.cell[1]) * n[0] + l.cell[0])] != 0;
        out[fmt::format("{}{}", inside ? '+' : '-', axis_name(d))].insert(l.patch == kNoPatch ? "none" : reader.meta().patches[l.patch].name);
      }
    });
  return out;
}

TEST_CASE("Groups, objects and what has no name are patches with their areas, and links name them", "[patches]") {
  const TempFolder folder;
  write_cube(folder / "cube.obj", {"", "g inlet", "o box", "g wall roof", "g", "g inlet"});
  const MeshOptions options{.links = true};
  const Metadata meta = meshed(cube_scene({folder / "cube.obj"}), folder / "g.tcell", options);
  REQUIRE(meta.patches.size() == 6 + 4);
  const char* sides[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  for (size_t i = 0; i < 6; ++i) CHECK(meta.patches[i] == PatchInfo{sides[i], "", 100});
  // y0: the group `inlet` goes on, whatever the object is. z0: no group, so the object.
  CHECK(meta.patches[6] == PatchInfo{"cube", "cube", 36});
  CHECK(meta.patches[7] == PatchInfo{"inlet", "cube", 36 * 3});
  CHECK(meta.patches[8] == PatchInfo{"wall", "cube", 36});
  CHECK(meta.patches[9] == PatchInfo{"box", "cube", 36});
  const GridReader reader(folder / "g.tcell");
  CHECK(patches_of_links(reader) ==
        std::map<std::string, std::set<std::string>>{
            {"-x", {"cube"}}, {"+x", {"inlet"}}, {"-y", {"inlet"}}, {"+y", {"wall"}}, {"-z", {"box"}}, {"+z", {"inlet"}}});
  CHECK(decode_metadata(encode_metadata(reader.meta()), channel_kinds()).patches == meta.patches);

  Scene merged = cube_scene({folder / "cube.obj"});
  merged.bodies[0].patches = false;
  CHECK(areas_of(meshed(merged, folder / "g.tcell", options)) == std::map<std::string, double>{{"cube", 216}});
  CHECK(patches_of_links(GridReader(folder / "g.tcell")).at("+z") == std::set<std::string>{"cube"});
}

TEST_CASE("Names that several bodies have are told apart, and those of the domain's sides are not taken", "[patches]") {
  const TempFolder folder;
  write_cube(folder / "a.obj", {"g inlet", "g b", "g xmin", "g rest", "", ""});
  write_cube(folder / "b.obj", {"g inlet", "g b", "g own", "", "", ""});
  const auto areas = areas_of(meshed(cube_scene({folder / "a.obj", folder / "b.obj"}), folder / "g.tcell"));
  CHECK(areas ==
        std::map<std::string, double>{{"a:inlet", 36}, {"a:b", 36}, {"a:xmin", 36}, {"rest", 108}, {"b:inlet", 36}, {"b", 36}, {"own", 144}});
}

TEST_CASE("A body may be called like a side of the domain, and its groups by any bytes", "[patches]") {
  const TempFolder folder;
  const std::string wild(200, '\xFF'), long_name(5000, 'x');
  write_cube(folder / "xmin.obj", {"", "g xmin", ("g " + wild).c_str(), ("g " + long_name).c_str(), ("g " + long_name + "y").c_str(), "g xmin-2"});
  const auto areas = areas_of(meshed(cube_scene({folder / "xmin.obj"}), folder / "g.tcell"));
  CHECK(areas.size() == 4);
  CHECK(areas.at("xmin-3") == 72);  // the body's own, which has the group `xmin`, too
  CHECK(areas.at("xmin-2") == 36);
  CHECK(areas.at(std::string(120, 'x')) == 72);
  CHECK(GridReader(folder / "g.tcell").meta().patches.size() == 10);
}

TEST_CASE("Groups that a file has no room for belong to the patch of their body", "[patches][long]") {
  const TempFolder folder;
  write_cube(folder / "cube.obj", {"", "", "", "", "", ""});
  std::ofstream more(folder / "cube.obj", std::ios::app);
  for (int i = 0; i < 66'000; ++i) more << "g " << std::string(60, 'n') << i << "\nf 1 3 1\n";
  more.close();
  const auto meta = meshed(cube_scene({folder / "cube.obj"}), folder / "g.tcell");
  CHECK(meta.patches.size() > 40'000);
  CHECK(meta.patches.size() < 66'000);
  CHECK(meta.patches[6] == PatchInfo{"cube", "cube", 216});
  CHECK(GridReader(folder / "g.tcell").report().find("groups and solids beyond that belong to the patches of their bodies") != std::string::npos);
  // Parts tell it to whoever merges them.
  const auto parts = make_parts(cube_scene({folder / "cube.obj"}), folder / "merged.tcell", {}, 2);
  merge(parts, folder / "merged.tcell", kSilent, kGoOn);
  CHECK(bytes_of(folder / "merged.tcell") == bytes_of(folder / "g.tcell"));
}

TEST_CASE("All walls of a sheet with one patch have that patch, also where the sheet is not crossed between two sample points", "[patches]") {
  std::vector<oracle::Body> bodies = {{shapes::sphere({5, 5, 5}, 3.3, 2)}};
  bodies[0].sheet = true;
  const GridReader reader = meshed_reader(bodies, cube_grid_of(0, 1, 10), {.links = true});
  size_t without_place = 0;
  for (int d = 0; d < 3; ++d)
    LinkReader(reader).for_each(d, reader.meta().grid.box(0), [&](std::span<const CellLink> found) {
      for (const CellLink& l : found) {
        REQUIRE(l.patch == 6);
        without_place += l.end == 0;
      }
    });
  CHECK(without_place > 50);
}

TEST_CASE("Solids of an STL are patches; a part takes its own alone", "[patches]") {
  const TempFolder folder;
  std::ofstream out(folder / "two.stl");
  const auto box = shapes::box({2, 2, 2}, {8, 8, 8});
  for (size_t half = 0; half < 2; ++half) {
    out << "solid half " << half << "\n";
    for (size_t i = half * 6; i < half * 6 + 6; ++i) {
      out << "facet normal 0 0 0\nouter loop\n";
      for (const Vec3& v : box[i].vertex) out << fmt::format("vertex {} {} {}\n", v[0], v[1], v[2]);
      out << "endloop\nendfacet\n";
    }
    out << "endsolid half " << half << "\n";
  }
  out.close();
  Scene scene = cube_scene({folder / "two.stl"});
  CHECK(areas_of(meshed(scene, folder / "g.tcell")) == std::map<std::string, double>{{"half 0", 108}, {"half 1", 108}});
  scene.bodies[0].part = "*1";
  const auto areas = areas_of(meshed(scene, folder / "g.tcell"));
  CHECK(areas.at("half 1") == 108);
  CHECK(areas.contains("two:cap"));
  CHECK_FALSE(areas.contains("half 0"));
}

TEST_CASE("Caps, stitches and walls have patches of their own", "[patches]") {
  const TempFolder folder;
  write_cube(folder / "cube.obj", {"g a", "g b", "g c", "g d", "g e", "g f"});
  std::string text = bytes_of(folder / "cube.obj");
  text.erase(text.find("g f"));  // no roof
  std::ofstream(folder / "open.obj") << text;
  const MeshOptions options{.links = true};
  Scene scene = cube_scene({folder / "open.obj"});
  auto areas = areas_of(meshed(scene, folder / "g.tcell", options));
  CHECK(areas.at("open:cap") == 36);
  CHECK(patches_of_links(GridReader(folder / "g.tcell")).at("+z") == std::set<std::string>{"open:cap"});
  scene.bodies[0].closing = {Closing::Way::kExtrude, 2, true};
  areas = areas_of(meshed(scene, folder / "g.tcell", options));
  CHECK(areas.at("open:side") > 24 * 2);
  CHECK_FALSE(areas.contains("open:cap"));
  CHECK(patches_of_links(GridReader(folder / "g.tcell")).at("+x") == std::set<std::string>{"b", "open:side"});
}

TEST_CASE("Of two walls at one place the first facet of the stronger body tells the patch, whatever the budget", "[patches]") {
  const TempFolder folder;
  write_cube(folder / "a.obj", {"g a1", "g a2", "g a3", "g a4", "g a5", "g a6"});
  write_cube(folder / "b.obj", {"g b1", "g b2", "g b3", "g b4", "g b5", "g b6"});
  Scene scene = cube_scene({folder / "a.obj", folder / "b.obj"});
  MeshOptions options{.links = true};
  for (const uint64_t memory : {~uint64_t{0}, uint64_t{1000}})
    for (const int64_t priority : {1, -1}) {
      options.memory = memory;
      scene.bodies[0].priority = priority;
      mesh_quietly(scene, folder / "g.tcell", options);
      const auto patches = patches_of_links(GridReader(folder / "g.tcell"));
      const std::string stronger = priority > 0 ? "a" : "b";
      CHECK(patches.at("-x") == std::set<std::string>{stronger + "1"});
      CHECK(patches.at("+z") == std::set<std::string>{stronger + "6"});
    }
}

TEST_CASE("Surfaces in memory and on disk, by any threads, give one file of links and patches", "[patches]") {
  const TempFolder folder;
  write_cube(folder / "cube.obj", {"g a", "g b", "g c", "g d", "g e", "g f"});
  auto open = shapes::torus({5, 5, 5}, 3, 1.5, 40, 30);
  open.pop_back();
  Scene scene = scene_of(folder, {{open}, {shapes::sphere({5, 5, 6}, 3.3, 4), oracle::Rule::kNonzero, 2}}, cube_grid_of(0, 0.25, 40));
  scene.bodies.push_back(scene.bodies[0]);
  scene.bodies.back().mesh = folder / "cube.obj", scene.bodies.back().name = "cube";
  MeshOptions options{.threads = 1, .links = true, .chunk_rays = 4};
  mesh_quietly(scene, folder / "g.tcell", options);
  const std::string expected = bytes_of(folder / "g.tcell");
  for (const auto& [memory, threads] : {std::pair(~uint64_t{0}, 3), std::pair(uint64_t{1000}, 1), std::pair(uint64_t{1000}, 3)}) {
    options.memory = memory;
    options.threads = threads;
    mesh_quietly(scene, folder / "other.tcell", options);
    CHECK(bytes_of(folder / "other.tcell") == expected);
  }
}

}  // namespace
}  // namespace teracell::mesher

// Surfaces that don't fit into the memory given: the same file, byte for byte.
#include "store/base/error.hpp"
#include "store/whole/verify.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/peak.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Rule;
using shapes::Facets;

Scene scene_of_many_kinds(const TempFolder& folder) {
  std::mt19937_64 random(3);
  Facets open = shapes::sphere({40, 50, 60}, 35, 5);
  open.erase(open.begin() + 100, open.begin() + 140);
  Facets mixed = shapes::join({shapes::torus({50, 50, 50}, 30, 10, 90, 60), shapes::torus({60, 50, 50}, 30, 10, 90, 60)});
  mixed[5] = shapes::flip({mixed[5]})[0];
  mixed.push_back(mixed[7]);
  mixed.push_back(mixed[7]);
  std::swap(mixed.back().vertex[0], mixed.back().vertex[1]);
  const Facets small = shapes::join(shapes::random_tetrahedra(random, 400, 0, 100, 0.5));  // many shells, some flat
  const Grid grid{{Axis::uniform(0, 0.5, 0, 210, 0.5), Axis::uniform(-3, 0.37, 0, 300, 0.25),
                   Axis::graded(
                       [] {
                         std::vector<double> planes;
                         for (int i = 0; i <= 170; ++i) planes.push_back(i * 0.5 + i * i * 0.0005);
                         return planes;
                       }(),
                       0.5)}};
  Scene scene = scene_of(folder, {{open}, {mixed, Rule::kNonzero, 2}, {small, Rule::kNonzero, 3}}, grid);
  for (SceneBody& body : scene.bodies) body.fill = Fill::kAuto;
  scene.bodies[1].matrix = {0, -1, 0, 100, 1, 0, 0, 0, 0, 0, 0.9, 3};
  return scene;
}

TEST_CASE("The file's bytes do not depend on the memory given, nor on threads", "[threads]") {
  const TempFolder folder;
  const Scene scene = scene_of_many_kinds(folder);
  for (const int axis : {0, 1, 2}) {
    if (kSanitized && axis != 1) continue;
    MeshOptions options{.axis = axis, .chunk_rays = axis == 1 ? 64u : 8u};
    const auto in_memory = mesh_quietly(scene, folder / "a.tcell", options);
    REQUIRE(in_memory["spilled_bytes"] == 0);
    for (const int threads : {1, 3}) {
      options.threads = threads;
      options.memory = threads == 1 ? 1 : 2 << 20;
      const auto spilled = mesh_quietly(scene, folder / "b.tcell", options);
      REQUIRE(spilled["spilled_bytes"] > 0);
      REQUIRE(spilled["bodies"] == in_memory["bodies"]);
      REQUIRE(bytes_of(folder / "a.tcell") == bytes_of(folder / "b.tcell"));
    }
  }
}

TEST_CASE("Binary STL files that several threads read in blocks make the same file and the same report, wherever the blocks are logged",
          "[threads]") {
  const TempFolder folder;
  const Facets whole = shapes::torus({30, 30, 30}, 18, 9, 240, 220);  // 105,600
  Facets open = whole;
  open[70] = open[9000], open[71] = shapes::flip({open[9001]})[0];
  open[72].vertex[0] = open[72].vertex[1];
  const Axis axis = Axis::uniform(0, 0.7, 0, 90, 0.5);
  Scene scene = scene_of(folder, {{open}, {whole, Rule::kNonzero, 2}}, Grid{{axis, axis, axis}});
  if (GENERATE(false, true)) scene.bodies[1].matrix = {0, -1, 0, 60, 1, 0, 0, 3, 0, 0, 0.9, 3};
  const std::array files = {folder / "open.stl", folder / "whole.stl"};
  for (size_t b : {0, 1}) {
    scene.bodies[b].fill = Fill::kAuto, scene.bodies[b].mesh = files[b];
    shapes::write_stl(files[b], b == 0 ? open : whole, shapes::Encoding::kLittleEndian);
  }
  const auto in_memory = mesh_quietly(scene, folder / "a.tcell", {.threads = 1});
  REQUIRE(in_memory["spilled_bytes"] == 0);
  std::vector<uint64_t> spilled_bytes;
  // On disk, the first one in memory and the other one not at all, both in memory; with one thread and with little memory none is logged.
  for (const auto& [threads, memory] : {std::pair(3, 16 << 20), {3, 35 << 19}, {3, 24 << 20}, {1, 16 << 20}, {3, 1}}) {
    if (kSanitized && (threads == 1 || memory == 1)) break;
    const auto spilled = mesh_quietly(scene, folder / "b.tcell", {.threads = threads, .memory = static_cast<uint64_t>(memory)});
    spilled_bytes.push_back(spilled["spilled_bytes"]);
    REQUIRE(spilled["bodies"] == in_memory["bodies"]);
    REQUIRE(bytes_of(folder / "a.tcell") == bytes_of(folder / "b.tcell"));
  }
  CHECK(spilled_bytes[0] > spilled_bytes[1] + spilled_bytes[1] / 4);
  CHECK(spilled_bytes[1] > 0);
  CHECK(spilled_bytes[2] == 0);
}

TEST_CASE("Links lead to the same patches where facets of several lie on each other, also in a group with several bins") {
  const TempFolder folder;
  const Grid grid{{Axis::uniform(0, 1, 0, 64, 0.5), Axis::uniform(0, 1, 0, 64, 0.5), Axis::uniform(0, 1, 0, 64, 0.5)}};
  const Facets coarse = shapes::box({4, 4, 4}, {60, 60, 60});
  Facets fine = coarse;
  for (int i = 0; i < 5; ++i) {
    Facets halves;
    for (const Facet& f : fine) {
      const auto& [a, b, c] = f.vertex;
      const auto middle = [](const Vec3& p, const Vec3& q) { return Vec3{(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2}; };
      const Vec3 ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Facet& g : {Facet{{a, ab, ca}}, Facet{{ab, b, bc}}, Facet{{ca, bc, c}}, Facet{{ab, bc, ca}}}) halves.push_back(g);
    }
    fine.swap(halves);
  }
  const Scene scene = scene_of(folder, {{fine}}, grid);
  std::ofstream obj(folder / "body0.obj");
  for (const auto& [name, facets] : {std::pair("fine", fine), std::pair("coarse", coarse)}) {
    obj << "g " << name << '\n';
    for (const Facet& f : facets) {
      for (const Vec3& v : f.vertex) obj << "v " << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
      obj << "f -3 -2 -1\n";
    }
  }
  obj.close();
  MeshOptions options{.links = true};
  mesh_quietly(scene, folder / "a.tcell", options);
  options.memory = 1;
  REQUIRE(mesh_quietly(scene, folder / "b.tcell", options)["spilled_bytes"] > 0);
  REQUIRE((bytes_of(folder / "a.tcell") == bytes_of(folder / "b.tcell")));
}

TEST_CASE("The cells do not depend on the size of the chunks", "[long]") {
  const TempFolder folder;
  const Scene scene = scene_of_many_kinds(folder);
  std::vector<uint32_t> first;
  for (const uint32_t chunk_rays : {64u, 4u, 12u, 256u}) {
    if (kSanitized && chunk_rays > 12) continue;
    mesh_quietly(scene, folder / "g.tcell", {.chunk_rays = chunk_rays});
    const GridReader reader(folder / "g.tcell");
    if (first.empty()) first = all_cells(reader);
    REQUIRE(all_cells(reader) == first);
    verify(reader, 2, [](double) {});
  }
}

TEST_CASE("A single group of tiles takes all facets, however many there are") {
  const TempFolder folder;
  const Grid grid{{Axis::uniform(-5, 1, 0, 10, 0.5), Axis::uniform(-5, 1, 0, 10, 0.5), Axis::uniform(-5, 1, 0, 10, 0.5)}};
  const Scene scene = scene_of(folder, {{shapes::sphere({0, 0, 0}, 4, 6)}}, grid);
  mesh_quietly(scene, folder / "a.tcell");
  const MeshOptions options{.memory = 1};
  REQUIRE(mesh_quietly(scene, folder / "b.tcell", options)["spilled_bytes"] > 0);
  REQUIRE(bytes_of(folder / "a.tcell") == bytes_of(folder / "b.tcell"));
}

TEST_CASE("Facets far smaller than cells take no more memory than was given") {
  const TempFolder folder;
  const Grid grid{{Axis::uniform(-16, 1, 0, 32, 0.5), Axis::uniform(-16, 1, 0, 32, 0.5), Axis::uniform(-5, 1, 0, 10, 0.5)}};
  const Scene scene = scene_of(folder, {{shapes::torus({0, 0, 0}, 11, 4, 1200, 500)}}, grid);  // 1.2 million, which take 80 MB in one bin
  constexpr int64_t kMemory = 64 << 20;
  const int64_t peak = peak_memory_of([&] { mesh_quietly(scene, folder / "a.tcell", {.threads = 2, .memory = kMemory}); });
  if (!kSanitized) REQUIRE(peak < kMemory);
}

TEST_CASE("An OBJ whose vertices don't fit into the memory given makes the same file") {
  const TempFolder folder;
  const Grid grid{{Axis::uniform(-50, 1, 0, 100, 0.5), Axis::uniform(-50, 1, 0, 100, 0.5), Axis::uniform(-50, 1, 0, 100, 0.5)}};
  const Scene scene = scene_of(folder, {{shapes::sphere({0, 0, 0}, 40, 5)}}, grid);
  std::string obj = bytes_of(folder / "body0.obj"), unused;
  for (int i = 0; i < 300000; ++i) unused += "v 1 2 3\n";
  obj.insert(obj.find("\nf ") + 1, unused);  // every facet is far from its vertices
  std::ofstream(folder / "body0.obj") << obj;
  mesh_quietly(scene, folder / "a.tcell");
  mesh_quietly(scene, folder / "b.tcell", {.memory = 1});
  REQUIRE(bytes_of(folder / "a.tcell") == bytes_of(folder / "b.tcell"));
}

TEST_CASE("Without a folder for temporary files a large surface is an error that says so, and leaves nothing") {
  const TempFolder folder;
  const Scene scene = scene_of_many_kinds(folder);
  const MeshOptions options{.memory = 1, .tmp = folder / "nowhere"};
  REQUIRE_THROWS_WITH(mesh_quietly(scene, folder / "g.tcell", options), Catch::Contains("nowhere"));
  REQUIRE_FALSE(std::filesystem::exists(folder / "g.tcell"));
  REQUIRE_FALSE(std::filesystem::exists(folder / "g.tcell.partial"));
}

}  // namespace
}  // namespace teracell::mesher

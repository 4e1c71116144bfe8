#include "tools/sample/stadium.hpp"

#include "mesher/scene/scene.hpp"
#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"
#include "tools/sample/solid.hpp"

using namespace teracell;
using namespace teracell::sample;
using namespace teracell::testing;

namespace {

namespace fs = std::filesystem;
using Corner = std::array<float, 3>;
using Triangle = std::array<Corner, 3>;

class StadiumFolder {
 public:
  StadiumFolder() { write_stadium(path_); }
  const fs::path& path() const { return path_; }

 private:
  TempFolder folder_;
  fs::path path_ = folder_ / "new";
};

std::vector<Triangle> read_stl(const fs::path& path) {
  const std::string bytes = bytes_of(path);
  REQUIRE(bytes.size() >= 84);
  CHECK(bytes.rfind("solid", 0) == std::string::npos);
  uint32_t count;
  std::memcpy(&count, bytes.data() + 80, 4);
  REQUIRE(bytes.size() == 84 + 50 * size_t{count});
  std::vector<Triangle> triangles(count);
  for (uint32_t i = 0; i < count; ++i) std::memcpy(triangles[i].data(), bytes.data() + 84 + 50 * size_t{i} + 12, 36);
  return triangles;
}

// Facets of a shell have equal numbers; facets belong together when a vertex is shared.
std::vector<int> shells(const std::vector<Triangle>& triangles) {
  std::vector<int> parent(triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::map<Corner, int> owner;
  for (size_t i = 0; i < triangles.size(); ++i)
    for (const Corner& c : triangles[i]) parent[root(static_cast<int>(i))] = root(owner.try_emplace(c, static_cast<int>(i)).first->second);
  for (size_t i = 0; i < triangles.size(); ++i) parent[i] = root(static_cast<int>(i));
  return parent;
}

double six_volumes(const Triangle& t) {
  const auto& [a, b, c] = t;
  return double{a[0]} * (double{b[1]} * c[2] - double{b[2]} * c[1]) + double{a[1]} * (double{b[2]} * c[0] - double{b[0]} * c[2]) +
         double{a[2]} * (double{b[0]} * c[1] - double{b[1]} * c[0]);
}

bool is_closed(const std::vector<Triangle>& triangles) {
  std::map<std::pair<Corner, Corner>, int> uses;  // of a directed edge
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : uses) {
    const auto reverse = uses.find({edge.second, edge.first});
    if (reverse == uses.end() || reverse->second != count) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("the stadium is a scene of closed, outward oriented surfaces inside its domain", "[sample][long]") {
  const StadiumFolder folder;
  const mesher::Scene scene = mesher::read_scene(folder.path() / "scene.json");
  const Grid grid = resolve_grid(scene, {}, {});
  CHECK(grid.cells() == Index3{300, 240, 60});
  CHECK(grid.axis[2].step() == 1);
  REQUIRE(scene.materials.size() == 4);
  CHECK(scene.materials[0].name == "air");
  CHECK(scene.materials[1].name == "explosive");
  CHECK(scene.materials[2].name == "grandstand");
  CHECK(scene.materials[3].name == "structure");

  size_t facets = 0;
  for (const mesher::SceneBody& body : scene.bodies) {
    INFO(body.name);
    const std::vector<Triangle> triangles = read_stl(body.mesh);
    facets += triangles.size();
    CHECK(is_closed(triangles));
    std::map<int, double> volume;
    const std::vector<int> shell = shells(triangles);
    size_t degenerate = 0, outside = 0;
    for (size_t i = 0; i < triangles.size(); ++i) {
      const auto& [a, b, c] = triangles[i];
      volume[shell[i]] += six_volumes(triangles[i]);
      degenerate += a == b || b == c || c == a;
      for (const Corner& corner : triangles[i])
        for (int axis = 0; axis < 3; ++axis) outside += corner[axis] < grid.axis[axis].min() || corner[axis] > grid.axis[axis].max();
    }
    CHECK(degenerate == 0);
    CHECK(outside == 0);
    for (const auto& [id, six] : volume) CHECK(six > 0);
  }
  CHECK(facets > 20'000);
  CHECK(facets < 200'000);
}

TEST_CASE("the charge is a capsule of the size it is drawn with", "[sample]") {
  const StadiumFolder folder;
  double volume = 0;
  for (const Triangle& t : read_stl(folder.path() / "charge.stl")) volume += six_volumes(t) / 6;
  const double exact = 3.14159265358979 * 1.8 * 1.8 * (2 * 4.6 + 4.0 / 3 * 1.8);
  CHECK(volume < exact);
  CHECK(volume > 0.97 * exact);
}

TEST_CASE("the stadium is written the same every time, and leaves nothing else behind", "[sample]") {
  const StadiumFolder one, other;
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(one.path())) {
    CHECK(bytes_of(entry.path()) == bytes_of(other.path() / entry.path().filename()));
    ++files;
  }
  CHECK(files == 11);
  write_stadium(one.path());  // over itself
}

TEST_CASE("a folder that can't be made or written is an IoError", "[sample]") {
  const StadiumFolder folder;
  CHECK_THROWS_AS(write_stadium(folder.path() / "scene.json"), IoError);
  CHECK_THROWS_AS(write_whole(folder.path() / "none" / "f", "x"), IoError);
}

TEST_CASE("a bar in any direction is closed and outward oriented", "[sample]") {
  for (const Vec3& to : {Vec3{1, 0, 0}, Vec3{0, -2, 0}, Vec3{0, 0, 3}, Vec3{0, 0, -3}, Vec3{1, 2, -0.5}}) {
    Solid solid;
    solid.bar({0, 0, 0}, to, 0.3, 0.2);
    CHECK(is_closed(solid.facets()));
    double volume = 0;
    for (const Triangle& t : solid.facets()) volume += six_volumes(t) / 6;
    CHECK(volume > 0);
  }
}

#include "tools/export/faces/surface.hpp"
#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"
#include "tools/export/formats.hpp"

using namespace teracell;
using namespace teracell::exports;
using namespace teracell::testing;
namespace fs = std::filesystem;

namespace {

using Options = std::map<std::string, std::string>;
using Triangle = std::array<uint32_t, 3>;

constexpr uint32_t kMaterials = 4;

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> facets;
  std::vector<uint32_t> materials;
};

Mesh read_ply(const fs::path& path) {
  const std::string text = bytes_of(path);
  const size_t begin = text.find("end_header\n") + 11;
  std::istringstream header(text.substr(0, begin));
  size_t vertices = 0, facets = 0;
  for (std::string line; std::getline(header, line);) {
    if (line.starts_with("element vertex ")) vertices = std::stoul(line.substr(15));
    if (line.starts_with("element face ")) facets = std::stoul(line.substr(13));
  }
  REQUIRE(text.size() == begin + 24 * vertices + 17 * facets);
  Mesh out;
  out.vertices.resize(vertices), out.facets.resize(facets), out.materials.resize(facets);
  std::memcpy(out.vertices.data(), text.data() + begin, 24 * vertices);
  for (size_t i = 0; i < facets; ++i) {
    const char* const at = text.data() + begin + 24 * vertices + 17 * i;
    REQUIRE(*at == 3);
    std::memcpy(out.facets[i].data(), at + 1, 12);
    std::memcpy(&out.materials[i], at + 13, 4);
  }
  return out;
}

// The normal and the three corners of each facet.
std::vector<std::array<std::array<float, 3>, 4>> read_stl(const fs::path& path) {
  const std::string text = bytes_of(path);
  REQUIRE(text.size() >= 84);
  CHECK_FALSE(text.starts_with("solid"));
  uint32_t count;
  std::memcpy(&count, text.data() + 80, 4);
  REQUIRE(text.size() == 84 + size_t{50} * count);
  std::vector<std::array<std::array<float, 3>, 4>> out(count);
  for (size_t i = 0; i < count; ++i) std::memcpy(&out[i], text.data() + 84 + 50 * i, 48);
  return out;
}

// Half of the cells are background.
std::vector<Label> noise(const Index3& n, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Label> cells(static_cast<size_t>(n[0] * n[1] * n[2]));
  for (Label& cell : cells) cell = random() % 2 == 0 ? 0 : static_cast<Label>(1 + random() % (kMaterials - 1));
  return cells;
}

struct SurfaceOf {
  SurfaceOf(const Grid& grid, const std::vector<Label>& cells) {
    store_cells(folder / "g.tcell", with_tiny_chunks(metadata_of(grid, 2, kMaterials)), cells);
    reader.emplace(folder / "g.tcell");
  }
  fs::path written(const std::string& format, const Box& box, int level = 0, const Options& options = {}) const {
    const fs::path path = folder / ("out." + format);
    export_format_named(format)->write({*reader, level, box, path, [](double) {}, {}, options});
    return path;
  }
  Mesh ply(const Box& box, int level = 0, const Options& options = {}) const { return read_ply(written("ply", box, level, options)); }
  Mesh ply() const { return ply(reader->meta().grid.box(0)); }
  double plane(int axis, int level, int64_t i) const {
    const Axis& a = reader->meta().grid.axis[axis];
    return a.plane(std::min(a.cells(), i << level));
  }

  TempFolder folder;
  std::optional<GridReader> reader;
};

double volume(const Mesh& mesh) {
  double six = 0;
  for (const Triangle& t : mesh.facets) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six / 6;
}

// Each edge has two facets, which pass along it in opposite directions, and the facets of a vertex form one fan.
void expect_manifold(const Mesh& mesh) {
  std::set<std::pair<uint32_t, uint32_t>> edges;
  std::vector<std::map<uint32_t, uint32_t>> next(mesh.vertices.size());  // around a vertex
  for (const Triangle& t : mesh.facets)
    for (size_t i = 0; i < 3; ++i) {
      REQUIRE(t[i] < mesh.vertices.size());
      REQUIRE(edges.emplace(t[i], t[(i + 1) % 3]).second);
      REQUIRE(next[t[i]].emplace(t[(i + 1) % 3], t[(i + 2) % 3]).second);
    }
  for (const auto& [a, b] : edges) REQUIRE(edges.contains({b, a}));
  for (const auto& around : next) {
    REQUIRE_FALSE(around.empty());
    size_t facets = 0;
    uint32_t at = around.begin()->first;
    do at = around.at(at), ++facets;
    while (at != around.begin()->first && facets <= around.size());
    REQUIRE(facets == around.size());
  }
}

// As a program that joins facets by their coordinates, in the order of the file.
void expect_joined_in_order(const Mesh& mesh) {
  std::map<std::pair<Vec3, Vec3>, bool> open;  // whether it passes from the lesser end to the other
  for (const Triangle& t : mesh.facets)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3 &a = mesh.vertices[t[i]], &b = mesh.vertices[t[(i + 1) % 3]];
      const auto [it, fresh] = open.emplace(std::minmax(a, b), a < b);
      if (fresh) continue;
      REQUIRE(it->second != (a < b));
      open.erase(it);
    }
  REQUIRE(open.empty());
}

// The faces of the cells of a box, and no others: their area, the side on which they are, and the materials.
void expect_faces(const SurfaceOf& s, const Mesh& mesh, int level, const Box& box, const std::set<uint32_t>& chosen) {
  const std::vector<uint32_t> cells = all_cells(*s.reader, level);
  const Index3 n = s.reader->meta().grid.cells(level);
  const auto material = [&](const Index3& c) -> int64_t {
    for (int d = 0; d < 3; ++d)
      if (c[d] < box.lo[d] || c[d] >= box.hi[d]) return -1;
    const uint32_t m = cells[static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0])];
    return chosen.contains(m) ? int64_t{m} : -1;
  };
  std::array<std::vector<double>, 3> planes;
  for (int d = 0; d < 3; ++d)
    for (int64_t i = 0; i <= n[d]; ++i) planes[d].push_back(s.plane(d, level, i));
  std::map<std::pair<Index3, int>, double> areas;  // of each face: the cell and the direction
  double expected_volume = 0;
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    const Vec3 &a = mesh.vertices[mesh.facets[i][0]], &b = mesh.vertices[mesh.facets[i][1]], &c = mesh.vertices[mesh.facets[i][2]];
    Index3 cell;
    int axis = -1;
    for (int d = 0; d < 3; ++d) {
      const bool across = a[d] == b[d] && b[d] == c[d];
      const double middle = across ? a[d] : (a[d] + b[d] + c[d]) / 3;
      cell[d] = std::ranges::upper_bound(planes[d], middle) - planes[d].begin() - 1;
      if (!across) continue;
      REQUIRE(axis < 0);
      REQUIRE(planes[d][static_cast<size_t>(cell[d])] == a[d]);
      axis = d;
    }
    REQUIRE(axis >= 0);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double area = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
    REQUIRE(area != 0);
    if (area > 0) --cell[axis];
    REQUIRE(material(cell) == mesh.materials[i]);
    areas[{cell, area > 0 ? axis : axis + 3}] += std::abs(area) / 2;
  }
  size_t faces = 0;
  for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
    for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
      for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) {
        if (material({x, y, z}) < 0) continue;
        const Index3 here{x, y, z};
        Vec3 edge;
        for (int d = 0; d < 3; ++d) edge[d] = planes[d][static_cast<size_t>(here[d]) + 1] - planes[d][static_cast<size_t>(here[d])];
        expected_volume += edge[0] * edge[1] * edge[2];
        for (int direction = 0; direction < 6; ++direction) {
          Index3 other = here;
          other[direction % 3] += direction < 3 ? 1 : -1;
          if (material(other) >= 0) continue;
          ++faces;
          CAPTURE(x, y, z, direction, level, box.lo[0], box.hi[0]);
          REQUIRE(areas[{here, direction}] == Approx(edge[(direction + 1) % 3] * edge[(direction + 2) % 3]).epsilon(1e-9));
        }
      }
  CHECK(faces == areas.size());
  CHECK(volume(mesh) == Approx(expected_volume).epsilon(1e-12));
}

std::set<uint32_t> all_but_background() {
  std::set<uint32_t> out;
  for (uint32_t m = 1; m < kMaterials; ++m) out.insert(m);
  return out;
}

}  // namespace

TEST_CASE("The surface has the faces of the cells, is closed and has no forks: random cells over the seams of blocks", "[export][surface]") {
  for (const Index3& n : {Index3{9, 8, 7}, Index3{131, 6, 5}, Index3{6, 130, 7}, Index3{5, 6, 133}, Index3{128, 5, 4}, Index3{1, 1, 1}}) {
    CAPTURE(n[0], n[1], n[2]);
    std::vector<Label> cells = noise(n, 3);
    cells[0] = 2;
    const SurfaceOf s(unit_grid(n), cells);
    const Mesh mesh = s.ply();
    expect_faces(s, mesh, 0, {{0, 0, 0}, n}, all_but_background());
    expect_manifold(mesh);
    expect_joined_in_order(mesh);
  }
}

TEST_CASE("Blocks that meet at a corner number their vertices alike", "[export][surface]") {
  const Index3 n{132, 131, 130};
  std::mt19937_64 random(7);
  std::vector<Label> cells = random_cells(random, n, kMaterials);
  for (int64_t z = 124; z < n[2]; ++z)
    for (int64_t y = 124; y < n[1]; ++y)
      for (int64_t x = 124; x < n[0]; ++x) cells[static_cast<size_t>((z * n[1] + y) * n[0] + x)] = static_cast<Label>(random() % 2);
  const SurfaceOf s(unit_grid(n), cells);
  const Box box{{120, 121, 119}, n};
  const Mesh part = s.ply(box);
  expect_faces(s, part, 0, box, all_but_background());
  expect_manifold(part);
  if (!kSanitized) expect_manifold(s.ply());
}

TEST_CASE("Every way in which eight cells can meet gives a surface without forks", "[export][surface]") {
  for (unsigned pattern = 1; pattern < 256; ++pattern) {
    std::vector<Label> cells(8);
    for (unsigned c = 0; c < 8; ++c) cells[c] = static_cast<Label>(pattern >> c & 1);
    CAPTURE(pattern);
    const SurfaceOf s(unit_grid({2, 2, 2}), cells);
    const Mesh mesh = s.ply();
    expect_faces(s, mesh, 0, {{0, 0, 0}, {2, 2, 2}}, {1});
    expect_manifold(mesh);
  }
}

TEST_CASE("Regions, levels, graded axes and materials are those that were asked for, and the surface is capped", "[export][surface]") {
  std::mt19937_64 random(5);
  Grid grid;
  const Index3 n{23, 19, 21};
  for (int d = 0; d < 3; ++d) {
    std::vector<double> planes = {-3};
    for (int64_t i = 0; i < n[d]; ++i) planes.push_back(planes.back() + random_in(random, 0.1, 2));
    grid.axis[d] = d == 1 ? Axis::uniform(-2, 0.25, 0, n[d], 0.5) : Axis::graded(planes, 0.5);
  }
  const SurfaceOf s(grid, random_cells(random, n, kMaterials));
  for (int level = 0; level < 3; ++level) {
    const Index3 size = grid.cells(level);
    for (const Box& box : {Box{{0, 0, 0}, size}, Box{{1, 2, 1}, {size[0] - 1, size[1], size[2] - 2}}, Box{{0, 3, 0}, {size[0], 4, size[2]}}}) {
      const Mesh mesh = s.ply(box, level);
      expect_faces(s, mesh, level, box, all_but_background());
      expect_manifold(mesh);
    }
  }
  const std::vector<MaterialInfo>& materials = s.reader->meta().materials;
  const Mesh two = s.ply(grid.box(0), 0, {{"--material", materials[0].name + "," + materials[2].name}});
  expect_faces(s, two, 0, grid.box(0), {0, 2});
  expect_manifold(two);
}

TEST_CASE("STL has the facets of PLY, with normals", "[export][surface]") {
  const Index3 n{20, 19, 130};
  std::mt19937_64 random(5);
  const SurfaceOf s(unit_grid(n), random_cells(random, n, kMaterials));
  for (const Options& options : {Options{}, Options{{"--smooth", "2"}}}) {
    const Mesh mesh = s.ply({{0, 0, 0}, n}, 0, options);
    const auto stl = read_stl(s.written("stl", {{0, 0, 0}, n}, 0, options));
    REQUIRE(stl.size() == mesh.facets.size());
    bool same = true, outward = true;
    for (size_t i = 0; i < stl.size(); ++i) {
      std::array<std::array<float, 3>, 3> corner;
      for (size_t k = 0; k < 3; ++k)
        for (size_t d = 0; d < 3; ++d)
          same = same && stl[i][k + 1][d] == static_cast<float>(mesh.vertices[mesh.facets[i][k]][d]), corner[k][d] = stl[i][k + 1][d];
      for (size_t d = 0; d < 3; ++d) {
        const size_t u = (d + 1) % 3, v = (d + 2) % 3;
        const float along =
            (corner[1][u] - corner[0][u]) * (corner[2][v] - corner[0][v]) - (corner[1][v] - corner[0][v]) * (corner[2][u] - corner[0][u]);
        outward = outward && (std::abs(along) < 1e-4 || (along > 0) == (stl[i][0][d] > 0));
      }
    }
    CHECK(same);
    CHECK(outward);
  }
}

TEST_CASE("Smoothing moves vertices within their reach, keeps the volume of a ball and brings its surface nearer", "[export][surface]") {
  const Index3 n{140, 44, 44};
  constexpr double kRadius = 18;
  const Vec3 centre{120.3, 21.8, 22.1};
  std::vector<Label> cells(static_cast<size_t>(n[0] * n[1] * n[2]));
  size_t i = 0, inside = 0;
  for (int64_t z = 0; z < n[2]; ++z)
    for (int64_t y = 0; y < n[1]; ++y)
      for (int64_t x = 0; x < n[0]; ++x, ++i) {
        const double distance =
            std::hypot(static_cast<double>(x) + 0.5 - centre[0], static_cast<double>(y) + 0.5 - centre[1], static_cast<double>(z) + 0.5 - centre[2]);
        if (distance < kRadius) cells[i] = 1, ++inside;
      }
  const SurfaceOf s(unit_grid(n), cells);
  const Box box = s.reader->meta().grid.box(0);
  const auto roughness = [&](const Mesh& mesh) {
    double sum = 0;
    for (const Vec3& v : mesh.vertices) sum += std::pow(std::hypot(v[0] - centre[0], v[1] - centre[1], v[2] - centre[2]) - kRadius, 2);
    return std::sqrt(sum / static_cast<double>(mesh.vertices.size()));
  };
  const Mesh blocky = s.ply();
  CHECK(volume(blocky) == Approx(static_cast<double>(inside)).epsilon(1e-12));
  for (const int rounds : {1, 5, 20}) {
    const Mesh smooth = s.ply(box, 0, {{"--smooth", std::to_string(rounds)}});
    CHECK(smooth.facets == blocky.facets);
    double furthest = 0;
    for (size_t v = 0; v < blocky.vertices.size(); ++v)
      for (size_t d = 0; d < 3; ++d) furthest = std::max(furthest, std::abs(smooth.vertices[v][d] - blocky.vertices[v][d]));
    CHECK(furthest <= 15.0 / 32 + 1e-12);
    CHECK(volume(smooth) == Approx(4 * std::numbers::pi / 3 * std::pow(kRadius, 3)).epsilon(0.005));
    UNSCOPED_INFO(fmt::format("{} rounds: volume {:.5f}, roughness {:.4f} of {:.4f}", rounds,
                              volume(smooth) / (4 * std::numbers::pi / 3 * std::pow(kRadius, 3)), roughness(smooth), roughness(blocky)));
    CHECK(roughness(smooth) < roughness(blocky) * (rounds == 1 ? 0.85 : rounds == 5 ? 0.5 : 0.3));
  }
}

TEST_CASE("A smoothed surface is the same whether or not it lies on the seams of blocks", "[export][surface]") {
  const Index3 n{138, 20, 20};
  constexpr int64_t kShift = 117;
  std::vector<Label> cells(static_cast<size_t>(n[0] * n[1] * n[2]));
  std::mt19937_64 random(11);
  const std::vector<Label> blob = random_cells(random, {20, 20, 20}, 2);
  for (int64_t z = 0; z < 20; ++z)
    for (int64_t y = 0; y < 20; ++y)
      for (int64_t x = 0; x < 20; ++x)
        for (const int64_t shift : {int64_t{0}, kShift})
          cells[static_cast<size_t>((z * n[1] + y) * n[0] + x + shift)] = blob[static_cast<size_t>((z * 20 + y) * 20 + x)];
  const SurfaceOf s(unit_grid(n), cells);
  const auto corners = [&](int64_t shift) {
    const Mesh mesh = s.ply({{shift, 0, 0}, {shift + 20, 20, 20}}, 0, {{"--smooth", "7"}});
    expect_manifold(mesh);
    std::vector<Vec3> out;
    for (const Vec3& v : mesh.vertices)
      out.push_back({std::round((v[0] - static_cast<double>(shift)) * 1e9), std::round(v[1] * 1e9), std::round(v[2] * 1e9)});
    std::ranges::sort(out);
    return out;
  };
  CHECK((corners(0) == corners(kShift)));
}

TEST_CASE("A surface that a format has no room for is refused by its runs alone, or while it is counted", "[export][surface]") {
  for (uint64_t seed = 0; seed < rounds(6); ++seed) {
    const Index3 n{20, 17, 23};
    const SurfaceOf s(unit_grid(n), noise(n, seed));
    std::vector<double> shares;
    const int level = static_cast<int>(seed % 3);  // level 1 is not stored
    const Export e{*s.reader, level, s.reader->meta().grid.box(level), s.folder / "s.ply", [&](double share) { shares.push_back(share); }};
    const faces::Surface all(e, {0, 1}, {"ply", UINT64_MAX, UINT64_MAX, ""});
    const uint64_t least = faces::least_vertices(e, {false, true, true, true}, ~uint64_t{0});
    CHECK(least > 0);
    CHECK(least <= all.vertices());
    CHECK(2 * least <= all.facets());
    CHECK_NOTHROW(faces::Surface(e, {0, 1}, {"ply", all.vertices(), all.facets(), ""}));
    shares.clear();
    CHECK_THROWS_WITH(faces::Surface(e, {0, 1}, {"ply", least - 1, UINT64_MAX, "stl"}),
                      fmt::format("--format: ply has at most {} vertices, this surface has {} at least: take stl", least - 1, least));
    CHECK(std::ranges::max(shares) == 0);
    CHECK_THROWS_WITH(faces::Surface(e, {0, 1}, {"stl", UINT64_MAX, all.facets() - 1, "ply"}), Catch::StartsWith("--format: stl has at most"));
  }
}

TEST_CASE("Surfaces that can't be are refused", "[export][surface]") {
  const SurfaceOf empty(unit_grid({4, 4, 4}), std::vector<Label>(64));
  const auto message = [](const SurfaceOf& s, const std::string& format, const Options& options = {}) {
    try {
      s.written(format, s.reader->meta().grid.box(0), 0, options);
    } catch (const UsageError& e) {
      CHECK(fs::directory_iterator(s.folder.path()) != fs::directory_iterator());
      for (const auto& entry : fs::directory_iterator(s.folder.path())) CHECK(entry.path().filename() == "g.tcell");
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(message(empty, "stl").find("no facet") != std::string::npos);
  CHECK(message(empty, "ply", {{"--material", "unobtainium"}}).find("--material: the grid has no material 'unobtainium'") != std::string::npos);
  for (const char* rounds : {"0", "21", "x", ""})
    CHECK(message(empty, "ply", {{"--smooth", rounds}}) == fmt::format("--smooth: expected 1 to 20, found '{}'", rounds));
  Grid far = unit_grid({4, 4, 4});
  far.axis[1] = Axis::uniform(1e9, 1, 0, 4, 0.5);
  const SurfaceOf s(far, std::vector<Label>(64, 1));
  CHECK(message(s, "stl").find("the planes 1000000000 and 1000000001 of y are one: take ply") != std::string::npos);
  expect_manifold(s.ply());
}

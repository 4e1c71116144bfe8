// Meshes of leaves against the leaves of the definition: every face, corner, level and patch.
#include <cmath>
#include <tuple>

#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/refined.hpp"
#include "tests/tools/export/foam_files.hpp"
#include "tools/export/formats.hpp"

namespace teracell {
namespace {

using namespace exports;
using namespace testing;
using foam::labels_of;
using foam::PolyMesh;

using Plane = std::array<int64_t, 3>;  // a point by the planes that it lies on

// What a mesh must be.
struct Wanted {
  Box box;
  std::vector<Leaf> leaves;         // all of the box
  std::vector<Box> boxes;           // of each, cut to the box
  std::map<Plane, size_t> leaf_of;  // that holds a cell
  std::vector<size_t> cells;        // those in the mesh, in order
  std::map<size_t, int> number;     // of a leaf in the mesh

  Wanted(const Metadata& meta, const std::vector<Label>& all, const Refinement& r, const Box& of, const std::set<uint32_t>& materials)
      : box(of), leaves(leaves_by_definition(meta, all, r, of)) {
    for (size_t i = 0; i < leaves.size(); ++i) {
      Box b{leaves[i].first(), {}};
      for (size_t d = 0; d < 3; ++d) {
        b.hi[d] = std::min(b.lo[d] + (int64_t{1} << leaves[i].level), of.hi[d]);
        b.lo[d] = std::max(b.lo[d], of.lo[d]);
      }
      boxes.push_back(b);
      for (int64_t z = b.lo[2]; z < b.hi[2]; ++z)
        for (int64_t y = b.lo[1]; y < b.hi[1]; ++y)
          for (int64_t x = b.lo[0]; x < b.hi[0]; ++x) leaf_of[{x, y, z}] = i;
      if (materials.contains(meta.labels[leaves[i].label].material)) cells.push_back(i);
    }
    count();
  }
  void count() {
    number.clear();
    for (const size_t i : cells) number.emplace(i, static_cast<int>(number.size()));
  }
  // The leaves that touch a face of a leaf.
  std::set<size_t> beside(size_t leaf) const {
    std::set<size_t> out;
    for (size_t axis = 0; axis < 3; ++axis)
      for (const bool up : {false, true}) {
        Box face = boxes[leaf];
        const int64_t at = up ? face.hi[axis] : face.lo[axis] - 1;
        face.lo[axis] = at, face.hi[axis] = at + 1;
        for (int64_t z = face.lo[2]; z < face.hi[2]; ++z)
          for (int64_t y = face.lo[1]; y < face.hi[1]; ++y)
            for (int64_t x = face.lo[0]; x < face.hi[0]; ++x)
              if (const auto it = leaf_of.find({x, y, z}); it != leaf_of.end()) out.insert(it->second);
      }
    return out;
  }
  void keep_largest_region() {
    std::map<size_t, size_t> region;
    std::vector<std::vector<size_t>> regions;
    for (const size_t begin : cells) {
      if (region.contains(begin)) continue;
      std::vector<size_t> found = {begin};
      region[begin] = regions.size();
      for (size_t i = 0; i < found.size(); ++i)
        for (const size_t next : beside(found[i]))
          if (number.contains(next) && region.try_emplace(next, regions.size()).second) found.push_back(next);
      regions.push_back(found);
    }
    cells = *std::ranges::max_element(regions, {}, [](const auto& r) { return r.size(); });
    std::ranges::sort(cells);
    count();
  }
};

// The places of a mesh's points by the planes of the grid.
std::vector<Plane> places_of(const PolyMesh& mesh, const Grid& grid) {
  std::vector<Plane> out;
  for (const Vec3& p : mesh.points) {
    Plane at{};
    for (size_t d = 0; d < 3; ++d) {
      while (at[d] < grid.axis[d].cells() && grid.axis[d].plane(at[d]) < p[d]) ++at[d];
      REQUIRE(grid.axis[d].plane(at[d]) == p[d]);
    }
    out.push_back(at);
  }
  return out;
}

struct FacePlace {
  size_t axis;
  int64_t plane;
  bool up;  // its normal
  Box box;  // flat on its axis
};

// Where a polygon lies; its corners go once round a rectangle.
FacePlace place_of(const std::vector<Plane>& corners) {
  FacePlace out{3, 0, false, {corners[0], corners[0]}};
  int64_t area[3] = {};
  for (size_t i = 0; i < corners.size(); ++i) {
    const Plane &a = corners[i], &b = corners[(i + 1) % corners.size()];
    int along = 0;
    for (size_t d = 0; d < 3; ++d) {
      out.box.lo[d] = std::min(out.box.lo[d], a[d]), out.box.hi[d] = std::max(out.box.hi[d], a[d]);
      along += a[d] != b[d];
      area[d] += a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
    }
    REQUIRE(along == 1);
  }
  for (size_t d = 0; d < 3; ++d)
    if (area[d] != 0) out.axis = d, out.up = area[d] > 0;
  REQUIRE(out.axis < 3);
  const size_t a = out.axis, b = (a + 1) % 3, c = (a + 2) % 3;
  REQUIRE(out.box.lo[a] == out.box.hi[a]);
  REQUIRE(std::abs(area[a]) == 2 * (out.box.hi[b] - out.box.lo[b]) * (out.box.hi[c] - out.box.lo[c]));
  out.plane = out.box.lo[a];
  return out;
}

// Checks the part of the mesh that has the cells [first, end).
void check_part(const Wanted& w, const Metadata& meta, const Refinement& r, const std::filesystem::path& folder, int first, int end) {
  const PolyMesh mesh(folder);
  const std::vector<Plane> points = places_of(mesh, meta.grid);
  CHECK(std::set(points.begin(), points.end()).size() == points.size());
  const auto leaf_number = [&](int32_t cell) { return w.cells[static_cast<size_t>(int64_t{first} + cell)]; };

  const std::vector<int32_t> cell_level = labels_of(folder / "cellLevel");
  REQUIRE(cell_level.size() == static_cast<size_t>(end - first));
  for (int32_t i = 0; i < end - first; ++i) REQUIRE(cell_level[static_cast<size_t>(i)] == r.coarsest - w.leaves[leaf_number(i)].level);

  // All corners of the mesh's faces: where two leaves touch, of one of which it has the cell, the smaller one's.
  std::map<Plane, int> coarsest;  // of the mesh's cells that have the corner
  for (const size_t i : w.cells)
    for (int corner = 0; corner < 8; ++corner) {
      const Box& b = w.boxes[i];
      const Plane p{corner % 2 == 0 ? b.lo[0] : b.hi[0], corner / 2 % 2 == 0 ? b.lo[1] : b.hi[1], corner / 4 == 0 ? b.lo[2] : b.hi[2]};
      coarsest.try_emplace(p, 0).first->second = std::max(coarsest[p], w.leaves[i].level);
    }
  const std::vector<int32_t> point_level = labels_of(folder / "pointLevel");
  REQUIRE(point_level.size() == points.size());
  for (size_t i = 0; i < points.size(); ++i)
    if (const auto it = coarsest.find(points[i]); it != coarsest.end()) REQUIRE(point_level[i] == r.coarsest - it->second);

  std::vector<bool> used(points.size());
  std::map<std::pair<size_t, size_t>, int> found;  // faces between two leaves
  std::vector<std::map<std::pair<int32_t, int32_t>, int>> edges(static_cast<size_t>(end - first));
  std::vector<int64_t> area(edges.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    std::vector<Plane> corners;
    for (const int32_t p : mesh.faces[f]) corners.push_back(points[static_cast<size_t>(p)]), used[static_cast<size_t>(p)] = true;
    const FacePlace face = place_of(corners);
    const size_t own = leaf_number(mesh.owner[f]);
    const Box& b = w.boxes[own];
    REQUIRE(face.plane == (face.up ? b.hi[face.axis] : b.lo[face.axis]));
    Plane beyond = face.box.lo;
    beyond[face.axis] = face.up ? face.plane : face.plane - 1;
    const auto there = w.leaf_of.find(beyond);
    const bool inner = f < mesh.neighbour.size();
    // It lies where both leaves touch.
    for (size_t d = 0; d < 3; ++d) {
      if (d == face.axis) continue;
      int64_t lo = b.lo[d], hi = b.hi[d];
      if (there != w.leaf_of.end()) lo = std::max(lo, w.boxes[there->second].lo[d]), hi = std::min(hi, w.boxes[there->second].hi[d]);
      REQUIRE((face.box.lo[d] == lo && face.box.hi[d] == hi));
    }
    const auto side = [&](int32_t cell, bool turned) {
      const auto n = static_cast<size_t>(cell);
      const size_t size = mesh.faces[f].size();
      for (size_t i = 0; i < size; ++i) {
        std::pair edge(mesh.faces[f][i], mesh.faces[f][(i + 1) % size]);
        if (turned) std::swap(edge.first, edge.second);
        ++edges[n][edge];
      }
      int64_t a = 1;
      for (size_t d = 0; d < 3; ++d) a *= d == face.axis ? 1 : face.box.hi[d] - face.box.lo[d];
      area[n] += a;
    };
    side(mesh.owner[f], false);
    if (inner) {
      REQUIRE(there != w.leaf_of.end());
      REQUIRE(leaf_number(mesh.neighbour[f]) == there->second);
      REQUIRE(mesh.owner[f] < mesh.neighbour[f]);
      if (f > 0) REQUIRE(std::tuple(mesh.owner[f - 1], mesh.neighbour[f - 1]) < std::tuple(mesh.owner[f], mesh.neighbour[f]));
      side(mesh.neighbour[f], true);
      continue;
    }
    const foam::Patch& patch = mesh.patch_of(f);
    if (patch.type == "processor") {
      REQUIRE(there != w.leaf_of.end());
      const int other = w.number.at(there->second);
      REQUIRE((other < first || other >= end));
    } else if (there == w.leaf_of.end()) {
      REQUIRE(patch.name == fmt::format("{}{}", axis_name(static_cast<int>(face.axis)), face.up ? "max" : "min"));
    } else {
      REQUIRE_FALSE(w.number.contains(there->second));
      REQUIRE(patch.name == meta.materials[meta.labels[w.leaves[there->second].label].material].name);
    }
  }
  CHECK(std::ranges::count(used, false) == 0);
  // Each cell is closed: its faces are its whole surface, and each edge lies between two of them.
  for (size_t i = 0; i < edges.size(); ++i) {
    const Box& b = w.boxes[leaf_number(static_cast<int32_t>(i))];
    const int64_t x = b.hi[0] - b.lo[0], y = b.hi[1] - b.lo[1], z = b.hi[2] - b.lo[2];
    REQUIRE(area[i] == 2 * (x * y + y * z + z * x));
    for (const auto& [edge, times] : edges[i]) {
      REQUIRE(times == 1);
      REQUIRE(edges[i].contains({edge.second, edge.first}));
    }
  }
}

// What stands on both sides of the parts' common faces.
void check_common_faces(const Metadata& meta, const std::filesystem::path& folder, int ranks) {
  std::map<std::pair<int, int>, std::vector<std::vector<Plane>>> faces;
  for (int rank = 0; rank < ranks; ++rank) {
    const PolyMesh mesh(folder / fmt::format("processor{}", rank) / "constant/polyMesh");
    const std::vector<Plane> points = places_of(mesh, meta.grid);
    for (const foam::Patch& p : mesh.patches) {
      if (p.type != "processor") continue;
      for (int64_t f = p.start; f < p.start + p.faces; ++f) {
        std::vector<Plane>& corners = faces[{rank, p.other}].emplace_back();
        for (const int32_t c : mesh.faces[static_cast<size_t>(f)]) corners.push_back(points[static_cast<size_t>(c)]);
      }
    }
  }
  for (auto [between, mine] : faces) {
    if (between.first > between.second) continue;
    for (auto& corners : mine) std::reverse(corners.begin() + 1, corners.end());
    CHECK(mine == faces.at({between.second, between.first}));
  }
}

TEST_CASE("A mesh of leaves has the cells, faces, points, levels and patches of the definition, as a whole and in parts") {
  int checked = 0;
  for (int seed = 0; seed < 24; ++seed) {
    std::mt19937_64 random(static_cast<uint64_t>(seed));
    const TempFolder folder;
    Index3 n;
    for (int64_t& cells : n) cells = random_int(random, 1, 18);
    if (seed % 4 == 0) n[random() % 3] = random_int(random, 60, 150);  // several blocks
    const std::vector<Label> cells = blobs(random, n, 3);
    const Metadata meta = with_tiny_chunks(metadata_of(uniform_grid(-1.5, 0.25, n), seed % 3, 3));
    const GridReader reader = reader_of(meta, cells);
    Refinement r;
    r.coarsest = random_int(random, 0, 7), r.layers = random_int(random, 1, 2);
    std::map<std::string, std::string> options = {{"--refine", fmt::format("{},{}", r.coarsest, r.layers)},
                                                  {"--threads", fmt::format("{}", 1 + seed % 3)}};
    if (random() % 3 == 0) {  // walls beside cells of several levels
      r.interfaces = random_int(random, 0, r.coarsest);
      r.of_materials.assign(3, kNoLevel), r.of_materials[2] = random_int(random, 0, r.coarsest);
      options["--want"] = fmt::format("interface={},material:m2={}", r.interfaces, r.of_materials[2]);
    }
    std::set<uint32_t> materials = {0};
    if (random() % 2 == 0) options["--fluid"] = "m0,m1", materials.insert(1);
    Box box = meta.grid.box(0);
    if (random() % 3 == 0)
      for (size_t d = 0; d < 3; ++d) {
        box.lo[d] = random_int(random, 0, static_cast<int>(n[d]) - 1);
        box.hi[d] = random_int(random, static_cast<int>(box.lo[d]) + 1, static_cast<int>(n[d]));
      }
    Wanted wanted(meta, cells, r, box, materials);
    if (random() % 2 == 0 && !wanted.cells.empty()) options["--drop-unreachable"], wanted.keep_largest_region();
    INFO("seed " << seed << ", " << n[0] << " x " << n[1] << " x " << n[2] << ", " << options["--refine"] << " " << options["--want"]);
    const auto write = [&](const std::filesystem::path& to) {
      export_format_named("openfoam")->write({reader, 0, box, to, [](double) {}, {}, options});
    };
    if (wanted.cells.empty()) {
      CHECK_THROWS_AS(write(folder / "case"), UsageError);
      continue;
    }
    ++checked;
    const auto all = static_cast<int>(wanted.cells.size());
    write(folder / "case");
    check_part(wanted, meta, r, folder / "case/constant/polyMesh", 0, all);
    const int ranks = random_int(random, 1, std::min(all, 5));
    options["--ranks"] = std::to_string(ranks);
    write(folder / "case");
    for (int rank = 0; rank < ranks; ++rank)
      check_part(wanted, meta, r, folder / fmt::format("case/processor{}/constant/polyMesh", rank), all / ranks * rank + std::min(rank, all % ranks),
                 all / ranks * (rank + 1) + std::min(rank + 1, all % ranks));
    check_common_faces(meta, folder / "case", ranks);
  }
  CHECK(checked > 14);
}

}  // namespace
}  // namespace teracell

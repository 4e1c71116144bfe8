#include <map>
#include <set>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "store/error.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/stored.hpp"
#include "tools/export/formats.hpp"

using namespace teracell;
using namespace teracell::testing;
namespace fs = std::filesystem;

namespace {

using Options = std::map<std::string, std::string>;

void export_case(const GridReader& reader, const Box& box, const fs::path& folder, const Options& options = {}, int level = 0) {
  export_format_named("openfoam")->write({reader, level, box, folder, [](double) {}, {}, options});
}

// ---- What is written, read back.

// A file of OpenFOAM from its header on.
class FoamText {
 public:
  explicit FoamText(const fs::path& path) : text_(bytes_of(path)), at_(text_.find("}\n") + 2) { REQUIRE(text_.starts_with("FoamFile\n{\n")); }
  bool next_is(char c) {
    skip();
    return at_ < text_.size() && text_[at_] == c;
  }
  bool at_end() {
    skip();
    return at_ == text_.size();
  }
  std::string word() {
    skip();
    const size_t begin = at_;
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) == 0 && text_[at_] != ';' && text_[at_] != '(') ++at_;
    return text_.substr(begin, at_ - begin);
  }
  void expect(char c) {
    REQUIRE(next_is(c));
    ++at_;
  }
  int64_t number() { return std::stoll(word()); }
  template <class T>
  std::vector<T> list(int64_t numbers_each = 1) {
    std::vector<T> out(static_cast<size_t>(number() / numbers_each));
    if (out.empty()) return out;
    expect('(');
    REQUIRE(text_.size() - at_ > out.size() * sizeof(T));
    std::memcpy(out.data(), text_.data() + at_, out.size() * sizeof(T));
    at_ += out.size() * sizeof(T);
    expect(')');
    return out;
  }
  // The entries of a dictionary whose values are single words.
  std::map<std::string, std::string> dictionary() {
    std::map<std::string, std::string> out;
    for (expect('{'); !next_is('}');) {
      const std::string key = word();
      skip();
      const size_t end = text_.find(';', at_);
      out[key] = text_.substr(at_, end - at_);
      at_ = end + 1;
    }
    expect('}');
    return out;
  }

 private:
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  std::string text_;
  size_t at_;
};

template <class T>
std::vector<T> only_list(const fs::path& path) {
  FoamText text(path);
  std::vector<T> out = text.list<T>();
  REQUIRE(text.at_end());
  return out;
}

struct Patch {
  std::string name, type;
  int64_t faces, start;
  int other = -1;  // of a processor patch
};

struct PolyMesh {
  explicit PolyMesh(const fs::path& folder)
      : points(only_list<Vec3>(folder / "points")), owner(only_list<int32_t>(folder / "owner")), neighbour(only_list<int32_t>(folder / "neighbour")) {
    FoamText face_text(folder / "faces");
    const auto begins = face_text.list<int32_t>();
    faces = face_text.list<std::array<int32_t, 4>>(4);
    REQUIRE(begins.size() == faces.size() + 1);
    for (size_t i = 0; i < begins.size(); ++i) REQUIRE(begins[i] == static_cast<int32_t>(4 * i));
    REQUIRE(owner.size() == faces.size());
    FoamText patch_text(folder / "boundary");
    const int64_t patch_count = patch_text.number();
    for (patch_text.expect('('); !patch_text.next_is(')');) {
      const std::string name = patch_text.word();
      auto d = patch_text.dictionary();
      patches.push_back({name, d["type"], std::stoll(d["nFaces"]), std::stoll(d["startFace"])});
      if (patches.back().type == "processor") patches.back().other = std::stoi(d["neighbProcNo"]);
    }
    REQUIRE(static_cast<int64_t>(patches.size()) == patch_count);
    if (!fs::exists(folder / "cellZones")) return;
    FoamText zone_text(folder / "cellZones");
    const int64_t zone_count = zone_text.number();
    for (zone_text.expect('('); !zone_text.next_is(')');) {
      const std::string name = zone_text.word();
      zone_text.expect('{');
      REQUIRE(zone_text.word() == "type");
      REQUIRE(zone_text.word() == "cellZone");
      zone_text.expect(';');
      REQUIRE(zone_text.word() == "cellLabels");
      REQUIRE(zone_text.word() == "List<label>");
      zones[name] = zone_text.list<int32_t>();
      zone_text.expect(';');
      zone_text.expect('}');
    }
    REQUIRE(static_cast<int64_t>(zones.size()) == zone_count);
  }
  const Patch& patch_of(size_t face) const {
    for (const Patch& p : patches)
      if (static_cast<int64_t>(face) >= p.start && static_cast<int64_t>(face) < p.start + p.faces) return p;
    throw std::logic_error("the face has no patch");
  }

  std::vector<Vec3> points;
  std::vector<std::array<int32_t, 4>> faces;
  std::vector<int32_t> owner, neighbour;
  std::vector<Patch> patches;
  std::map<std::string, std::vector<int32_t>> zones;
};

// ---- What is expected, cell by cell.

struct Expected {
  Expected(const GridReader& reader, int level, const Box& of, double to_metres, const std::set<uint32_t>& mesh_materials) : box(of) {
    const Index3 all = reader.meta().grid.cells(level);
    const std::vector<uint32_t> dense = all_cells(reader, level);
    for (int d = 0; d < 3; ++d) {
      n[d] = box.hi[d] - box.lo[d];
      const Axis& axis = reader.meta().grid.axis[d];
      for (int64_t i = box.lo[d]; i <= box.hi[d]; ++i) planes[d].push_back(axis.plane(std::min(axis.cells(), i << level)) * to_metres);
    }
    for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
      for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
        for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) {
          material.push_back(dense[static_cast<size_t>((z * all[1] + y) * all[0] + x)]);
          in_mesh.push_back(mesh_materials.contains(material.back()));
        }
    for (const MaterialInfo& m : reader.meta().materials) names.push_back(m.name);
    number_cells();
  }
  bool inside(const Index3& c) const {
    for (int d = 0; d < 3; ++d)
      if (c[d] < 0 || c[d] >= n[d]) return false;
    return true;
  }
  size_t at(const Index3& c) const { return static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0]); }
  Index3 place(size_t i) const {
    const auto k = static_cast<int64_t>(i);
    return {k % n[0], k / n[0] % n[1], k / n[0] / n[1]};
  }
  void number_cells() {
    number.assign(material.size(), -1);
    cells.clear();
    for (size_t i = 0; i < material.size(); ++i)
      if (in_mesh[i]) number[i] = static_cast<int64_t>(cells.size()), cells.push_back(i);
  }
  // Leaves only the largest region; the first of those that are equally large.
  void drop_unreachable() {
    std::vector<int> region(material.size(), -1);
    std::vector<size_t> sizes;
    for (const size_t seed : cells) {
      if (region[seed] >= 0) continue;
      std::vector<size_t> open = {seed};
      region[seed] = static_cast<int>(sizes.size());
      sizes.push_back(0);
      while (!open.empty()) {
        const Index3 c = place(open.back());
        open.pop_back();
        ++sizes.back();
        for (int d = 0; d < 6; ++d) {
          Index3 other = c;
          other[d / 2] += d % 2 == 0 ? 1 : -1;
          if (!inside(other) || !in_mesh[at(other)] || region[at(other)] >= 0) continue;
          region[at(other)] = static_cast<int>(sizes.size()) - 1;
          open.push_back(at(other));
        }
      }
    }
    const auto largest = static_cast<int>(std::ranges::max_element(sizes) - sizes.begin());
    for (size_t i = 0; i < in_mesh.size(); ++i) in_mesh[i] = in_mesh[i] && region[i] == largest;
    number_cells();
  }
  // The patch that lies beyond the box or is made of the cell.
  std::string patch(const Index3& c) const {
    for (int d = 0; d < 3; ++d) {
      if (c[d] < 0) return axis_name(d) + "min";
      if (c[d] >= n[d]) return axis_name(d) + "max";
    }
    return names[material[at(c)]];
  }

  Box box;
  Index3 n;
  std::array<std::vector<double>, 3> planes;
  std::vector<uint32_t> material;
  std::vector<bool> in_mesh;
  std::vector<int64_t> number;
  std::vector<size_t> cells;
  std::vector<std::string> names;
};

// Where a face lies, told from its points alone: the cells behind and before it by its normal.
struct Between {
  Index3 behind, before;
};

int64_t plane_index(const std::vector<double>& planes, double at) {
  const auto it = std::ranges::find(planes, at);
  REQUIRE(it != planes.end());
  return it - planes.begin();
}

Between place_of(const Expected& e, const PolyMesh& mesh, size_t face) {
  std::array<Index3, 4> p;
  for (int i = 0; i < 4; ++i)
    for (int d = 0; d < 3; ++d) p[i][d] = plane_index(e.planes[d], mesh.points[static_cast<size_t>(mesh.faces[face][i])][d]);
  Index3 a, b, normal, low = p[0];
  for (int d = 0; d < 3; ++d) {
    a[d] = p[1][d] - p[0][d], b[d] = p[3][d] - p[0][d];
    REQUIRE(p[2][d] == p[1][d] + b[d]);  // a rectangle in this order
    for (const Index3& q : p) low[d] = std::min(low[d], q[d]);
  }
  int64_t length = 0;
  for (int d = 0; d < 3; ++d) {
    normal[d] = a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3];
    length += std::abs(normal[d]);
  }
  REQUIRE(length == 1);  // of one cell's size, across an axis
  Between out{low, low};
  for (int d = 0; d < 3; ++d) {
    if (normal[d] > 0) --out.behind[d];
    if (normal[d] < 0) --out.before[d];
  }
  return out;
}

// A mesh of the cells with these numbers, in this order: all its faces lie where they should, once, and in the right lists.
void check_mesh(const Expected& e, const PolyMesh& mesh, const std::vector<int64_t>& cells, bool divided) {
  std::map<int64_t, int32_t> local;
  for (const int64_t c : cells) local[c] = static_cast<int32_t>(local.size());
  const std::set<Vec3> distinct(mesh.points.begin(), mesh.points.end());
  REQUIRE(distinct.size() == mesh.points.size());
  std::vector<bool> used(mesh.points.size(), false);
  std::vector<int> sides(cells.size(), 0);  // of each cell that were met, a bit each
  int64_t end = static_cast<int64_t>(mesh.neighbour.size());
  for (const Patch& p : mesh.patches) {
    REQUIRE(p.start == end);
    end += p.faces;
  }
  REQUIRE(end == static_cast<int64_t>(mesh.faces.size()));
  const auto meet = [&](int32_t cell, const Index3& own, const Index3& other) {
    int side = 0;
    for (int d = 0; d < 3; ++d)
      if (own[d] != other[d]) side = 2 * d + (other[d] > own[d] ? 1 : 0);
    REQUIRE((sides[static_cast<size_t>(cell)] >> side & 1) == 0);
    sides[static_cast<size_t>(cell)] |= 1 << side;
  };
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    for (const int32_t p : mesh.faces[f]) used[static_cast<size_t>(p)] = true;
    const Between b = place_of(e, mesh, f);
    REQUIRE(e.inside(b.behind));
    const int32_t owner = mesh.owner[f];
    REQUIRE(local.at(e.number[e.at(b.behind)]) == owner);
    meet(owner, b.behind, b.before);
    const int64_t beyond = e.inside(b.before) ? e.number[e.at(b.before)] : -1;
    if (f < mesh.neighbour.size()) {
      const int32_t neighbour = mesh.neighbour[f];
      REQUIRE(neighbour > owner);
      REQUIRE(local.at(beyond) == neighbour);
      meet(neighbour, b.before, b.behind);
      if (f > 0) REQUIRE((std::pair(mesh.owner[f - 1], mesh.neighbour[f - 1]) < std::pair(owner, neighbour)));
      continue;
    }
    const Patch& patch = mesh.patch_of(f);
    if (patch.type == "processor") {
      REQUIRE(divided);
      REQUIRE(beyond >= 0);
      REQUIRE_FALSE(local.contains(beyond));
      continue;
    }
    REQUIRE(beyond < 0);
    REQUIRE(patch.name == e.patch(b.before));
    REQUIRE(patch.type == (e.inside(b.before) ? "wall" : "patch"));
  }
  REQUIRE(std::ranges::all_of(sides, [](int s) { return s == 63; }));
  REQUIRE(std::ranges::all_of(used, [](bool u) { return u; }));
}

void check_zones(const Expected& e, const PolyMesh& mesh, const std::vector<int64_t>& cells) {
  std::map<std::string, std::vector<int32_t>> expected;
  for (const size_t c : e.cells) expected[e.names[e.material[c]]];  // parts have the zones of all
  for (size_t i = 0; i < cells.size(); ++i) expected[e.names[e.material[e.cells[static_cast<size_t>(cells[i])]]]].push_back(static_cast<int32_t>(i));
  CHECK((mesh.zones == expected));
}

std::vector<int64_t> all_numbers(const Expected& e) {
  std::vector<int64_t> out;
  for (size_t i = 0; i < e.cells.size(); ++i) out.push_back(static_cast<int64_t>(i));
  return out;
}

// Parts of the mesh and what they say of the whole one.
void check_parts(const Expected& e, const PolyMesh& whole, const fs::path& folder, int ranks, bool zones) {
  std::vector<PolyMesh> parts;
  std::set<int32_t> points, faces, cells;
  const auto mesh_of = [&](int r) { return folder / fmt::format("processor{}", r) / "constant" / "polyMesh"; };
  for (int r = 0; r < ranks; ++r) parts.emplace_back(mesh_of(r));
  CHECK_FALSE(fs::exists(folder / fmt::format("processor{}", ranks)));
  for (int r = 0; r < ranks; ++r) {
    const PolyMesh& part = parts[static_cast<size_t>(r)];
    const auto in_whole = [&](const char* name) { return only_list<int32_t>(mesh_of(r) / name); };
    const std::vector<int32_t> cell = in_whole("cellProcAddressing"), point = in_whole("pointProcAddressing"), face = in_whole("faceProcAddressing"),
                               patch = in_whole("boundaryProcAddressing");
    CHECK((cell.size() == e.cells.size() / ranks || cell.size() == e.cells.size() / ranks + 1));
    const std::vector<int64_t> numbers(cell.begin(), cell.end());
    check_mesh(e, part, numbers, true);
    if (zones) check_zones(e, part, numbers);
    cells.insert(cell.begin(), cell.end());
    REQUIRE(point.size() == part.points.size());
    for (size_t i = 0; i < point.size(); ++i) REQUIRE((part.points[i] == whole.points[static_cast<size_t>(point[i])]));
    points.insert(point.begin(), point.end());
    REQUIRE(face.size() == part.faces.size());
    for (size_t i = 0; i < face.size(); ++i) {
      REQUIRE(face[i] != 0);
      const auto there = static_cast<size_t>(std::abs(face[i]) - 1);
      faces.insert(std::abs(face[i]) - 1);
      std::array<int32_t, 4> corners = whole.faces[there];
      if (face[i] < 0) std::swap(corners[1], corners[3]);
      for (int k = 0; k < 4; ++k) REQUIRE(point[static_cast<size_t>(part.faces[i][k])] == corners[k]);
      if (i >= part.neighbour.size() && part.patch_of(i).type != "processor") REQUIRE(whole.patch_of(there).name == part.patch_of(i).name);
    }
    REQUIRE(patch.size() == part.patches.size());
    for (size_t i = 0; i < patch.size(); ++i) {
      const Patch& own = part.patches[i];
      if (own.other < 0) {
        REQUIRE(whole.patches[static_cast<size_t>(patch[i])].name == own.name);
        continue;
      }
      REQUIRE(patch[i] == -1);
      REQUIRE(own.name == fmt::format("procBoundary{}to{}", r, own.other));
      // The same faces in the same order on the other side, reversed from the same first point.
      const PolyMesh& opposite = parts.at(static_cast<size_t>(own.other));
      const auto its = std::ranges::find(opposite.patches, r, &Patch::other);
      REQUIRE(its != opposite.patches.end());
      REQUIRE(its->faces == own.faces);
      for (int64_t k = 0; k < own.faces; ++k) {
        const auto &a = part.faces[static_cast<size_t>(own.start + k)], &b = opposite.faces[static_cast<size_t>(its->start + k)];
        for (int c = 0; c < 4; ++c) REQUIRE((part.points[static_cast<size_t>(a[c])] == opposite.points[static_cast<size_t>(b[(4 - c) % 4])]));
      }
    }
  }
  CHECK(points.size() == whole.points.size());
  CHECK(faces.size() == whole.faces.size());
  CHECK(cells.size() == e.cells.size());
}

// ---- Grids.

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
  constexpr uint32_t kLabels = 40;
  Metadata meta = random_meta(random, n, 700);
  meta.labels.resize(kLabels);
  for (uint32_t i = 1; i < kLabels; ++i) meta.labels[i].material = 700 - kLabels + i;
  store_cells(folder / "g.tcell", meta, random_cells(random, n, kLabels));
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
  refused({{"--fluid", "m1,m2"}}, "'m1', 'm2'");
  for (const char* ranks : {"0", "-1", "two", "", "3x", "100001"}) refused({{"--ranks", ranks}}, "expected 1 to 100000");
  refused({{"--ranks", "61"}}, "60 cells");
}

TEST_CASE("A mesh beyond 32-bit labels is refused with the number of ranks that it needs", "[openfoam]") {
  const TempFolder folder;
  Grid grid;
  const Index3 n{700, 700, 400};
  for (int d = 0; d < 3; ++d) grid.axis[d] = Axis::uniform(0, 1, 0, n[d], 0.5);
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

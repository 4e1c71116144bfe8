#include "tests/tools/export/foam_check.hpp"

#include "store/channels/link_reader.hpp"
#include "tests/support/meshed.hpp"

namespace fs = std::filesystem;

namespace teracell::testing::foam {
namespace {

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

}  // namespace

Expected::Expected(const GridReader& reader, int level, const Box& of, double to_metres, const std::set<uint32_t>& mesh_materials) : box(of) {
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

void Expected::number_cells() {
  number.assign(material.size(), -1);
  cells.clear();
  for (size_t i = 0; i < material.size(); ++i)
    if (in_mesh[i]) number[i] = static_cast<int64_t>(cells.size()), cells.push_back(i);
}

void Expected::drop_unreachable() {
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

void Expected::read_patches(const GridReader& reader) {
  const LinkReader links(reader);
  for (int d = 0; d < 3; ++d)
    links.for_each(d, box, [&](std::span<const CellLink> found) {
      for (const CellLink& l : found) {
        Index3 lower = l.cell, upper;
        for (int k = 0; k < 3; ++k) lower[k] -= box.lo[k];
        upper = lower;
        ++upper[d];
        if (l.patch != kNoPatch) patches[{lower, upper}] = reader.meta().patches[l.patch].name;
      }
    });
}

std::string Expected::patch(const Index3& own, const Index3& c) const {
  for (int d = 0; d < 3; ++d) {
    if (c[d] < 0) return axis_name(d) + "min";
    if (c[d] >= n[d]) return axis_name(d) + "max";
  }
  const auto found = patches.find(std::minmax(own, c));
  return found == patches.end() ? names[material[at(c)]] : found->second;
}

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
    REQUIRE(mesh.faces[f].size() == 4);
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
    REQUIRE(patch.name == e.patch(b.behind, b.before));
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

void check_parts(const Expected& e, const PolyMesh& whole, const fs::path& folder, int ranks, bool zones) {
  std::vector<PolyMesh> parts;
  std::set<int32_t> points, faces, cells;
  const auto mesh_of = [&](int r) { return folder / fmt::format("processor{}", r) / "constant" / "polyMesh"; };
  for (int r = 0; r < ranks; ++r) parts.emplace_back(mesh_of(r));
  CHECK_FALSE(fs::exists(folder / fmt::format("processor{}", ranks)));
  for (int r = 0; r < ranks; ++r) {
    const PolyMesh& part = parts[static_cast<size_t>(r)];
    const auto in_whole = [&](const char* name) { return labels_of(mesh_of(r) / name); };
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
      std::vector<int32_t> corners = whole.faces[there];
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

}  // namespace teracell::testing::foam

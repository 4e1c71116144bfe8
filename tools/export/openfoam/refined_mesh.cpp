#include "tools/export/openfoam/refined_mesh.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "tools/export/openfoam/leaf_faces.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports::foam {
using GroupOut = RefinedMesh::GroupOut;
using PartOut = RefinedMesh::PartOut;

namespace {

constexpr int64_t kMostKept = 1 << 20;  // cells whose faces are kept between counting and writing: 150 MB

template <class List, class Key, class Make>
auto& entry_of(List& list, const Key& key, Make&& make) {
  for (auto& entry : list)
    if (key(entry)) return entry;
  return list.emplace_back(make());
}
PartOut& part_in(std::vector<PartOut>& parts, uint32_t part) {
  return entry_of(
      parts, [&](const PartOut& p) { return p.part == part; }, [&] { return PartOut{part, {}, {}, {}, {}, {}}; });
}
GroupOut& group_in(PartOut& part, FaceGroup group) {
  return entry_of(
      part.groups, [&](const GroupOut& g) { return g.group == group; },
      [&] {
        return GroupOut{group, {}, {}, {}, {}};
      });
}

}  // namespace

// The patches of the surface on faces around a block, as the links at their middles tell.
class RefinedMesh::Walls {
 public:
  Walls(const LinkReader* links, const Box& box) : links_(links), box_(box) {}

  // What lies beyond a face at the rim of the mesh.
  uint32_t what(const LeafFace& face) {
    if (!face.beyond) return kSides + static_cast<uint32_t>(2 * face.axis() + (face.up() ? 1 : 0));
    const uint32_t material = face.beyond.material();
    if (links_ == nullptr) return material;
    Index3 cell = face.smaller.first;
    for (size_t d = 0; d < 3; ++d) {
      if (face.smaller.level > 0) cell[d] += int64_t{1} << (face.smaller.level - 1);
      cell[d] = std::clamp(cell[d], face.smaller.lo(d), face.smaller.hi(d) - 1);
    }
    const auto axis = static_cast<size_t>(face.axis());
    cell[axis] = face.plane - 1;
    const uint32_t patch = patch_at(face.axis(), cell);
    return patch == kNoPatch ? material : kSurface + patch;
  }

 private:
  uint32_t patch_at(int axis, const Index3& cell) {
    auto& known = known_[static_cast<size_t>(axis)];
    if (!read_[static_cast<size_t>(axis)]) {
      read_[static_cast<size_t>(axis)] = true;
      links_->for_each(axis, box_, [&](std::span<const CellLink> links) {
        for (const CellLink& link : links) known.emplace_back(link.cell, link.patch);
      });
      std::ranges::sort(known);
    }
    const auto it = std::ranges::lower_bound(known, cell, {}, &std::pair<Index3, uint32_t>::first);
    return it != known.end() && it->first == cell ? it->second : kNoPatch;
  }

  const LinkReader* const links_;
  const Box box_;
  std::array<std::vector<std::pair<Index3, uint32_t>>, 3> known_;
  std::array<bool, 3> read_{};
};

// Goes through the cells of a block, and the faces that they own.
class RefinedMesh::Block {
 public:
  Block(const RefinedMesh& mesh, const Index3& at)
      : mesh_(mesh), near_(mesh.grid_, at), block_(near_.own()), points_(*mesh.points_, near_), walls_(mesh.links_, around(at)) {}

  // face(cell, part, LeafFace, number of the cell beyond, or negative, and its part): sorted by the number of the cell beyond, those at the rim last.
  template <class Cell, class Face>
  void for_each_cell(Cell&& cell, Face&& face) {
    std::vector<LeafFace> faces;
    std::vector<std::pair<int64_t, uint32_t>> owned;  // by the number of the cell beyond
    for (uint32_t i = 0; i < block_.size(); ++i) {
      const LeafAt leaf = near_.leaf(block_, i);
      if (!leaf.in_mesh()) continue;
      const int64_t number = leaf.number();
      const uint32_t part = part_of(mesh_.begins_, number);
      begin(leaf, part);
      cell(leaf, number, part);
      faces.clear(), owned.clear();
      for_each_face(near_, leaf, [&](const LeafFace& f) {
        const bool inner = f.beyond && f.beyond.in_mesh();
        if (inner && f.beyond.number() < number) return;
        owned.emplace_back(inner ? f.beyond.number() : kRim, static_cast<uint32_t>(faces.size()));
        faces.push_back(f);
      });
      std::ranges::sort(owned);
      for (const auto& [beyond, which] : owned)
        face(number, part, faces[which], beyond == kRim ? -1 : beyond, beyond == kRim ? part : part_of(mesh_.begins_, beyond));
    }
  }

  // The corners of a face of the cell that for_each_cell() is at: how many, and their numbers in the cell's part.
  size_t corners(const LeafFace& face) {
    size_t n = 4;
    for_each_corner(
        face, [](size_t) {}, [&](size_t place) { n += number(place) >= 0 ? 1 : 0; });
    return n;
  }
  void append(const LeafFace& face, std::vector<int32_t>& out) {
    for_each_corner(
        face, [&](size_t place) { out.push_back(static_cast<int32_t>(number(place))); },
        [&](size_t place) {
          if (const int64_t n = number(place); n >= 0) out.push_back(static_cast<int32_t>(n));
        });
  }
  // Appends them as the other part has them, reversed; the first one stays.
  void append_reversed(const LeafFace& face, uint32_t other, std::vector<int32_t>& out) {
    const size_t begin = out.size();
    const auto put = [&](size_t place) {
      if (const int64_t n = points_.number(point_at(place), other, mesh_.mesh_.box); n >= 0) out.push_back(static_cast<int32_t>(n));
    };
    for_each_corner(face, put, put);
    std::reverse(out.begin() + static_cast<std::ptrdiff_t>(begin) + 1, out.end());
  }
  uint32_t what(const LeafFace& face) { return walls_.what(face); }
  size_t cells() const { return block_.in_mesh; }

  // point(part, point, level of the coarsest cell that has it as a corner)
  template <class Point>
  void for_each_point(Point&& point) {
    const auto owned = mesh_.points_->block(block_.at);
    const auto tell = [&](uint32_t i, uint32_t part, const PointBlock::Entry& entry) {
      if (entry.points == 0) return;
      const LeafAt leaf = near_.leaf(block_, i);
      for (uint32_t rest = entry.points; rest != 0; rest &= rest - 1) {
        const auto number = static_cast<uint32_t>(std::countr_zero(rest));
        const Index3 p = LeafPoints::place(leaf, number);
        point(part, p, coarsest_at(leaf, number, p));
      }
    };
    for (uint32_t i = 0; i < block_.size(); ++i) tell(i, owned->part, owned->entries[i]);
    for (const PointBlock::Other& other : owned->others) tell(other.leaf, other.part, other.entry);
  }

 private:
  Box around(const Index3& at) const {
    Box out;
    for (size_t d = 0; d < 3; ++d) out.lo[d] = (at[d] << LeafBlock::kBits) - 1, out.hi[d] = ((at[d] + 1) << LeafBlock::kBits) + 1;
    for (uint32_t i = 0; i < block_.size(); ++i)  // a larger leaf reaches beyond its block
      if (block_.leaves[i].level > LeafBlock::kBits)
        for (size_t d = 0; d < 3; ++d) out.hi[d] = out.lo[d] + 2 + (int64_t{1} << block_.leaves[i].level);
    return out;
  }
  // Mostly the owner's level tells: a coarser leaf has no corner between its own, and what lies in the middle of an edge or a face is the corner of
  // leaves that are one level finer.
  int coarsest_at(const LeafAt& owner, uint32_t number, const Index3& p) {
    if (number == 0 && owner.in_mesh()) {
      const int64_t within_coarser = (int64_t{2} << owner.level) - 1;
      for (size_t d = 0; d < 3; ++d)
        if ((p[d] & within_coarser) != 0 && p[d] > mesh_.mesh_.box.lo[d]) return owner.level;
    }
    int of_mesh = -1, of_any = 0;
    for (const LeafAt& leaf : near_.around(p)) {
      if (!leaf || !leaf.has_corner(p)) continue;
      of_any = std::max(of_any, leaf.level);
      if (leaf.in_mesh()) of_mesh = std::max(of_mesh, leaf.level);
    }
    return of_mesh >= 0 ? of_mesh : of_any;
  }

  // What is known of the points of cells before holds for this one if both are among the same eight.
  void begin(const LeafAt& cell, uint32_t part) {
    const auto of_eight = [&](size_t d) { return cell.first[d] >> cell.level & 1; };
    Index3 eight;
    for (size_t d = 0; d < 3; ++d) eight[d] = cell.first[d] - (of_eight(d) << cell.level);
    if (cell.level != cell_.level || eight != eight_ || part != part_) known_.fill(kUnknown);
    cell_ = cell, eight_ = eight, part_ = part, own_ = 0;
    for (size_t d = 0; d < 3; ++d) own_ += 2 * kStep[d] * static_cast<size_t>(of_eight(d)), half_[d] = cell.half(d).has_value();
  }
  // Places are the corners of the eight cells and what lies halfway between them, 5 x 5 x 5. Calls f(place) for the corners of a face, with its
  // normal away from the cell, and g(place) for the middles of edges, which are corners only where the mesh has a point: in their order.
  template <class F, class G>
  void for_each_corner(const LeafFace& face, F&& f, G&& g) const {
    const auto a = static_cast<size_t>(face.axis());
    std::array<size_t, 2> in_plane{(a + 1) % 3, (a + 2) % 3};
    if (!face.up()) std::swap(in_plane[0], in_plane[1]);
    size_t first = own_ + (face.up() ? 2 * kStep[a] : 0);
    std::array<size_t, 2> along{};
    for (size_t i = 0; i < 2; ++i) {
      const size_t d = in_plane[i];
      along[i] = (face.finer && half_[d] ? 1 : 2) * kStep[d];
      if (face.finer && face.smaller.lo(d) != cell_.lo(d)) first += kStep[d];
    }
    const std::array<size_t, 4> round{first, first + along[0], first + along[0] + along[1], first + along[1]};
    for (size_t i = 0; i < 4; ++i) {
      f(round[i]);
      if (!face.finer && half_[in_plane[i % 2]]) g((round[i] + round[(i + 1) % 4]) / 2);
    }
  }
  Index3 point_at(size_t place) const {  // at a place of the cell
    Index3 out;
    size_t rest = place - own_;
    for (size_t d = 0; d < 3; ++d, rest /= 5) out[d] = rest % 5 == 0 ? cell_.lo(d) : rest % 5 == 2 ? cell_.hi(d) : *cell_.half(d);
    return out;
  }
  int64_t number(size_t place) {
    if (known_[place] == kUnknown) known_[place] = points_.number(point_at(place), part_, mesh_.mesh_.box);
    return known_[place];
  }

  static constexpr int64_t kUnknown = -2, kRim = std::numeric_limits<int64_t>::max();
  static constexpr std::array<size_t, 3> kStep{1, 5, 25};
  LeafAt cell_;
  Index3 eight_{};
  uint32_t part_ = ~0U;
  size_t own_ = 0;  // the place of the cell's lower corner
  std::array<bool, 3> half_{};  // the axes on which it has a middle
  std::array<int64_t, 125> known_{};  // numbers, by place
  const RefinedMesh& mesh_;
  NearLeaves near_;
  const LeafBlock& block_;
  NearPoints points_;
  Walls walls_;
};

RefinedMesh::RefinedMesh(const Export& e, const RefinedGrid& refined, const std::vector<bool>& in_mesh, const LinkReader* links, bool drop,
                         const std::function<void(double share)>& progress)
    : e_(e), links_(links), coarsest_(refined.refinement().coarsest), mesh_{e.box, in_mesh}, grid_(refined, mesh_) {
  if (drop) grid_.keep_largest_region([&](double share) { progress(share / 2); });
  grid_.number([&](double share) { progress(drop ? (1 + share) / 2 : share); });
}

// What a block has for the files; without numbers, only as much as has to be counted.
std::vector<PartOut> RefinedMesh::make(const Index3& at, bool numbers) const {
  std::vector<PartOut> out;
  Block block(*this, at);
  const auto most_cells = [&](uint32_t part) { return std::min(block.cells(), static_cast<size_t>(begins_[part + 1] - begins_[part])); };
  const auto reserve = [&](GroupOut& g, uint32_t part) {
    const size_t faces = g.group == kInner ? most_cells(part) * 33 / 10 : 0;
    g.sizes.reserve(faces), g.owner.reserve(faces), g.neighbour.reserve(faces), g.corners.reserve(numbers ? 4 * faces : 0);
  };
  if (numbers)
    block.for_each_point([&](uint32_t part, const Index3& p, int level) {
      PartOut& own = part_in(out, part);
      if (own.points.empty()) own.points.reserve(most_cells(part) * 5 / 4), own.point_level.reserve(most_cells(part) * 5 / 4);
      std::array<double, 3> place{};
      for (int d = 0; d < 3; ++d) {
        const auto axis = static_cast<size_t>(d);
        place[axis] = plane_of(e_, d, p[axis] - mesh_.box.lo[axis]);
      }
      own.points.push_back(place);
      own.point_level.push_back(static_cast<int8_t>(coarsest_ - level));
    });
  block.for_each_cell(
      [&](const LeafAt& leaf, int64_t number, uint32_t part) {
        PartOut& own = part_in(out, part);
        own.cell_level.push_back(static_cast<int8_t>(coarsest_ - leaf.level));
        const auto make_zone = [&] { return std::pair(leaf.material(), std::vector<int32_t>()); };
        entry_of(
            own.zones, [&](const auto& z) { return z.first == leaf.material(); }, make_zone)
            .second.push_back(static_cast<int32_t>(number - begins_[part]));
      },
      [&](int64_t number, uint32_t part, const LeafFace& face, int64_t beyond, uint32_t other) {
        const auto put = [&](uint32_t in, FaceGroup group, int64_t owner) -> GroupOut& {
          GroupOut& g = group_in(part_in(out, in), group);
          if (g.sizes.empty()) reserve(g, in);
          const size_t before = g.corners.size();
          if (!numbers) {
            g.sizes.push_back(static_cast<uint8_t>(block.corners(face)));
            return g;
          }
          if (in == part) block.append(face, g.corners);
          else block.append_reversed(face, in, g.corners);
          g.sizes.push_back(static_cast<uint8_t>(g.corners.size() - before));
          g.owner.push_back(static_cast<int32_t>(owner - begins_[in]));
          return g;
        };
        if (beyond < 0) put(part, block.what(face), number);
        else if (part == other) put(part, kInner, number).neighbour.push_back(static_cast<int32_t>(beyond - begins_[part]));
        else put(part, shared_with(other), number), put(other, shared_with(part), beyond);
      });
  return out;
}

MeshCounts RefinedMesh::count(const PartBegins& begins, const std::function<void(double share)>& progress) {
  begins_ = begins;
  points_.emplace(grid_, begins_);
  points_->number([&](double share) { progress(share / 4); });
  MeshCounts out;
  out.parts.resize(begins.size() - 1);
  const bool keep = cells() <= kMostKept;
  grid_.for_each_block([&](double share) { progress((1 + 3 * share) / 4); }, [&](const Index3& at) { return std::pair(at, make(at, keep)); },
                       [&](std::pair<Index3, std::vector<PartOut>> made) {
                         for (const PartOut& part : made.second) {
                           PartCounts& own = out.parts[part.part];
                           own.cells += static_cast<int64_t>(part.cell_level.size());
                           for (const auto& [material, cells] : part.zones) own.zones[material] += static_cast<int64_t>(cells.size());
                           for (const GroupOut& g : part.groups) {
                             const auto faces = static_cast<int64_t>(g.sizes.size());
                             own.faces[g.group] += faces;
                             own.corners[g.group] += std::accumulate(g.sizes.begin(), g.sizes.end(), int64_t{0});
                             if (g.group == kInner) out.inner += faces;
                             else if (g.group < kShared) out.patches[static_cast<uint32_t>(g.group)] += faces;
                           }
                         }
                         if (keep) kept_[made.first] = std::move(made.second);
                       });
  out.cells = cells();
  for (uint32_t part = 0; part < out.parts.size(); ++part) {
    out.parts[part].points = points_->points(part);
    out.parts[part].corners.try_emplace(kInner, 0), out.parts[part].faces.try_emplace(kInner, 0);
  }
  return out;
}

void RefinedMesh::write(const MeshCounts& counts, const MeshNames& names, const MeshOutput& output,
                        const std::function<void(double share)>& progress) {
  Streams streams;
  std::vector<std::unique_ptr<MeshFiles>> files;
  for (uint32_t part = 0; part < counts.parts.size(); ++part)
    files.push_back(std::make_unique<MeshFiles>(output.folder(part), part, counts.parts[part], names, streams));
  grid_.for_each_block(
      progress,
      [&](const Index3& at) {
        const auto it = kept_.find(at);
        return it != kept_.end() ? std::move(it->second) : make(at, true);
      },
      [&](const std::vector<PartOut>& out) {
        for (const PartOut& part : out) {
          MeshFiles& own = *files[part.part];
          for (std::array<double, 3> point : part.points) {
            for (double& x : point) x *= output.scale;
            own.points->put(point);
          }
          for (const int8_t level : part.point_level) own.point_level->put(int32_t{level});
          for (const int8_t level : part.cell_level) own.cell_level->put(int32_t{level});
          for (const auto& [material, cells] : part.zones)
            if (!names.zones.empty()) own.zone(material).put_all(cells);
          for (const GroupOut& g : part.groups) {
            MeshFiles::Group& group = own.group(g.group);
            group.faces.put_all(g.corners), group.owner.put_all(g.owner);
            if (!g.neighbour.empty()) own.neighbour->put_all(g.neighbour);
            for (const uint8_t size : g.sizes) group.begins->put(static_cast<int32_t>(std::exchange(group.corners, group.corners + size)));
          }
        }
      });
  for (const auto& part : files) part->close();
}

}  // namespace teracell::exports::foam

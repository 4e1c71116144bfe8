#include "tools/export/openfoam/refined_mesh.hpp"

#include <algorithm>

#include "tools/export/openfoam/leaf_faces.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports::foam {
namespace {

// What a block has for one group of faces of one part.
struct GroupOut {
  FaceGroup group;
  std::vector<int32_t> corners, owner, neighbour;
  std::vector<uint8_t> sizes;  // corners of each face
};
struct PartOut {
  uint32_t part;
  std::vector<std::array<double, 3>> points;
  std::vector<int32_t> point_level, cell_level;
  std::vector<std::pair<uint32_t, std::vector<int32_t>>> zones;  // by material: cells
  std::vector<GroupOut> groups;
};

template <class List, class Key, class Make>
auto& entry_of(List& list, const Key& key, Make&& make) {
  for (auto& entry : list)
    if (key(entry)) return entry;
  return list.emplace_back(make());
}
PartOut& part_in(std::vector<PartOut>& parts, uint32_t part) {
  return entry_of(parts, [&](const PartOut& p) { return p.part == part; }, [&] { return PartOut{part, {}, {}, {}, {}, {}}; });
}
GroupOut& group_in(PartOut& part, FaceGroup group) {
  return entry_of(part.groups, [&](const GroupOut& g) { return g.group == group; }, [&] { return GroupOut{group, {}, {}, {}, {}}; });
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
      : mesh_(mesh), block_(mesh.grid_.block(at)), near_(mesh.grid_, at), points_(*mesh.points_, near_), walls_(mesh.links_, around(at)) {}

  // face(cell, part, LeafFace, number of the cell beyond, or negative, and its part): sorted by the number of the cell beyond, those at the rim last.
  template <class Cell, class Face>
  void for_each_cell(Cell&& cell, Face&& face) {
    std::vector<std::pair<int64_t, LeafFace>> owned;
    for (uint32_t i = 0; i < block_->size(); ++i) {
      const LeafAt leaf = near_.leaf(*block_, i);
      if (!leaf.in_mesh()) continue;
      const int64_t number = leaf.number();
      const uint32_t part = part_of(mesh_.begins_, number);
      cell(leaf, number, part);
      owned.clear();
      for_each_face(near_, leaf, [&](const LeafFace& f) {
        if (!f.beyond || !f.beyond.in_mesh()) owned.emplace_back(std::numeric_limits<int64_t>::max(), f);
        else if (f.beyond.number() > number) owned.emplace_back(f.beyond.number(), f);
      });
      std::ranges::stable_sort(owned, {}, &std::pair<int64_t, LeafFace>::first);
      for (const auto& [beyond, f] : owned) {
        const bool rim = beyond == std::numeric_limits<int64_t>::max();
        face(number, part, f, rim ? -1 : beyond, rim ? part : part_of(mesh_.begins_, beyond));
      }
    }
  }

  int64_t corners(const LeafFace& face, uint32_t part) {
    int64_t n = 4;
    for_each_corner(face, [](const Index3&) {}, [&](const Index3& p) { n += points_.number(p, part, mesh_.mesh_.box) >= 0; });
    return n;
  }
  std::vector<int32_t> numbers(const LeafFace& face, uint32_t part) {
    std::vector<int32_t> out;
    for_each_corner(
        face, [&](const Index3& p) { out.push_back(static_cast<int32_t>(points_.number(p, part, mesh_.mesh_.box))); },
        [&](const Index3& p) {
          const int64_t number = points_.number(p, part, mesh_.mesh_.box);
          if (number >= 0) out.push_back(static_cast<int32_t>(number));
        });
    return out;
  }
  uint32_t what(const LeafFace& face) { return walls_.what(face); }

  // point(part, point, level of the coarsest cell that has it as a corner)
  template <class Point>
  void for_each_point(Point&& point) {
    const auto owned = mesh_.points_->block(block_->at);
    for (uint32_t i = 0; i < block_->size(); ++i) {
      if (owned->begin[i] == owned->begin[i + 1]) continue;
      const LeafAt leaf = near_.leaf(*block_, i);
      for (uint32_t e = owned->begin[i]; e < owned->begin[i + 1]; ++e)
        for (uint32_t number = 0; number < 27; ++number) {
          if ((owned->entries[e].points >> number & 1) == 0) continue;
          const Index3 p = LeafPoints::place(leaf, number);
          point(owned->entries[e].part, p, coarsest_at(p));
        }
    }
  }

 private:
  Box around(const Index3& at) const {
    Box out;
    for (size_t d = 0; d < 3; ++d) out.lo[d] = (at[d] << LeafBlock::kBits) - 1, out.hi[d] = ((at[d] + 1) << LeafBlock::kBits) + 1;
    for (uint32_t i = 0; i < block_->size(); ++i)  // a larger leaf reaches beyond its block
      if (block_->level[i] > LeafBlock::kBits)
        for (size_t d = 0; d < 3; ++d) out.hi[d] = out.lo[d] + 2 + (int64_t{1} << block_->level[i]);
    return out;
  }
  int coarsest_at(const Index3& p) {
    int of_mesh = -1, of_any = 0;
    for (const LeafAt& leaf : near_.around(p)) {
      if (!leaf || !leaf.has_corner(p)) continue;
      of_any = std::max(of_any, leaf.level);
      if (leaf.in_mesh()) of_mesh = std::max(of_mesh, leaf.level);
    }
    return of_mesh >= 0 ? of_mesh : of_any;
  }

  const RefinedMesh& mesh_;
  const std::shared_ptr<const LeafBlock> block_;
  NearLeaves near_;
  NearPoints points_;
  Walls walls_;
};

RefinedMesh::RefinedMesh(const Export& e, const RefinedGrid& refined, const std::vector<bool>& in_mesh, const LinkReader* links,
                         const std::function<void(double share)>& progress)
    : e_(e), links_(links), mesh_{e.box, in_mesh}, grid_(refined, mesh_) {
  grid_.number(progress, [](const LeafBlock&) {});
}

MeshCounts RefinedMesh::count(const PartBegins& begins, const std::function<void(double share)>& progress) {
  begins_ = begins;
  points_.emplace(grid_, begins_);
  points_->number([&](double share) { progress(share / 2); });
  const size_t parts = begins.size() - 1;
  using Counts = std::vector<std::pair<uint32_t, PartCounts>>;
  MeshCounts out;
  out.parts.resize(parts);
  grid_.for_each_block(
      [&](double share) { progress((1 + share) / 2); },
      [&](const Index3& at) {
        Counts counts;
        const auto of = [&](uint32_t part) -> PartCounts& {
          return entry_of(counts, [&](const auto& c) { return c.first == part; }, [&] { return std::pair(part, PartCounts{}); }).second;
        };
        Block block(*this, at);
        // The maps are asked once for many faces in a row that are alike.
        uint32_t last_part = ~0U;
        FaceGroup last_group = 0;
        int64_t *faces = nullptr, *corners = nullptr;
        const auto add = [&](uint32_t part, FaceGroup group, int64_t n) {
          if (part != last_part || group != last_group || faces == nullptr) {
            PartCounts& c = of(part);
            faces = &c.faces[group], corners = &c.corners[group];
            last_part = part, last_group = group;
          }
          ++*faces, *corners += n;
        };
        block.for_each_cell(
            [&](const LeafAt& leaf, int64_t, uint32_t part) {
              PartCounts& c = of(part);
              ++c.cells, ++c.zones[leaf.material()];
              faces = nullptr;
            },
            [&](int64_t, uint32_t part, const LeafFace& face, int64_t beyond, uint32_t other) {
              const int64_t n = block.corners(face, part);
              if (beyond < 0) add(part, block.what(face), n);
              else if (part == other) add(part, kInner, n);
              else add(part, shared_with(other), n), add(other, shared_with(part), n);
            });
        return counts;
      },
      [&](const Counts& counts) {
        for (const auto& [part, c] : counts) {
          PartCounts& own = out.parts[part];
          own.cells += c.cells, out.cells += c.cells;
          for (const auto& [material, cells] : c.zones) own.zones[material] += cells;
          for (const auto& [group, faces] : c.faces) {
            own.faces[group] += faces;
            if (group == kInner) out.inner += faces;
            else if (group < kShared) out.patches[static_cast<uint32_t>(group)] += faces;
          }
          for (const auto& [group, corners] : c.corners) own.corners[group] += corners;
        }
      });
  for (uint32_t part = 0; part < parts; ++part) {
    out.parts[part].points = points_->points(part);
    out.parts[part].corners.try_emplace(kInner, 0), out.parts[part].faces.try_emplace(kInner, 0);
  }
  return out;
}

void RefinedMesh::write(const MeshCounts& counts, const MeshNames& names, const MeshOutput& output,
                        const std::function<void(double share)>& progress) const {
  Streams streams;
  std::vector<std::unique_ptr<MeshFiles>> files;
  for (uint32_t part = 0; part < counts.parts.size(); ++part)
    files.push_back(std::make_unique<MeshFiles>(output.folder(part), part, counts.parts[part], names, streams));
  const int coarsest = grid_.refined().refinement().coarsest;
  grid_.for_each_block(
      progress,
      [&](const Index3& at) {
        std::vector<PartOut> out;
        Block block(*this, at);
        block.for_each_point([&](uint32_t part, const Index3& p, int level) {
          PartOut& own = part_in(out, part);
          std::array<double, 3> place{};
          for (int d = 0; d < 3; ++d) {
            const auto axis = static_cast<size_t>(d);
            place[axis] = plane_of(e_, d, p[axis] - mesh_.box.lo[axis]) * output.scale;
          }
          own.points.push_back(place);
          own.point_level.push_back(coarsest - level);
        });
        block.for_each_cell(
            [&](const LeafAt& leaf, int64_t number, uint32_t part) {
              PartOut& own = part_in(out, part);
              own.cell_level.push_back(coarsest - leaf.level);
              if (names.zones.empty()) return;
              entry_of(own.zones, [&](const auto& z) { return z.first == leaf.material(); }, [&] { return std::pair(leaf.material(), std::vector<int32_t>()); })
                  .second.push_back(static_cast<int32_t>(number - begins_[part]));
            },
            [&](int64_t number, uint32_t part, const LeafFace& face, int64_t beyond, uint32_t other) {
              const auto put = [&](uint32_t in, FaceGroup group, const std::vector<int32_t>& corners, int64_t owner) -> GroupOut& {
                GroupOut& g = group_in(part_in(out, in), group);
                g.corners.insert(g.corners.end(), corners.begin(), corners.end());
                g.sizes.push_back(static_cast<uint8_t>(corners.size()));
                g.owner.push_back(static_cast<int32_t>(owner - begins_[in]));
                return g;
              };
              const std::vector<int32_t> corners = block.numbers(face, part);
              if (beyond < 0) {
                put(part, block.what(face), corners, number);
              } else if (part == other) {
                put(part, kInner, corners, number).neighbour.push_back(static_cast<int32_t>(beyond - begins_[part]));
              } else {
                put(part, shared_with(other), corners, number);
                std::vector<int32_t> reversed = block.numbers(face, other);
                std::reverse(reversed.begin() + 1, reversed.end());  // the first corner stays
                put(other, shared_with(part), reversed, beyond);
              }
            });
        return out;
      },
      [&](const std::vector<PartOut>& out) {
        for (const PartOut& part : out) {
          MeshFiles& own = *files[part.part];
          for (const auto& point : part.points) own.points->put(point);
          for (const int32_t level : part.point_level) own.point_level->put(level);
          for (const int32_t level : part.cell_level) own.cell_level->put(level);
          for (const auto& [material, cells] : part.zones)
            for (const int32_t cell : cells) own.zone(material).put(cell);
          for (const GroupOut& g : part.groups) {
            MeshFiles::Group& group = own.group(g.group);
            for (const int32_t corner : g.corners) group.faces.put(corner);
            for (const int32_t cell : g.owner) group.owner.put(cell);
            for (const int32_t cell : g.neighbour) own.neighbour->put(cell);
            for (const uint8_t size : g.sizes) group.begins->put(static_cast<int32_t>(std::exchange(group.corners, group.corners + size)));
          }
        }
      });
  for (const auto& part : files) part->close();
}

}  // namespace teracell::exports::foam

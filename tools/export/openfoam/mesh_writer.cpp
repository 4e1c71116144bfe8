#include "tools/export/openfoam/mesh_writer.hpp"

#include "tools/export/place.hpp"

namespace teracell::exports::foam {
namespace {

// A corner of a cell: `row` is 0 to 3 for (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1).
struct Corner {
  int row, x;
};
// The corners of the face in each Direction. Seen from the cell they turn clockwise, so the normal points away from it.
constexpr Corner kFace[6][4] = {
    {{0, 1}, {1, 1}, {3, 1}, {2, 1}}, {{1, 0}, {3, 0}, {3, 1}, {1, 1}}, {{2, 0}, {2, 1}, {3, 1}, {3, 0}},
    {{0, 0}, {2, 0}, {3, 0}, {1, 0}}, {{0, 0}, {0, 1}, {2, 1}, {2, 0}}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
};

class Writer : public MeshVisitor {
 public:
  Writer(const Division& division, const MeshCounts& counts, const MeshNames& names, const MeshOutput& output)
      : e_(division.e), begins_(division.part_begin), counts_(counts), names_(names), output_(output), parts_(counts.parts.size()) {
    int64_t start = counts.inner;
    for (const auto& [what, faces] : counts.patches) next_of_patch_[what] = start, start += faces;
  }

  void points(const PointRun& run, int64_t y, int64_t z, int64_t number) override {
    MeshFiles& files = part(run.part).files;
    std::array<double, 3> point{0, coordinate(1, y), coordinate(2, z)};
    for (int64_t x = run.begin; x <= run.end; ++x) {
      point[0] = coordinate(0, x);
      files.points->put(point);
      if (files.point_address) files.point_address->put(static_cast<int32_t>(number + (x - run.begin)));
    }
  }

  void segment(const Segment& s) override {
    const uint32_t number = s.run->part;
    Part& own = part(number);
    std::array<Target, 6> targets;
    for (int d = 0; d < 6; ++d)
      if (s.beyond[d] != nullptr) targets[d] = target(s, d);
    const Target within{.files = &own.group(kInner), .neighbour = 1 - s.run->begin + s.run->first - begins_[number]};
    const Corners corners = corners_of(s, number, s.begin, kAllRows);
    const int64_t cell = s.run->first - begins_[number] - s.run->begin;  // plus x
    Stream* const zone = names_.zones.empty() ? nullptr : &own.files.zone(s.run->what);
    for (int64_t x = s.begin; x < s.end; ++x) {
      for (int d = 0; d < 6; ++d) {
        const Target* t = &targets[d];
        if (d == kXUp && (x + 1 < s.end || s.beyond[kXUp] == nullptr)) t = &within;
        if (d == kXDown && x > s.begin) continue;
        if (t->files != nullptr) put_face(own, *t, d, corners, cell + x, x);
      }
      if (zone != nullptr) zone->put(static_cast<int32_t>(cell + x));
      if (own.files.cell_address) own.files.cell_address->put(static_cast<int32_t>(begins_[number] + cell + x));
    }
    own.cells_left -= s.end - s.begin;
    if (own.cells_left > 0) return;
    own.files.close();
    parts_[number].reset();
  }

 private:
  using Corners = std::array<int64_t, 4>;  // by row: the number of the point x, minus x
  static constexpr unsigned kAllRows = 15;
  using Group = MeshFiles::Group;

  struct Part {
    Part(const std::filesystem::path& folder, uint32_t number, const PartCounts& counts, const MeshNames& names, Streams& streams)
        : files(folder, number, counts, names, streams), cells_left(counts.cells) {}
    Group& group(FaceGroup g) { return files.group(g); }
    MeshFiles files;
    int64_t cells_left;
  };

  // Where the faces of a direction go.
  struct Target {
    Group* files = nullptr;     // null: nowhere, because the cell beyond owns them
    int64_t* patch = nullptr;   // the next number of the patch in the whole mesh
    int64_t neighbour = 0;      // else, if not shared: the number of the cell beyond in the same part, minus x
    Group* shared = nullptr;    // of the part that has the cell beyond
    int64_t shared_cell = 0;    // that cell, minus x
    Corners shared_corners{};
  };

  Part& part(uint32_t number) {
    if (!parts_[number]) parts_[number] = std::make_unique<Part>(output_.folder(number), number, counts_.parts[number], names_, streams_);
    return *parts_[number];
  }

  double coordinate(int axis, int64_t plane) const { return plane_of(e_, axis, plane) * output_.scale; }

  static Corners corners_of(const Segment& s, uint32_t part, int64_t x, unsigned rows) {
    Corners out{};
    for (int row = 0; row < 4; ++row)
      if ((rows >> row & 1) != 0) out[row] = s.planes[row / 2].number(part, x, s.y + row % 2) - x;
    return out;
  }

  Target target(const Segment& s, int direction) {
    const CellRun& beyond = *s.beyond[direction];
    Part& own = *parts_[s.run->part];
    if (!beyond.in_mesh()) return {.files = &own.group(s.what[direction]), .patch = &next_of_patch_.at(s.what[direction])};
    if (direction > kZUp) return {};
    const int64_t step = direction == kXUp ? 1 : 0, cell = beyond.number(step) - begins_[beyond.part];
    if (beyond.part == s.run->part) return {.files = &own.group(kInner), .neighbour = cell};
    unsigned rows = 0;
    for (const Corner& c : kFace[direction]) rows |= 1u << c.row;
    return {.files = &own.group(shared_with(beyond.part)),
            .shared = &part(beyond.part).group(shared_with(s.run->part)),
            .shared_cell = cell,
            .shared_corners = corners_of(s, beyond.part, direction == kXUp ? s.end : s.begin, rows)};
  }

  void put_face(Part& own, const Target& t, int direction, const Corners& corners, int64_t cell, int64_t x) {
    const auto points = [&](const Corners& from) {
      std::array<int32_t, 4> out;
      for (int i = 0; i < 4; ++i) out[i] = static_cast<int32_t>(from[kFace[direction][i].row] + kFace[direction][i].x + x);
      return out;
    };
    t.files->faces.put(points(corners));
    t.files->owner.put(static_cast<int32_t>(cell));
    if (t.patch == nullptr && t.shared == nullptr) own.files.neighbour->put(static_cast<int32_t>(t.neighbour + x));
    if (t.shared != nullptr) {
      const std::array<int32_t, 4> p = points(t.shared_corners);
      t.shared->faces.put(std::array{p[0], p[3], p[2], p[1]});
      t.shared->owner.put(static_cast<int32_t>(t.shared_cell + x));
    }
    if (!t.files->address) return;
    // In the whole mesh counted from 1; negative where the face is reversed.
    const auto face = static_cast<int32_t>((t.patch != nullptr ? (*t.patch)++ : next_inner_++) + 1);
    t.files->address->put(face);
    if (t.shared != nullptr) t.shared->address->put(-face);
  }

  const Export& e_;
  const std::vector<int64_t>& begins_;
  const MeshCounts& counts_;
  const MeshNames& names_;
  const MeshOutput& output_;
  Streams streams_;
  std::vector<std::unique_ptr<Part>> parts_;  // those of which a point was found and not all cells yet
  int64_t next_inner_ = 0;                    // of the whole mesh
  std::map<uint32_t, int64_t> next_of_patch_;
};

}  // namespace

void write_mesh(const Division& division, const MeshCounts& counts, const MeshNames& names, const MeshOutput& output,
                const std::function<void(int64_t layers)>& progress) {
  Writer writer(division, counts, names, output);
  sweep(division, writer, progress);
}

}  // namespace teracell::exports::foam

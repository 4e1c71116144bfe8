#include "tools/export/openfoam/counts.hpp"

namespace teracell::exports::foam {
namespace {

class Counter : public MeshVisitor {
 public:
  explicit Counter(size_t parts) { counts_.parts.resize(parts); }

  void points(const PointRun& run, int64_t, int64_t, int64_t number) override {
    counts_.parts[run.part].points += run.end - run.begin + 1;
    counts_.points = std::max(counts_.points, number + run.end - run.begin + 1);
  }

  void segment(const Segment& s) override {
    const int64_t cells = s.end - s.begin;
    PartCounts& own = counts_.parts[s.run->part];
    own.cells += cells;
    own.zones[s.run->what] += cells;
    counts_.cells += cells;
    const int64_t along = cells - (s.beyond[kXUp] == nullptr ? 0 : 1);  // faces within the run
    own.faces[kInner] += along;
    counts_.inner += along;
    for (int d = 0; d < 6; ++d)
      if (s.beyond[d] != nullptr) beyond(s, d, d % 3 == kXUp ? 1 : cells);
  }

  MeshCounts take() { return std::move(counts_); }

 private:
  void beyond(const Segment& s, int direction, int64_t faces) {
    const CellRun& run = *s.beyond[direction];
    const uint32_t part = s.run->part;
    PartCounts& own = counts_.parts[part];
    if (!run.in_mesh()) {
      own.faces[s.what[direction]] += faces;
      counts_.patches[s.what[direction]] += faces;
    } else if (direction <= kZUp) {  // else the other cell's
      own.faces[run.part == part ? kInner : shared_with(run.part)] += faces;
      if (run.part != part) counts_.parts[run.part].faces[shared_with(part)] += faces;
      counts_.inner += faces;
    }
  }

  MeshCounts counts_;
};

}  // namespace

int64_t PartCounts::all_faces() const {
  int64_t sum = 0;
  for (const auto& [group, count] : faces) sum += count;
  return sum;
}

int64_t PartCounts::corners_of(FaceGroup group) const {
  if (corners.empty()) return 4 * faces.at(group);
  return corners.at(group);
}

int64_t PartCounts::all_corners() const {
  int64_t sum = 0;
  for (const auto& [group, count] : faces) sum += corners_of(group);
  return sum;
}

int64_t MeshCounts::all_faces() const {
  int64_t sum = inner;
  for (const auto& [what, count] : patches) sum += count;
  return sum;
}

MeshCounts count(const Division& division, const std::function<void(int64_t layers)>& progress) {
  Counter counter(division.part_begin.size() - 1);
  sweep(division, counter, progress);
  return counter.take();
}

}  // namespace teracell::exports::foam

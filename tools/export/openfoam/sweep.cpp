#include "tools/export/openfoam/sweep.hpp"

#include <algorithm>
#include <optional>
#include <tuple>

#include "tools/export/openfoam/face_patches.hpp"

namespace teracell::exports::foam {
namespace {

// Layers whose cells are numbered and divided into parts.
class NumberedLayers {
 public:
  explicit NumberedLayers(const Division& d) : d_(d), reader_(d.e, d.in_mesh) {
    if (d.regions != nullptr) d.regions->restart();
  }
  void read(int64_t z, Layer& out) {
    reader_.read(z, raw_);
    if (d_.regions != nullptr) d_.regions->keep(raw_);
    out.clear();
    for (size_t y = 0; y + 1 < raw_.rows.size(); ++y) {
      for (CellRun run : raw_.row(static_cast<int64_t>(y))) {
        if (!run.in_mesh()) {
          out.runs.push_back(run);
          continue;
        }
        while (run.begin < run.end) {
          while (d_.part_begin[part_ + 1] <= number_) ++part_;
          CellRun piece = run;
          piece.end = run.begin + static_cast<int32_t>(std::min<int64_t>(run.end - run.begin, d_.part_begin[part_ + 1] - number_));
          piece.first = number_, piece.part = part_;
          out.runs.push_back(piece);
          number_ += piece.end - piece.begin;
          run.begin = piece.end;
        }
      }
      out.rows.push_back(out.runs.size());
    }
  }

 private:
  const Division& d_;
  LayerReader reader_;
  Layer raw_;
  int64_t number_ = 0;
  uint32_t part_ = 0;
};

Layer outside(const Index3& n, int side) {
  Layer out;
  for (int64_t y = 0; y < n[1]; ++y) {
    out.runs.push_back({0, static_cast<int32_t>(n[0]), kSides + side});
    out.rows.push_back(out.runs.size());
  }
  return out;
}

// Numbers points plane by plane.
class Points {
 public:
  Points(const Division& d, MeshVisitor& visitor) : rows_(d.e.box.hi[1] - d.e.box.lo[1]), next_(d.part_begin.size() - 1), visitor_(visitor) {}

  void plane(int64_t z, const Layer& below, const Layer& above, PointPlane& out) {
    out.runs.clear(), out.rows.assign(1, 0);
    for (int64_t y = 0; y <= rows_; ++y) {
      touching_.clear();
      for (const Layer* layer : {&below, &above})
        for (const int64_t row : {y - 1, y})
          if (row >= 0 && row < rows_)
            for (const CellRun& run : layer->row(row))
              if (run.in_mesh()) touching_.push_back({run.part, run.begin, run.end, 0});
      std::ranges::sort(touching_, {}, &PointRun::begin);
      whole_.clear();
      merge(touching_, whole_);
      for (PointRun& run : whole_) run.first = all_, all_ += run.end - run.begin + 1;
      std::ranges::stable_sort(touching_, {}, &PointRun::part);
      merge(touching_, out.runs, out.rows.back());
      const PointRun* whole = whole_.data();
      for (size_t i = out.rows.back(); i < out.runs.size(); ++i) {
        PointRun& run = out.runs[i];
        run.first = next_[run.part], next_[run.part] += run.end - run.begin + 1;
        if (i > out.rows.back() && run.part != out.runs[i - 1].part) whole = whole_.data();
        while (whole->end < run.begin) ++whole;
        visitor_.points(run, y, z, whole->first + (run.begin - whole->begin));
      }
      out.rows.push_back(out.runs.size());
    }
  }

 private:
  // Appends the union of runs that are sorted by part (or are all taken for those of one part) and begin.
  static void merge(const std::vector<PointRun>& from, std::vector<PointRun>& to, size_t row_begin) {
    for (const PointRun& run : from)
      if (to.size() > row_begin && to.back().part == run.part && run.begin <= to.back().end) to.back().end = std::max(to.back().end, run.end);
      else to.push_back(run);
  }
  static void merge(const std::vector<PointRun>& from, std::vector<PointRun>& to) {
    for (PointRun run : from) {
      run.part = 0;
      if (!to.empty() && run.begin <= to.back().end) to.back().end = std::max(to.back().end, run.end);
      else to.push_back(run);
    }
  }

  const int64_t rows_;
  int64_t all_ = 0;            // points of all parts together so far
  std::vector<int64_t> next_;  // those of each part
  MeshVisitor& visitor_;
  std::vector<PointRun> touching_, whole_;
};

// Walks along a row in step with another one.
class Beside {
 public:
  explicit Beside(std::span<const CellRun> row) : at_(row.data()) {}
  const CellRun& over(int64_t x) {
    while (at_->end <= x) ++at_;
    return *at_;
  }

 private:
  const CellRun* at_;
};

// The patches on the faces of a row, by Direction. Those across x, in both directions, are one row of faces: kXUp.
using PatchesBeside = std::array<AlongPatches, 6>;

void visit_row(std::span<const CellRun> row, const CellRun& left, const CellRun& right, std::array<Beside, 4> beside, PatchesBeside patches,
               Segment s, MeshVisitor& visitor) {
  // The patch of a wall, and where another one follows. What is no wall of another material has none.
  const auto find_patch = [&](Direction d, int64_t x) {
    s.what[d] = s.beyond[d]->what;
    if (s.beyond[d]->in_mesh() || s.what[d] >= kSides) return std::numeric_limits<int64_t>::max();
    const AlongPatches::Found found = patches[d == kXDown ? kXUp : d].at(d == kXDown ? x - 1 : x);
    if (found.patch != kNoPatch) s.what[d] = kSurface + found.patch;
    return found.end;
  };
  for (size_t i = 0; i < row.size(); ++i) {
    s.run = &row[i];
    if (!s.run->in_mesh()) continue;
    for (int64_t x = s.run->begin; x < s.run->end; x = s.end) {
      s.begin = x, s.end = s.run->end;
      for (const int b : {0, 1, 2, 3}) {
        const Direction d = std::array{kYUp, kZUp, kYDown, kZDown}[b];
        const CellRun& other = beside[b].over(x);
        s.beyond[d] = &other;
        s.end = std::min({s.end, int64_t{other.end}, find_patch(d, x)});
      }
      s.beyond[kXDown] = x > s.run->begin ? nullptr : i > 0 ? &row[i - 1] : &left;
      s.beyond[kXUp] = s.end < s.run->end ? nullptr : i + 1 < row.size() ? &row[i + 1] : &right;
      if (s.beyond[kXDown] != nullptr) find_patch(kXDown, x);
      if (s.beyond[kXUp] != nullptr) find_patch(kXUp, s.end - 1);
      visitor.segment(s);
    }
  }
}

}  // namespace

int64_t PointPlane::number(uint32_t part, int64_t x, int64_t y) const {
  const auto row = std::span(runs).subspan(rows[y], rows[y + 1] - rows[y]);
  const auto after = std::ranges::upper_bound(row, std::tuple(part, x), {}, [](const PointRun& r) { return std::tuple(r.part, int64_t{r.begin}); });
  return std::prev(after)->first + (x - std::prev(after)->begin);
}

void sweep(const Division& division, MeshVisitor& visitor, const std::function<void(int64_t layers)>& progress) {
  const Index3 n = size_of(division.e.box);
  NumberedLayers layers(division);
  Points points(division, visitor);
  const auto side = [&](int number) { return CellRun{0, static_cast<int32_t>(n[0]), kSides + number}; };
  const std::array<CellRun, 4> sides = {side(0), side(1), side(2), side(3)};
  Layer below = outside(n, 4), here, above;
  std::array<PointPlane, 2> planes;
  std::optional<FacePatches> patches;
  if (division.links != nullptr) patches.emplace(division.e, *division.links);
  const auto along = [&](int axis, int64_t y, int64_t z) { return AlongPatches(patches ? patches->row(axis, y, z) : std::span<const PatchRun>()); };
  progress(0);
  layers.read(0, here);
  points.plane(0, below, here, planes[1]);
  for (int64_t z = 0; z < n[2]; ++z) {
    std::swap(planes[0], planes[1]);
    if (z + 1 < n[2]) layers.read(z + 1, above);
    else above = outside(n, 5);
    points.plane(z + 1, here, above, planes[1]);
    if (patches) patches->read(z);
    for (int64_t y = 0; y < n[1]; ++y) {
      const Beside up_y(y + 1 < n[1] ? here.row(y + 1) : std::span(&sides[3], 1)), down_y(y > 0 ? here.row(y - 1) : std::span(&sides[2], 1));
      visit_row(here.row(y), sides[0], sides[1], {up_y, Beside(above.row(y)), down_y, Beside(below.row(y))},
                {along(0, y, z), along(1, y, z), along(2, y, z), AlongPatches({}), along(1, y - 1, z), along(2, y, z - 1)},
                {0, 0, y, z, nullptr, {}, {}, planes.data()}, visitor);
    }
    std::swap(below, here);
    std::swap(here, above);
    progress(z + 1);
  }
}

}  // namespace teracell::exports::foam

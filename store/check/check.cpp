#include "store/check/check.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/check/cells.hpp"
#include "store/check/reported.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

class Sentences {
 public:
  Sentences(const GridReader& reader, const CheckOptions& options, Findings& out)
      : meta_(reader.meta()), options_(options), frame_(meta_.frame()), out_(out) {}

  void add(const CellFacts& facts, const std::vector<bool>& sheets) {
    for (const Component& c : facts.thin.sorted())
      of_cells(FindingKind::thin, c.thinnest < 4 ? FindingLevel::warning : FindingLevel::note, c,
               fmt::format("A wall of '{}' is {} thick where it is thinnest: {} are below {:g}.", name(c.label), thick(c.thinnest), cells_of(c),
                           options_.thin_cells));
    for (const Component& c : facts.narrow.sorted())
      of_cells(FindingKind::narrow, c.thinnest < 4 ? FindingLevel::warning : FindingLevel::note, c,
               fmt::format("A gap of '{}' is {} wide where it is narrowest: {} are below {:g}.", name(0), thick(c.thinnest), cells_of(c),
                           options_.narrow_cells));
    for (const Component& c : facts.islands.sorted())
      of_cells(FindingKind::island, FindingLevel::warning, c,
               fmt::format("{} of '{}' {} connected to the rest of it through no face.", cells_of(c), name(c.label), c.cells == 1 ? "is" : "are"));
    for (const Component& c : facts.enclosed.sorted())
      of_cells(FindingKind::enclosed, FindingLevel::note, c,
               fmt::format("{} of '{}' {} enclosed: no way through faces leads to a side of the domain.", cells_of(c), name(c.label),
                           c.cells == 1 ? "is" : "are"));
    total(FindingKind::thin, facts.thin);
    total(FindingKind::narrow, facts.narrow);
    total(FindingKind::island, facts.islands);
    total(FindingKind::enclosed, facts.enclosed);
    for (Label label = 1; label < facts.labels.size(); ++label) {
      const LabelFacts& of = facts.labels[label];
      if (meta_.labels[label].material == 0 || of.cells == 0) continue;
      if (of.at_sides.cells > 0)
        of_cells(FindingKind::cut, FindingLevel::note, of.at_sides,
                 fmt::format("'{}' reaches the side of the domain, with {}.", name(label), cells_of(of.at_sides)));
      if (!sheets[label]) wall(label, of);
    }
  }

 private:
  const std::string& name(Label label) const {
    const LabelInfo& l = meta_.labels[label];
    return l.body.empty() ? meta_.materials[l.material].name : l.body;
  }
  static std::string cells_of(const Component& c) { return counted(c.cells, "cell"); }
  Vec3 centre(const std::array<uint32_t, 3>& zyx) const {
    Vec3 out;
    for (size_t d = 0; d < 3; ++d) out[d] = meta_.grid.axis[d].centre(zyx[2 - d]);
    return out;
  }
  Box box_of(const Component& c) const {
    const std::array<int, 3> axes = {frame_.u, frame_.v, frame_.w};
    Box out;
    for (size_t i = 0; i < 3; ++i) out.lo[axes[i]] = c.lo[i], out.hi[axes[i]] = c.hi[i];
    return out;
  }
  void of_cells(FindingKind kind, FindingLevel level, const Component& c, std::string text) {
    add_finding(out_, {kind, level, {name(c.label)}, c.cells, centre(c.first), box_of(c), std::move(text)});
  }
  static std::string thick(uint32_t halves) { return fmt::format("{:g} {}", halves / 2., halves == 2 ? "cell" : "cells"); }
  // Of all of them, not only of those that are kept.
  void total(FindingKind kind, const LargestComponents& components) {
    out_.totals[static_cast<size_t>(kind)] = {components.number(), components.cells()};
  }
  void wall(Label label, const LabelFacts& facts) {
    WallReport wall{name(label), std::nullopt, std::nullopt, {}};
    CellCount thick = facts.cells;
    for (size_t i = 0; i < facts.thin.size(); ++i) wall.histogram[i] = facts.thin[i], thick -= facts.thin[i];
    wall.histogram.back() = thick;
    if (facts.thinnest < kThickest) wall.thinnest = facts.thinnest / 2., wall.at = centre(facts.thinnest_at);
    out_.walls.push_back(std::move(wall));
  }

  const Metadata& meta_;
  const CheckOptions& options_;
  const RayFrame frame_;
  Findings& out_;
};

}  // namespace

Findings check(const GridReader& reader, const CheckOptions& options, const std::function<void(double)>& progress) {
  Findings out;
  out.hash = reader.hash();
  out.cells_hash = reader.cells_hash();
  const std::vector<bool> sheets = add_reported(out, reader.report(), reader.meta());
  Sentences(reader, options, out).add(look_at_cells(reader, sheets, options, progress), sheets);
  std::ranges::stable_sort(out.list, {}, [](const Finding& f) { return std::pair(f.level, f.kind); });
  return out;
}

}  // namespace teracell::store

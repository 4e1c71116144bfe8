#include "store/refine/wants.hpp"

#include <algorithm>
#include <set>

namespace teracell::inline store {
namespace {

std::vector<int> by_label(const Metadata& meta, const std::vector<int>& of_materials) {
  std::vector<int> out;
  if (!of_materials.empty())
    for (const LabelInfo& label : meta.labels) out.push_back(of_materials[label.material]);
  return out;
}

}  // namespace

// Sets what wants a level in the marks of this level.
struct Wants::Marker {
  const int64_t pad;
  std::array<Bits*, kCoarsest + 1> of_level{};

  // Cells [from, to) of a row along the rays.
  void row(int64_t u, int64_t v, int64_t from, int64_t to, int level) const {
    if (level > kCoarsest || of_level[static_cast<size_t>(level)] == nullptr) return;
    Bits& bits = *of_level[static_cast<size_t>(level)];
    const int64_t p = level == 0 ? pad : 0, w0 = (from - p) >> 1, w1 = ((to - 1 + p) >> 1) + 1;
    for (int64_t y = (v - p) >> 1; y <= (v + p) >> 1; ++y)
      for (int64_t x = (u - p) >> 1; x <= (u + p) >> 1; ++x) bits.set(x, y, w0, w1);
  }
};

Wants::Wants(const GridReader& reader, const Refinement& refinement)
    : reader_(reader),
      interfaces_(refinement.interfaces),
      of_label_(by_label(reader.meta(), refinement.of_materials)),
      inside_(by_label(reader.meta(), refinement.inside)),
      of_patches_(refinement.of_patches) {
  const RayFrame f = reader.meta().frame();
  std::set<int> levels = {interfaces_};
  for (const std::vector<int>* all : {&of_label_, &inside_, &of_patches_}) levels.insert(all->begin(), all->end());
  for (const auto& [box, level] : refinement.boxes) {
    boxes_.push_back({{{box.lo[f.u], box.lo[f.v], box.lo[f.w]}, {box.hi[f.u], box.hi[f.v], box.hi[f.w]}}, level});
    levels.insert(level);
  }
  for (const int level : levels)
    if (level < refinement.coarsest) levels_.push_back(level);
  if (refinement.knows_patches()) links_ = std::make_unique<LinkReader>(reader);
}

void Wants::mark(const Window& window, int64_t pad, std::vector<Bits>& marks) const {
  Marker marker{pad};
  for (size_t i = 0; i < levels_.size(); ++i) marker.of_level[static_cast<size_t>(levels_[i])] = &marks[i];
  if (links_) mark_links(window, marker);
  else mark_interfaces(window, marker);
  if (!inside_.empty()) mark_inside(window, marker);
  for (const auto& [box, level] : boxes_)
    for (int64_t v = std::max(box.lo[1], window.box().lo[1]); v < std::min(box.hi[1], window.box().hi[1]); ++v)
      for (int64_t u = std::max(box.lo[0], window.box().lo[0]); u < std::min(box.hi[0], window.box().hi[0]); ++u) {
        const int64_t from = std::max(box.lo[2], window.box().lo[2]), to = std::min(box.hi[2], window.box().hi[2]);
        if (from < to) marker.row(u, v, from, to, level);
      }
}

void Wants::mark_interfaces(const Window& window, const Marker& mark) const {
  const Box& box = window.box();
  const int64_t base = window.base();
  const auto from = static_cast<uint32_t>(box.lo[2] - base), to = static_cast<uint32_t>(box.hi[2] - base);
  // Between neighbours across the rays.
  const auto across = [&](const NamedRuns& a, const NamedRuns& b, int64_t u, int64_t v, int64_t du, int64_t dv) {
    if (same_runs(a, b)) return;
    const auto both = [&](uint32_t lo, uint32_t hi, int level) {
      mark.row(u, v, base + lo, base + hi, level);
      mark.row(u + du, v + dv, base + lo, base + hi, level);
    };
    if (of_label_.empty()) {
      for_each_difference(a, b, from, to, [&](uint32_t lo, uint32_t hi, MaterialName) { both(lo, hi, interfaces_); });
      return;
    }
    for_each_stretch(a, b, from, to, [&](uint32_t lo, uint32_t hi, MaterialName in_a, MaterialName in_b) {
      if (in_a == in_b) return;
      const int level = level_of(in_a, in_b);
      both(lo, hi, level == kNoLevel ? interfaces_ : level);
    });
  };
  for (int64_t v = box.lo[1]; v < box.hi[1]; ++v)
    for (int64_t u = box.lo[0]; u < box.hi[0]; ++u) {
      const NamedRuns& ray = window.ray(u, v);
      for (uint32_t i = 0; i < ray.changes; ++i) {
        const int level = level_of(ray.names[i], ray.names[i + 1]);
        mark.row(u, v, base + ray.ends[i] - 1, base + ray.ends[i] + 1, level == kNoLevel ? interfaces_ : level);
      }
      if (u + 1 < box.hi[0]) across(ray, window.ray(u + 1, v), u, v, 1, 0);
      if (v + 1 < box.hi[1]) across(ray, window.ray(u, v + 1), u, v, 0, 1);
    }
}

// The grid has a link wherever the labels of neighbours differ (FORMAT.md 14.1).
void Wants::mark_links(const Window& window, const Marker& mark) const {
  const RayFrame f = reader_.meta().frame();
  const Box& box = window.box();
  for (int axis = 0; axis < 3; ++axis) {
    const Box cells = f.box(box.lo, box.hi);
    links_->for_each(axis, cells, [&](std::span<const CellLink> links) {
      for (const CellLink& link : links) {
        Index3 next = link.cell;
        if (++next[axis] >= cells.hi[axis]) continue;
        const int64_t u = link.cell[f.u], v = link.cell[f.v], w = link.cell[f.w];
        int level = level_of(window.label(u, v, w), window.label(next[f.u], next[f.v], next[f.w]));
        if (link.patch < of_patches_.size()) level = std::min(level, of_patches_[link.patch]);
        if (level == kNoLevel) level = interfaces_;
        mark.row(u, v, w, w + 1, level);
        mark.row(next[f.u], next[f.v], next[f.w], next[f.w] + 1, level);
      }
    });
  }
}

void Wants::mark_inside(const Window& window, const Marker& mark) const {
  const Box& box = window.box();
  for (int64_t v = box.lo[1]; v < box.hi[1]; ++v)
    for (int64_t u = box.lo[0]; u < box.hi[0]; ++u) {
      const NamedRuns& ray = window.ray(u, v);
      int64_t from = box.lo[2];
      for (uint32_t i = 0; i <= ray.changes; ++i) {
        const int64_t to = i < ray.changes ? window.base() + ray.ends[i] : box.hi[2];
        if (inside_[ray.names[i]] != kNoLevel) mark.row(u, v, from, to, inside_[ray.names[i]]);
        from = to;
      }
    }
}

bool Wants::nothing(const Box& box, Label label) const {
  if (!inside_.empty() && inside_[label] != kNoLevel) return false;
  return std::ranges::none_of(boxes_, [&](const Refinement::Region& r) { return overlap(r.box, box); });
}

}  // namespace teracell::store

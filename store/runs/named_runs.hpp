// Runs of materials that two grids call by the same numbers, whatever the labels of each: what is compared with what.
#pragma once
#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "store/runs/run.hpp"

namespace teracell::inline store {

using MaterialName = uint32_t;  // a number that stands for the name of a material in both grids

// The runs along a ray: names[i] up to the cell first + ends[i], names[changes] up to the end of the ray.
struct NamedRuns {
  const MaterialName* names = nullptr;
  const uint32_t* ends = nullptr;
  uint32_t changes = 0, first = 0;

  uint32_t end(uint32_t i) const { return ends[i] + first; }
  // The run that holds a cell. REQUIRES: cell >= first.
  uint32_t run_at(uint32_t cell) const { return store::run_at({ends, changes}, cell - first); }
};

// There are usually so few runs that a call of memcmp would cost more.
inline bool same_names(const NamedRuns& a, const NamedRuns& b) {
  if (a.changes != b.changes) return false;
  if (a.names != b.names)
    for (uint32_t i = 0; i <= a.changes; ++i)
      if (a.names[i] != b.names[i]) return false;
  return true;
}
inline bool same_runs(const NamedRuns& a, const NamedRuns& b) {
  if (a.first != b.first || !same_names(a, b)) return false;
  for (uint32_t i = 0; i < a.changes; ++i)
    if (a.ends[i] != b.ends[i]) return false;
  return true;
}

// Calls f(from, to, a's name, b's name) for the stretches of the cells [from, to) along which neither changes. REQUIRES: both have them.
template <class F>
void for_each_stretch(const NamedRuns& a, const NamedRuns& b, uint32_t from, uint32_t to, F&& f) {
  uint32_t i = a.run_at(from), j = b.run_at(from);
  while (from < to) {
    const uint32_t end_a = i < a.changes ? a.end(i) : to, end_b = j < b.changes ? b.end(j) : to, end = std::min({end_a, end_b, to});
    f(from, end, a.names[i], b.names[j]);
    i += end_a == end, j += end_b == end;
    from = end;
  }
}

// Calls f(from, to, b's name) for the stretches of the cells [from, to) that have another name in b. Where both have the same names, which
// is so of most neighbours, each stretch lies between the ends of a run in a and in b: there is no need to look for it.
template <class F>
void for_each_difference(const NamedRuns& a, const NamedRuns& b, uint32_t from, uint32_t to, F&& f) {
  if (a.first == b.first && same_names(a, b)) {
    const auto move = [&](uint32_t i) { return std::pair(std::min(a.ends[i], b.ends[i]) + a.first, std::max(a.ends[i], b.ends[i]) + a.first); };
    uint32_t i = 0;
    for (; i < a.changes; ++i) {
      const auto [lo, hi] = move(i);
      if (lo == hi) continue;
      if (i + 1 < a.changes && hi > move(i + 1).first) break;
      const uint32_t lowest = std::max(lo, from), highest = std::min(hi, to);
      if (lowest < highest && a.names[i] != a.names[i + 1]) f(lowest, highest, b.names[b.end(i) == lo ? i + 1 : i]);
    }
    if (i == a.changes) return;
    from = std::max(from, move(i).first);
  }
  for_each_stretch(a, b, from, to, [&](uint32_t lo, uint32_t hi, MaterialName in_a, MaterialName in_b) {
    if (in_a != in_b) f(lo, hi, in_b);
  });
}

// A chunk of level 0 with names in place of labels. Keeps its memory from chunk to chunk.
class NamedChunk {
 public:
  // The rays begin at cell `first` of the grid.
  void set(std::shared_ptr<const Chunk> chunk, std::span<const MaterialName> name_of_label, uint32_t first) {
    chunk_ = std::move(chunk);
    first_ = first;
    names_.clear();
    begin_.clear();
    const PatternTable& patterns = chunk_->rays.patterns;
    for (uint32_t p = 0; p < patterns.size(); ++p) {
      begin_.push_back(names_.size());
      for (const SetId label : patterns.sets(p)) names_.push_back(name_of_label[label]);
    }
  }
  const RayBlock& rays() const { return chunk_->rays; }
  NamedRuns ray(uint32_t ray) const {
    const RayBlock& b = chunk_->rays;
    return {names_.data() + begin_[b.pattern[ray]], b.at.data() + b.begin[ray], b.begin[ray + 1] - b.begin[ray], first_};
  }
  // Brings the changes of a ray closer, if there is such a ray.
  void prefetch(uint32_t ray) const {
    const RayBlock& b = chunk_->rays;
    if (ray < b.rays()) __builtin_prefetch(b.at.data() + b.begin[ray]);
  }
  size_t memory() const { return sizeof *this + chunk_->memory() + names_.capacity() * sizeof names_[0] + begin_.capacity() * sizeof begin_[0]; }

 private:
  std::shared_ptr<const Chunk> chunk_;
  uint32_t first_ = 0;
  std::vector<MaterialName> names_;
  std::vector<size_t> begin_;  // of each pattern in names_
};

}  // namespace teracell::store

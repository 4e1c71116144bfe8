#include "tools/export/openfoam/regions.hpp"

#include <algorithm>

namespace teracell::exports::foam {

uint32_t Regions::root(uint32_t label) {
  while (tree_[label] >= 0) {
    const auto parent = static_cast<uint32_t>(tree_[label]);
    if (tree_[parent] >= 0) tree_[label] = tree_[parent];
    label = parent;
  }
  return label;
}

void Regions::join(uint32_t& label, uint32_t other, bool learn) {
  if (label == kNone) label = other;
  if (!learn) return;
  const uint32_t a = root(label), b = root(other);
  if (a == b) return;
  const uint32_t low = std::min(a, b), high = std::max(a, b);  // a root is the first label of its region
  tree_[low] += tree_[high];
  tree_[high] = low;
}

void Regions::touch(std::span<const Piece> row, size_t& at, const CellRun& run, uint32_t& label, bool learn) {
  while (at < row.size() && row[at].end <= run.begin) ++at;
  for (size_t i = at; i < row.size() && row[i].begin < run.end; ++i) join(label, row[i].label, learn);
}

void Regions::go_through(const Layer& layer, bool learn) {
  std::swap(before_, here_);
  here_.all.clear(), here_.rows.assign(1, 0);
  for (size_t y = 0; y + 1 < layer.rows.size(); ++y) {
    const auto row_of = [](const Pieces& p, size_t row) { return std::span(p.all).subspan(p.rows[row], p.rows[row + 1] - p.rows[row]); };
    const size_t row_begin = here_.all.size();
    size_t at_below = 0, at_before = 0;
    for (const CellRun& run : layer.row(static_cast<int64_t>(y))) {
      if (!run.in_mesh()) continue;
      uint32_t label = kNone;
      if (here_.all.size() > row_begin && here_.all.back().end == run.begin) join(label, here_.all.back().label, learn);
      if (y > 0) touch(row_of(here_, y - 1), at_below, run, label, learn);
      if (before_.rows.size() > 1) touch(row_of(before_, y), at_before, run, label, learn);
      const bool begins = label == kNone;
      if (begins) label = labels_++;
      if (learn && begins) tree_.push_back(run.begin - run.end);
      else if (learn) tree_[root(label)] -= run.end - run.begin;
      here_.all.push_back({run.begin, run.end, label});
    }
    here_.rows.push_back(here_.all.size());
  }
}

void Regions::add(const Layer& layer) { go_through(layer, true); }

void Regions::restart() {
  before_ = here_ = {};
  labels_ = 0;
}

void Regions::finish() {
  for (uint32_t i = 0; i < tree_.size(); ++i)
    if (tree_[i] < 0 && (kept_ == kNone || tree_[i] < tree_[kept_])) kept_ = i;
}

void Regions::keep(Layer& layer) {
  go_through(layer, false);
  size_t i = 0;
  for (CellRun& run : layer.runs)
    if (run.in_mesh() && root(here_.all[i++].label) != kept_) run.first = -1;
}

}  // namespace teracell::exports::foam

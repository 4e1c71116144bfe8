#include "store/runs/turned_runs.hpp"

#include <numeric>

namespace teracell::inline store {
namespace {

constexpr uint32_t kRowsAhead = 8;

}  // namespace

uint32_t RowSweep::turn(const Rows& rows, uint32_t b0, uint32_t b1, uint32_t w0, uint32_t w1, size_t most, TurnedPlane& out) {
  changes_.clear();
  out.begin_.assign(size_t{b1 - b0} + 1, 0);
  std::vector<MaterialName> first(b1 - b0);
  std::vector<RowStretch> chunks(rows.ends.size());
  last_.resize(rows.ends.size());
  uint32_t end = w1;
  for (uint32_t w = w0; w < w1; ++w) {
    const uint32_t row = w % rows.chunk_rows;
    for (size_t s = 0; s < chunks.size(); ++s) {
      if (w == w0 || row == 0) chunks[s] = rows.chunk(s, w);
      const uint32_t ray = chunks[s].ray0 + row * chunks[s].step;
      chunks[s].chunk->prefetch(ray + kRowsAhead * chunks[s].step);  // the next rows of the plane may lie far apart in memory
      const NamedRuns now = chunks[s].chunk->ray(ray);
      const uint32_t from = std::max(b0, s == 0 ? 0 : rows.ends[s - 1]), to = std::min(b1, rows.ends[s]);
      if (w == w0) {
        for_each_stretch(now, now, from, to, [&](uint32_t lo, uint32_t hi, MaterialName name, MaterialName) {
          std::fill(first.begin() + (lo - b0), first.begin() + (hi - b0), name);
        });
      } else {
        for_each_difference(last_[s], now, from, to, [&](uint32_t lo, uint32_t hi, MaterialName name) {
          for (uint32_t b = lo; b < hi; ++b) {
            changes_.push_back({b - b0, w, name});
            ++out.begin_[b - b0 + 1];
          }
        });
      }
      last_[s] = now;
    }
    if (changes_.size() > most && w + 1 < w1) {
      end = w + 1;
      break;
    }
  }
  // Sorted by column: changes of a column came in the order of the rows. begin_[i] moves to the end of column i on the way.
  std::partial_sum(out.begin_.begin(), out.begin_.end(), out.begin_.begin());
  out.ends_.resize(changes_.size());
  out.names_.resize(changes_.size() + first.size());
  for (uint32_t i = 0; i < first.size(); ++i) out.names_[out.begin_[i] + i] = first[i];
  for (const Change& c : changes_) {
    const uint32_t place = out.begin_[c.column]++;
    out.ends_[place] = c.row;
    out.names_[place + c.column + 1] = c.name;
  }
  for (size_t i = first.size(); i > 0; --i) out.begin_[i] = out.begin_[i - 1];
  out.begin_[0] = 0;
  return end;
}

}  // namespace teracell::store

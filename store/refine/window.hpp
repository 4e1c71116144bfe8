// The rays of a box of level-0 cells, whichever chunks they lie in: each as the runs that meet the box.
#pragma once
#include <deque>
#include <memory>

#include "store/read/kept_chunks.hpp"
#include "store/runs/named_runs.hpp"

namespace teracell::inline store {

class Window {
 public:
  // By u, v, w of the rays' frame; cut to the grid. REQUIRES: it meets the grid. Threads may share reader and keeper.
  Window(const GridReader& reader, KeptChunks& kept, const Box& box);

  const Box& box() const { return box_; }
  // Places along it are those of the grid, less base(): NamedRuns::first is 0. The names are labels.
  const NamedRuns& ray(int64_t u, int64_t v) const {
    return rays_[static_cast<size_t>((v - box_.lo[1]) * (box_.hi[0] - box_.lo[0]) + (u - box_.lo[0]))];
  }
  int64_t base() const { return base_; }
  Label label(int64_t u, int64_t v, int64_t w) const {
    const NamedRuns& r = ray(u, v);
    return r.names[r.run_at(static_cast<uint32_t>(w - base_))];
  }
  // Without the chunks, which others may have, too.
  size_t memory() const {
    size_t sum = sizeof *this + rays_.capacity() * sizeof rays_[0];
    for (const auto& names : joined_names_) sum += names.capacity() * sizeof(Label);
    for (const auto& ends : joined_ends_) sum += ends.capacity() * sizeof(uint32_t);
    return sum;
  }

 private:
  Box box_;
  int64_t base_ = 0;
  std::vector<NamedRuns> rays_;
  std::vector<std::shared_ptr<const Chunk>> chunks_;  // what rays point to
  std::deque<Label> labels_;                          // of chunks that have one label
  std::vector<std::vector<Label>> joined_names_;      // of rays that pass from one chunk to the next
  std::vector<std::vector<uint32_t>> joined_ends_;
};

}  // namespace teracell::store

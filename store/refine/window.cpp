#include "store/refine/window.hpp"

#include <algorithm>

#include "store/runs/chunk_parts.hpp"

namespace teracell::inline store {

Window::Window(const GridReader& reader, KeptChunks& kept, const Box& box) : box_(box) {
  const LevelShape shape = reader.shape(0);
  const Index3 n{shape.nu, shape.nv, shape.nw};
  for (size_t d = 0; d < 3; ++d) box_.lo[d] = std::max<int64_t>(box.lo[d], 0), box_.hi[d] = std::min(box.hi[d], n[d]);
  const RayFrame frame = reader.meta().frame();
  const int64_t width = box_.hi[0] - box_.lo[0];
  rays_.resize(static_cast<size_t>(width * (box_.hi[1] - box_.lo[1])));
  const bool one_segment = box_.lo[2] / shape.chunk_cells == (box_.hi[2] - 1) / shape.chunk_cells;
  base_ = one_segment ? box_.lo[2] / shape.chunk_cells * shape.chunk_cells : box_.lo[2];
  if (!one_segment) joined_names_.resize(rays_.size()), joined_ends_.resize(rays_.size());
  const auto place = [&](const ChunkPart& p, uint32_t u, uint32_t v) {
    return static_cast<size_t>((p.first_v + v - box_.lo[1]) * width + (p.first_u + u - box_.lo[0]));
  };
  // Parts along the same rays come in their order.
  for_each_part(shape, RayBox(frame.box(box_.lo, box_.hi), frame), [&](const ChunkPart& p) {
    const auto same = reader.uniform(p.key);
    const Label* label = nullptr;
    const Chunk* chunk = nullptr;
    if (same) {
      label = &labels_.emplace_back(same->front());
    } else {
      chunks_.push_back(kept.get(p.key, [&] {
        auto out = std::make_shared<Chunk>();
        reader.read(p.key, *out);
        return out;
      }));
      chunk = chunks_.back().get();
    }
    for_each_ray(p, [&](uint32_t u, uint32_t v) {
      const size_t at = place(p, u, v);
      if (one_segment && label) {
        rays_[at] = {label, nullptr, 0, 0};
      } else if (one_segment) {
        const uint32_t ray = v * chunk->rays.nu + u;
        const std::span<const uint32_t> changes = chunk->rays.changes(ray);
        const uint32_t first = run_at(changes, p.w0), last = run_at(changes, p.w1 - 1);
        rays_[at] = {chunk->rays.sets(ray).data() + first, changes.data() + first, last - first, 0};
      } else {
        std::vector<Label>& names = joined_names_[at];
        std::vector<uint32_t>& ends = joined_ends_[at];
        const auto add = [&](uint32_t from, Label name) {
          if (!names.empty() && names.back() == name) return;
          if (!names.empty()) ends.push_back(static_cast<uint32_t>(p.first_w + from - base_));
          names.push_back(name);
        };
        if (label) add(p.w0, *label);
        else chunk->rays.for_each_run(v * chunk->rays.nu + u, p.w0, p.w1, [&](uint32_t from, uint32_t, SetId set) { add(from, set); });
      }
    });
  });
  if (one_segment) return;
  for (size_t i = 0; i < rays_.size(); ++i)
    rays_[i] = {joined_names_[i].data(), joined_ends_[i].data(), static_cast<uint32_t>(joined_ends_[i].size()), 0};
}

}  // namespace teracell::store

#include "store/check/field.hpp"

#include <algorithm>

namespace teracell::inline store {
namespace {

// A chunk, or the label of all its cells. `renumbered`: some of its labels are others here.
struct Cells {
  std::shared_ptr<const Chunk> chunk;
  Label label = 0;
  bool renumbered = false;
};

// Chunks of some columns, with all their segments.
class Columns {
 public:
  Columns(const GridReader& reader, std::span<const Label> here, const LevelShape& shape, uint32_t cu0, uint32_t cv0, uint32_t cu1, uint32_t cv1,
          std::shared_ptr<Chunk>& scratch)
      : shape_(shape), cu0_(cu0), cv0_(cv0), width_(cu1 - cu0), here_(here) {
    for (uint32_t cv = cv0; cv < cv1; ++cv)
      for (uint32_t cu = cu0; cu < cu1; ++cu)
        for (uint32_t segment = 0; segment < shape.segments; ++segment) {
          const ChunkKey key{0, cu, cv, segment};
          if (const auto set = reader.uniform(key)) {
            cells_.push_back({nullptr, here_[set->front()], false});
            continue;
          }
          cells_.push_back({reader.chunk(key, scratch), 0, false});
          const PatternTable& patterns = cells_.back().chunk->rays.patterns;
          for (uint32_t p = 0; p < patterns.size(); ++p)
            for (const SetId label : patterns.sets(p)) cells_.back().renumbered |= here_[label] != label;
          scratch.reset();  // without a keeper it would be overwritten
        }
  }

  void append(uint32_t u, uint32_t v, RayBlock& out) {
    const uint32_t cu = u / shape_.chunk_rays, cv = v / shape_.chunk_rays;
    const Cells* const column = &cells_[size_t{(cv - cv0_) * width_ + cu - cu0_} * shape_.segments];
    const uint32_t ray = (v - cv * shape_.chunk_rays) * shape_.rays_u(cu) + u - cu * shape_.chunk_rays;
    if (shape_.segments == 1 && !column->renumbered) {
      if (column->chunk) out.append(column->chunk->rays.sets(ray), column->chunk->rays.changes(ray));
      else out.append({&column->label, 1}, {});
      return;
    }
    sets_.clear(), changes_.clear();
    for (uint32_t segment = 0; segment < shape_.segments; ++segment) {
      const uint32_t base = segment * shape_.chunk_cells;
      const auto add = [&](uint32_t from, SetId set) {
        if (!sets_.empty() && sets_.back() == set) return;
        if (!sets_.empty()) changes_.push_back(base + from);
        sets_.push_back(set);
      };
      if (const Cells& cells = column[segment]; cells.chunk)
        cells.chunk->rays.for_each_run(ray, [&](uint32_t from, uint32_t, SetId set) { add(from, here_[set]); });
      else add(0, cells.label);
    }
    out.append(sets_, changes_);
  }

 private:
  const LevelShape& shape_;
  const uint32_t cu0_, cv0_, width_;
  const std::span<const Label> here_;
  std::vector<Cells> cells_;
  std::vector<SetId> sets_;
  std::vector<uint32_t> changes_;
};

}  // namespace

std::vector<Label> labels_here(const Metadata& meta) {
  std::vector<Label> out(meta.labels.size());
  for (Label label = 0; label < out.size(); ++label) out[label] = meta.labels[label].material == 0 ? 0 : without_overlap(meta, label);
  return out;
}

void read_field(const GridReader& reader, std::span<const Label> here, uint32_t cu, uint32_t cv, std::shared_ptr<Chunk>& scratch, Field& out) {
  const LevelShape shape = reader.shape(0);
  const uint32_t rays = shape.chunk_rays, margin = Field::kMargin;
  const uint32_t u0 = cu * rays, v0 = cv * rays, u1 = u0 + shape.rays_u(cu), v1 = v0 + shape.rays_v(cv);
  out.u = u0 - std::min(u0, margin), out.v = v0 - std::min(v0, margin);
  const uint32_t end_u = std::min(shape.nu, u1 + margin), end_v = std::min(shape.nv, v1 + margin);
  out.column = {u0 - out.u, v0 - out.v, u1 - out.u, v1 - out.v};
  Columns columns(reader, here, shape, out.u / rays, out.v / rays, (end_u - 1) / rays + 1, (end_v - 1) / rays + 1, scratch);
  out.rays.reset(end_u - out.u, end_v - out.v, shape.nw);
  for (uint32_t v = out.v; v < end_v; ++v)
    for (uint32_t u = out.u; u < end_u; ++u) columns.append(u, v, out.rays);
}

}  // namespace teracell::store

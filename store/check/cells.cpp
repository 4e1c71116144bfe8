#include "store/check/cells.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "store/base/in_order.hpp"
#include "store/check/regions.hpp"

namespace teracell::inline store {
namespace {

constexpr uint32_t kWide = 8;  // rays: in the middle of a column that is so wide a ball is 4 cells deep, and all cells beside it are near

bool is_larger(const Component& a, const Component& b) { return a.cells != b.cells ? a.cells > b.cells : a.first < b.first; }

// What a block tells of a label.
struct BlockFacts {
  std::array<uint64_t, kThickest / 2 - 1> thin{};
  uint32_t thinnest = kThickest;
  std::array<uint32_t, 3> thinnest_at{~0u, ~0u, ~0u};
  Component at_sides;
};

struct Block {
  uint32_t cu;
  BlockComponents cells;
  BlockRegions thin, narrow;
  std::unordered_map<Label, BlockFacts> labels;
};

// Each thread has its own.
class BlockReader {
 public:
  BlockReader(const GridReader& reader, const std::vector<bool>& sheets, const CheckOptions& options)
      : reader_(reader),
        shape_(reader.shape(0)),
        frame_(reader.meta().frame()),
        thin_below_(halves_below(options.thin_cells)),
        narrow_below_(halves_below(options.narrow_cells)),
        here_(labels_here(reader.meta())),
        thickness_(walls(sheets, narrow_below_ > 0)) {}

  Block read(uint32_t cu, uint32_t cv) {
    Block block{cu, {}, {}, {}, {}};
    const bool is_one = read_uniform(cu, cv);
    if (!is_one) read_field(reader_, here_, cu, cv, scratch_, field_);
    const uint32_t u = cu * shape_.chunk_rays, v = cv * shape_.chunk_rays;
    block.cells = labeller_.components(field_.rays, field_.column, u, v, frame_);
    find_sides(block, u, v);
    if (!is_one) find_thin(block, u, v);
    return block;
  }

 private:
  // The thicknesses, in half cells, that are less than this many cells are less than what is returned.
  static uint32_t halves_below(double cells) { return static_cast<uint32_t>(std::ceil(std::clamp(2 * cells, 0., static_cast<double>(kThickest)))); }
  static std::vector<bool> walls(std::vector<bool> sheets, bool background) {
    std::vector<bool> out = std::move(sheets);
    out.flip();
    out[0] = background;
    return out;
  }

  std::array<uint32_t, 3> place(uint32_t u, uint32_t v, uint32_t w) const {
    std::array<uint32_t, 3> out;
    out[2 - frame_.u] = u, out[2 - frame_.v] = v, out[2 - frame_.w] = w;
    return out;
  }

  // A column of one label that is wide enough needs no rays around it: nothing in it is thin.
  bool read_uniform(uint32_t cu, uint32_t cv) {
    const uint32_t nu = shape_.rays_u(cu), nv = shape_.rays_v(cv);
    std::optional<Label> label;
    for (uint32_t segment = 0; segment < shape_.segments; ++segment) {
      const auto set = reader_.uniform({0, cu, cv, segment});
      if (!set || (label && *label != here_[set->front()])) return false;
      label = here_[set->front()];
    }
    if ((*label != 0 || narrow_below_ > 0) && (nu < kWide || nv < kWide)) return false;
    field_.rays.fill(nu, nv, shape_.nw, *label);
    field_.column = {0, 0, nu, nv};
    return true;
  }

  void find_sides(Block& block, uint32_t u0, uint32_t v0) {
    const RayBlock& rays = field_.rays;
    const auto add = [&](uint32_t u, uint32_t v, uint32_t from, uint32_t to, Label label) {
      if (label != 0) block.labels[label].at_sides.add({label, 0, to - from, {u, v, from}, {u + 1, v + 1, to}, place(u, v, from)});
    };
    for (uint32_t v = field_.column.v0; v < field_.column.v1; ++v)
      for (uint32_t u = field_.column.u0; u < field_.column.u1; ++u) {
        const uint32_t ray = v * rays.nu + u, gu = u0 + u - field_.column.u0, gv = v0 + v - field_.column.v0;
        const std::span<const SetId> labels = rays.sets(ray);
        if (gu == 0 || gv == 0 || gu + 1 == shape_.nu || gv + 1 == shape_.nv) {
          rays.for_each_run(ray, [&](uint32_t from, uint32_t to, Label label) { add(gu, gv, from, to, label); });
          continue;
        }
        if (labels.front() != 0) add(gu, gv, 0, 1, labels.front());
        if (labels.back() != 0 && rays.length > 1) add(gu, gv, rays.length - 1, rays.length, labels.back());
      }
  }

  void find_thin(Block& block, uint32_t u0, uint32_t v0) {
    thin_.clear(), narrow_.clear();
    const RayWindow& column = field_.column;
    for (ThinRun run : thickness_.thin_runs(field_)) {
      run.u += u0 - column.u0, run.v += v0 - column.v0;
      if (run.label == 0) {
        if (run.halves < narrow_below_) narrow_.push_back(run);
        continue;
      }
      BlockFacts& facts = block.labels[run.label];
      facts.thin[run.halves / 2 - 1] += run.to - run.from;
      const auto at = place(run.u, run.v, run.from);
      if (std::pair(run.halves, at) < std::pair(facts.thinnest, facts.thinnest_at)) facts.thinnest = run.halves, facts.thinnest_at = at;
      if (run.halves < thin_below_) thin_.push_back(run);
    }
    const RayWindow whole{u0, v0, u0 + column.u1 - column.u0, v0 + column.v1 - column.v0};
    block.thin = regions_of(thin_, whole, frame_);
    block.narrow = regions_of(narrow_, whole, frame_);
  }

  const GridReader& reader_;
  const LevelShape shape_;
  const RayFrame frame_;
  const uint32_t thin_below_, narrow_below_;  // in half cells
  const std::vector<Label> here_;
  std::shared_ptr<Chunk> scratch_;
  Field field_;
  Thickness thickness_;
  BlockLabeller labeller_;
  std::vector<ThinRun> thin_, narrow_;
};

}  // namespace

void LargestComponents::add(const Component& c) {
  ++number_;
  cells_ += c.cells;
  if (heap_.size() == most_) {
    if (!is_larger(c, heap_.front())) return;
    std::ranges::pop_heap(heap_, is_larger);  // the smallest is in front
    heap_.pop_back();
  }
  heap_.push_back(c);
  std::ranges::push_heap(heap_, is_larger);
}

std::vector<Component> LargestComponents::sorted() const {
  std::vector<Component> out = heap_;
  std::ranges::sort(out, is_larger);
  return out;
}

CellFacts look_at_cells(const GridReader& reader, const std::vector<bool>& sheets, const CheckOptions& options,
                        const std::function<void(double)>& progress) {
  const LevelShape shape = reader.shape(0);
  CellFacts out;
  out.labels.resize(reader.meta().labels.size());
  const auto touches_side = [&](const Component& c) {
    const std::array<uint32_t, 3> n = {shape.nu, shape.nv, shape.nw};
    for (size_t d = 0; d < 3; ++d)
      if (c.lo[d] == 0 || c.hi[d] == n[d]) return true;
    return false;
  };
  ComponentJoiner cells(shape, [&](const Component& c) {
    LabelFacts& facts = out.labels[c.label];
    facts.cells += c.cells;
    if (c.label == 0) {
      if (!touches_side(c)) out.enclosed.add(c);
    } else if (facts.largest.cells == 0) facts.largest = c;
    else {
      out.islands.add(is_larger(c, facts.largest) ? facts.largest : c);
      if (is_larger(c, facts.largest)) facts.largest = c;
    }
  });
  const auto adds_to = [](LargestComponents& all) {
    return [&all](const Component& c) {
      if (c.cells >= kFewCells) all.add(c);
    };
  };
  RegionJoiner thin(shape, adds_to(out.thin)), narrow(shape, adds_to(out.narrow));

  std::vector<BlockReader> readers(static_cast<size_t>(options.threads), BlockReader(reader, sheets, options));
  const uint64_t columns = uint64_t{shape.chunks_u} * shape.chunks_v;
  uint64_t next = 0, done = 0;
  in_order(
      options.threads, [&]() -> std::optional<uint64_t> { return next < columns ? std::optional(next++) : std::nullopt; },
      [&](uint64_t column, int worker) {
        return readers[static_cast<size_t>(worker)].read(static_cast<uint32_t>(column % shape.chunks_u),
                                                         static_cast<uint32_t>(column / shape.chunks_u));
      },
      [&](Block&& block) {
        for (const auto& [label, found] : block.labels) {
          LabelFacts& facts = out.labels[label];
          for (size_t i = 0; i < found.thin.size(); ++i) facts.thin[i] += found.thin[i];
          if (std::pair(found.thinnest, found.thinnest_at) < std::pair(facts.thinnest, facts.thinnest_at))
            facts.thinnest = found.thinnest, facts.thinnest_at = found.thinnest_at;
          facts.at_sides.add(found.at_sides);
        }
        cells.add(block.cu, std::move(block.cells));
        thin.add(block.cu, std::move(block.thin));
        narrow.add(block.cu, std::move(block.narrow));
        progress(static_cast<double>(++done) / static_cast<double>(columns));
      },
      4);
  cells.finish();
  thin.finish();
  narrow.finish();
  return out;
}

}  // namespace teracell::store

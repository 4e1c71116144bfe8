#include "store/refine/splits.hpp"

#include <algorithm>
#include <deque>
#include <set>

#include "store/base/in_order.hpp"
#include "store/runs/chunk_parts.hpp"

namespace teracell::inline store {
namespace {

constexpr int kManyBits = 3;  // 8 x 8 x 8 blocks are passed by at once where they hold one label

Box shifted(const Box& box, int levels) {  // the cells of a finer level
  Box out;
  for (size_t d = 0; d < 3; ++d) out.lo[d] = box.lo[d] * (int64_t{1} << levels), out.hi[d] = box.hi[d] * (int64_t{1} << levels);
  return out;
}
Box covering(const Box& box, int levels) {  // those of a coarser one that cover it
  Box out;
  for (size_t d = 0; d < 3; ++d) out.lo[d] = box.lo[d] >> levels, out.hi[d] = ((box.hi[d] - 1) >> levels) + 1;
  return out;
}
Box common(const Box& a, const Box& b) {
  Box out;
  for (size_t d = 0; d < 3; ++d) out.lo[d] = std::max(a.lo[d], b.lo[d]), out.hi[d] = std::min(a.hi[d], b.hi[d]);
  return out;
}
bool lies_in(const Box& a, const Box& b) {
  for (size_t d = 0; d < 3; ++d)
    if (a.lo[d] < b.lo[d] || a.hi[d] > b.hi[d]) return false;
  return true;
}
template <class F>
void for_each_place(const Box& box, F&& f) {  // w fastest
  for (int64_t v = box.lo[1]; v < box.hi[1]; ++v)
    for (int64_t u = box.lo[0]; u < box.hi[0]; ++u)
      for (int64_t w = box.lo[2]; w < box.hi[2]; ++w) f(Index3{u, v, w});
}
Box by_rays(const LevelShape& s) { return {{0, 0, 0}, {s.nu, s.nv, s.nw}}; }

// Rows of 32 cells of a box of 32 x 32 x 32: those that have any.
void put_rows(Bytes& out, const Bits& bits, const Box& box) {
  Bytes rows;
  uint64_t number = 0, last = 0, at = 0;
  for (int64_t v = box.lo[1]; v < box.hi[1]; ++v)
    for (int64_t u = box.lo[0]; u < box.hi[0]; ++u, ++at) {
      const uint32_t cells = bits.get32(u, v, box.lo[2]);
      if (cells == 0) continue;
      put_varint(rows, at - last);
      put_fixed(rows, cells);
      last = at, ++number;
    }
  put_varint(out, number);
  out.insert(out.end(), rows.begin(), rows.end());
}
void add_rows(ByteReader& in, const Box& box, Bits& bits) {
  int64_t at = 0;
  const int64_t width = box.hi[0] - box.lo[0];
  for (uint64_t n = in.varint(); n > 0; --n) {
    at += static_cast<int64_t>(in.varint());
    bits.add(box.lo[0] + at % width, box.lo[1] + at / width, box.lo[2], in.fixed<uint32_t>());
  }
}

}  // namespace

Box RefinedBlock::cells() const {
  Box out;
  for (size_t d = 0; d < 3; ++d) out.lo[d] = at[d] << kBits, out.hi[d] = (at[d] + 1) << kBits;
  return out;
}

size_t BlockSplits::memory() const {
  size_t sum = sizeof *this;
  for (const Bits& bits : split) sum += bits.memory();
  return sum;
}

// What makes the first level above a block's own, not spread yet: its cells that hold a marked one, or with N odd one beside it. And of each
// coarser level that anything wants, the cells that hold what wants it.
struct Splits::Marks {
  Bits held;
  std::vector<std::pair<int, Bits>> wanted;
};

Splits::Splits(const GridReader& reader, const Refinement& refinement, const std::filesystem::path& folder, size_t memory)
    : reader_(reader),
      refinement_(refinement),
      wants_(reader, refinement),
      chunks_(memory / 2),
      file_(folder, 0),
      records_(static_cast<size_t>(tiers())),
      made_(memory / 4),
      bases_(memory / 5) {}

// The cells of the level above a block's own of which its splits depend. From the top: to spread by N/2 cells, the box must be so much larger; to
// halve, twice as large; and with N odd there is one cell more on the finer level.
Box Splits::window(const RefinedBlock& block) const {
  const int64_t half = refinement_.layers / 2, odd = refinement_.layers % 2;
  const int levels = levels_of(block.tier);
  Box box = grown(covering(block.cells(), levels), half);
  for (int i = 1; i < levels; ++i) box = grown(grown(shifted(box, 1), odd), half);
  return box;
}

// For each tier but the last, the blocks of which cells of level 0 need the record. Whether a cell is split depends on what is marked up to N cells
// around it on the level below, so a thin box needs little more than a box as thick as the coarsest leaves.
std::vector<Box> Splits::blocks_for(const Box& cells) const {
  std::vector<Box> out(static_cast<size_t>(tiers()));
  const Box grid = by_rays(reader_.shape(0));
  Box box = covering(cells, coarsest());
  for (int level = coarsest() - 1; level >= 2; --level) {
    box = common(grown(shifted(box, 1), refinement_.layers), covering(grid, level));
    if (level % 2 == 0) out[static_cast<size_t>(level / 2 - 1)] = covering(box, RefinedBlock::kBits - 2);
  }
  return out;
}

std::shared_ptr<const Chunk> Splits::chunk(const ChunkKey& key) const {
  return chunks_.get(key, [&] {
    auto out = std::make_shared<Chunk>();
    reader_.read(key, *out);
    return out;
  });
}

// The label of all cells of a box of a level, if they have one.
std::optional<Label> Splits::only_label(const Box& cells, int level) const {
  const RayFrame f = reader_.meta().frame();
  std::optional<Label> label;
  bool same = true;
  const auto see = [&](const std::vector<Label>& set) {
    same = same && set.size() == 1 && (!label || *label == set.front());
    if (same) label = set.front();
  };
  for_each_part(reader_.shape(level), RayBox(f.box(cells.lo, cells.hi), f), [&](const ChunkPart& p) {
    if (const auto set = reader_.uniform(p.key)) {
      see(*set);
      return same;
    }
    const auto held = chunk(p.key);
    std::optional<SetId> last;
    for_each_part_run(held->rays, p, [&](uint32_t, uint32_t, uint32_t, uint32_t, SetId set) {
      if (same && last != set) see(held->sets.members(set));
      last = set;
    });
    return same;
  });
  return same ? label : std::nullopt;
}

// The same for cells of level 0, found out on a coarse level, if also nothing of them wants anything.
std::optional<Label> Splits::quiet(const Box& cells, int level) const {
  level = std::min(level, reader_.levels() - 1);
  const LevelShape shape = reader_.shape(level);
  const Box box = common(covering(cells, level), by_rays(shape));
  const auto label = only_label(box, level);
  return label && wants_.nothing(cells, *label) ? label : std::nullopt;
}

Label Splits::label_of(const Index3& cell) const {
  const LevelShape s = reader_.shape(0);
  const ChunkKey key{0, static_cast<uint32_t>(cell[0] / s.chunk_rays), static_cast<uint32_t>(cell[1] / s.chunk_rays),
                     static_cast<uint32_t>(cell[2] / s.chunk_cells)};
  if (const auto set = reader_.uniform(key)) return set->front();
  const auto held = chunk(key);
  const auto u = static_cast<uint32_t>(cell[0] % s.chunk_rays), v = static_cast<uint32_t>(cell[1] % s.chunk_rays);
  return held->rays.set_at(v * held->rays.nu + u, static_cast<uint32_t>(cell[2] % s.chunk_cells));
}

BlockSplits Splits::climb(const RefinedBlock& block, Marks marks, Bytes* record) const {
  const int64_t half = refinement_.layers / 2, odd = refinement_.layers % 2;
  BlockSplits out;
  Bits held = std::move(marks.held);
  for (int i = 1; i <= levels_of(block.tier); ++i) {
    const int level = block.level() + i;
    held.dilate(half);
    out.split.push_back(held);
    if (level == coarsest()) break;
    if (i == levels_of(block.tier)) {
      if (record == nullptr) break;
      const Box box = held.box();
      const bool any = !held.none() || std::ranges::any_of(marks.wanted, [](const auto& w) { return !w.second.none(); });
      if (!any) break;
      put_rows(*record, held, box);
      for (const auto& [wanted, bits] : marks.wanted)
        if (wanted >= level) put_rows(*record, bits.cropped(box), box);
      break;
    }
    for (const auto& [wanted, bits] : marks.wanted)
      if (wanted == level) held.add(bits);
    held.dilate(odd);
    const Box even = held.box();
    held = held.coarser();
    for (auto& [wanted, bits] : marks.wanted) bits = bits.cropped(even).coarser();
  }
  return out;
}

Splits::Base Splits::make_base(const Index3& at, Bytes* record) const {
  const RefinedBlock block{0, at};
  const int64_t odd = refinement_.layers % 2;
  const Box own = common(block.cells(), by_rays(reader_.shape(0)));
  const Box level_1 = tiers() > 0 ? window(block) : Box{};
  const Box cells = tiers() > 0 ? common(grown(shifted(level_1, 1), odd + 1), by_rays(reader_.shape(0))) : own;
  Base out;
  out.label = quiet(cells, RefinedBlock::kBits);
  if (out.label) return out;
  out.window.emplace(reader_, chunks_, cells);
  if (tiers() == 0) return out;
  std::vector<Bits> bits;
  for (size_t i = 0; i < wants_.levels().size(); ++i) bits.emplace_back(level_1);
  wants_.mark(*out.window, odd, bits);
  Marks marks;
  for (size_t i = 0; i < bits.size(); ++i) {
    if (wants_.levels()[i] == 0) marks.held = std::move(bits[i]);
    else marks.wanted.emplace_back(wants_.levels()[i], std::move(bits[i]));
  }
  if (marks.held.box().empty()) marks.held = Bits(level_1);
  out.splits = climb(block, std::move(marks), record);
  return out;
}

// From what was found of the tier below.
std::optional<BlockSplits> Splits::make_above(const RefinedBlock& block, Bytes* record) const {
  const int64_t odd = refinement_.layers % 2;
  const Box own = grown(shifted(window(block), 1), odd);  // of its level
  Bits marked(own);
  Marks marks;
  for (const int level : wants_.levels())
    if (level >= block.level()) marks.wanted.emplace_back(level, Bits(own));
  const auto& records = records_[static_cast<size_t>(block.tier - 1)];
  bool any = false;
  Bytes bytes;
  const Box below = covering(own, RefinedBlock::kBits - 2);  // a block of the tier below has 32 x 32 x 32 cells of this level
  for_each_place(below, [&](const Index3& at) {
    const RefinedBlock kept{block.tier - 1, at};
    const auto it = records.find(kept);
    if (it == records.end() || it->second.bytes == 0) return;
    any = true;
    bytes.resize(it->second.bytes);
    file_.read(it->second.offset, bytes);
    ByteReader in(bytes, "a block that was kept");
    const Box box = covering(kept.cells(), 2);
    add_rows(in, box, marked);
    for (auto& [level, bits] : marks.wanted) add_rows(in, box, bits);
  });
  if (!any) return std::nullopt;
  for (const auto& [level, bits] : marks.wanted)
    if (level == block.level()) marked.add(bits);
  std::erase_if(marks.wanted, [&](const auto& w) { return w.first == block.level(); });
  marked.dilate(odd);
  const Box even = marked.box();
  marks.held = marked.coarser();
  for (auto& [level, bits] : marks.wanted) bits = bits.cropped(even).coarser();
  return climb(block, std::move(marks), record);
}

Splits::Record Splits::written(const Bytes& record) {
  try {
    file_.write(size_, record);
  } catch (const IoError& e) {
    throw IoError(e.what(), Remedy::kOtherFolder);  // more memory would change nothing
  }
  const Record out{size_, static_cast<uint32_t>(record.size())};
  size_ += record.size();
  return out;
}

// Makes the records of blocks of a tier and keeps them. next() gives a block and the share of all that lies before it, or nothing.
template <class Next>
void Splits::make_records(int threads, const std::function<void(double share)>& progress, Next next) {
  struct Found {
    std::pair<RefinedBlock, double> job;
    Bytes record;
  };
  // They are there for others at the end, however that comes: next() looks at those that were there before, on another thread.
  struct Made {
    Splits& splits;
    std::vector<std::pair<RefinedBlock, Record>> records = {};
    ~Made() {
      for (const auto& [block, record] : records) splits.records_[static_cast<size_t>(block.tier)][block] = record;
    }
  } made{*this};
  in_order(
      threads, next,
      [&](const std::pair<RefinedBlock, double>& job, int) {
        Found found{job, {}};
        if (job.first.tier == 0) {
          auto base = std::make_shared<const Base>(make_base(job.first.at, &found.record));
          const size_t bytes = base->memory();
          bases_.add(job.first, std::move(base), bytes);
        } else {
          make_above(job.first, &found.record);
        }
        return found;
      },
      [&](const Found& found) {
        progress(found.job.second);
        if (!found.record.empty() || found.job.first.tier == 0) made.records.emplace_back(found.job.first, written(found.record));
      },
      16);
}

// From runs. Groups of blocks that hold one label are passed by; those along the same rays follow each other, since chunks are kept for a while.
void Splits::prepare_base(const Box& blocks, int threads, const std::function<void(double share)>& progress) {
  const Box grid = by_rays(reader_.shape(0)), groups = covering(blocks, kManyBits);
  const int64_t wide = groups.hi[0] - groups.lo[0], high = groups.hi[1] - groups.lo[1];
  Index3 at = groups.lo;
  std::deque<std::pair<RefinedBlock, double>> waiting;
  const auto add_group = [&] {
    const Box group = common(shifted({at, {at[0] + 1, at[1] + 1, at[2] + 1}}, kManyBits), blocks);
    const Box cells = common(grown(shifted(group, RefinedBlock::kBits), 3 * refinement_.layers + 2), grid);
    const double share = static_cast<double>((at[1] - groups.lo[1]) * wide + at[0] - groups.lo[0]) / static_cast<double>(wide * high);
    if (!quiet(cells, RefinedBlock::kBits + kManyBits))
      for_each_place(group, [&](const Index3& block) {
        if (!records_[0].contains({0, block})) waiting.push_back({{0, block}, share});
      });
    if (++at[2] < groups.hi[2]) return;
    at[2] = groups.lo[2];
    if (++at[0] == groups.hi[0]) at[0] = groups.lo[0], ++at[1];
  };
  make_records(threads, progress, [&]() -> std::optional<std::pair<RefinedBlock, double>> {
    while (waiting.empty() && at[1] < groups.hi[1]) add_group();
    if (waiting.empty()) return std::nullopt;
    const auto job = waiting.front();
    waiting.pop_front();
    return job;
  });
}

// From the tier below: of blocks that something there reaches. What is known of it may be more than it was for an earlier box.
void Splits::prepare_above(int tier, const Box& blocks, int threads, const std::function<void(double share)>& progress) {
  std::set<Index3> reached;
  for (const auto& [below, record] : records_[static_cast<size_t>(tier - 1)]) {
    if (record.bytes == 0) continue;
    for_each_place(common(covering(grown(covering(below.cells(), 2), 3 * refinement_.layers + 2), RefinedBlock::kBits), blocks),
                   [&](const Index3& block) { reached.insert(block); });
  }
  auto next = reached.begin();
  make_records(threads, progress, [&]() -> std::optional<std::pair<RefinedBlock, double>> {
    if (next == reached.end()) return std::nullopt;
    return std::pair(RefinedBlock{tier, *next++}, 1.0);
  });
}

bool Splits::is_prepared(const Box& box) const {
  const Box cells = common(box, by_rays(reader_.shape(0)));
  if (cells.empty() || tiers() < 2) return true;
  const std::vector<Box> blocks = blocks_for(cells);
  return std::ranges::any_of(prepared_, [&](const auto& before) { return std::ranges::equal(blocks, before, lies_in); });
}

// What an exception ends goes on where it was with the next call: records stay, and those of tiers above are made again.
void Splits::prepare(const Box& box, int threads, const std::function<void(double share)>& progress) {
  if (is_prepared(box)) return;
  std::vector<Box> blocks = blocks_for(common(box, by_rays(reader_.shape(0))));
  made_.clear();  // some may have been made of too little
  prepare_base(blocks[0], threads, progress);
  for (int tier = 1; tier + 1 < tiers(); ++tier) prepare_above(tier, blocks[static_cast<size_t>(tier)], threads, progress);
  std::erase_if(prepared_, [&](const auto& before) { return std::ranges::equal(before, blocks, lies_in); });
  prepared_.push_back(std::move(blocks));
}

std::shared_ptr<const Splits::Base> Splits::base(const Index3& block, bool again) const {
  const auto make = [&] {
    auto out = std::make_shared<const Base>(make_base(block, nullptr));
    const size_t bytes = out->memory();
    return std::pair(std::move(out), bytes);
  };
  if (again) return bases_.get({0, block}, make);
  const auto kept = bases_.find({0, block});
  return kept ? kept : make().first;
}

std::shared_ptr<const BlockSplits> Splits::get(const RefinedBlock& block) const {
  return made_.get(block, [&] {
    auto out = std::make_shared<const BlockSplits>(make_above(block, nullptr).value_or(BlockSplits{}));
    const size_t bytes = out->memory();
    return std::pair(std::move(out), bytes);
  });
}

}  // namespace teracell::store

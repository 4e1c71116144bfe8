#include "tools/export/faces/surface.hpp"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/grid/set_memo.hpp"
#include "store/read/query.hpp"
#include "store/runs/chunk_parts.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports::faces {
namespace {

constexpr int kBlockBits = 7;  // smaller blocks have relatively more margin, larger ones more memory: 5 bytes per cell, and 50 per vertex
constexpr int kMostRounds = 20;
constexpr int64_t kMargin = 2;  // with it, all that belongs to the corners of a block is right

enum State : uint8_t { kOut, kIn, kMixed };

std::vector<bool> chosen_materials(const Export& e) {
  if (e.has("--material")) return e.materials("--material");
  std::vector<bool> all(e.reader.meta().materials.size(), true);
  all[0] = false;
  return all;
}

int rounds_of_smoothing(const Export& e) { return static_cast<int>(e.integer("--smooth", 1, kMostRounds, 0)); }

// Whether all cells of blocks belong to the body, or none. Blocks are the cells of a coarse level.
class BlockStates {
 public:
  BlockStates(const Export& e, const std::vector<bool>& chosen) : e_(e), coarse_(e.level + kBlockBits) {
    value_ = [&meta = e.reader.meta(), &chosen](const std::vector<Label>& set) -> uint32_t {
      const auto in = std::ranges::count_if(set, [&](Label label) { return chosen[meta.labels[label].material]; });
      return in == 0 ? kOut : static_cast<size_t>(in) == set.size() ? kIn : kMixed;
    };
  }

  void read(const Box& blocks) {
    box_ = blocks;
    n_ = size_of(blocks);
    states_.assign(static_cast<size_t>(n_[0] * n_[1] * n_[2]), kMixed);
    if (coarse_ >= e_.reader.levels()) return;
    read_box<uint8_t>(e_.reader, coarse_, blocks, value_, kOut, states_.data(), {1, n_[0], n_[0] * n_[1]});
    uint8_t* state = states_.data();
    for (int64_t z = blocks.lo[2]; z < blocks.hi[2]; ++z)
      for (int64_t y = blocks.lo[1]; y < blocks.hi[1]; ++y)
        for (int64_t x = blocks.lo[0]; x < blocks.hi[0]; ++x, ++state) *state = within_export({x, y, z}, static_cast<State>(*state));
  }

  // Whether the surface can pass through a block or touch it. REQUIRES: its neighbours were read too.
  bool surface_near(const Index3& block) const {
    const size_t at = static_cast<size_t>(((block[2] - box_.lo[2]) * n_[1] + block[1] - box_.lo[1]) * n_[0] + block[0] - box_.lo[0]);
    for (int64_t z = -1; z <= 1; ++z)
      for (int64_t y = -1; y <= 1; ++y)
        for (int64_t x = -1; x <= 1; ++x) {
          const uint8_t state = states_[at + static_cast<size_t>((z * n_[1] + y) * n_[0] + x)];
          if (state == kMixed || state != states_[at]) return true;
        }
    return false;
  }

 private:
  State within_export(const Index3& block, State state) const {
    bool whole = true;
    for (int d = 0; d < 3; ++d) {
      const int64_t lo = block[d] << kBlockBits, hi = (block[d] + 1) << kBlockBits;
      if (hi <= e_.box.lo[d] || lo >= e_.box.hi[d]) return kOut;
      whole = whole && lo >= e_.box.lo[d] && hi <= e_.box.hi[d];
    }
    return state == kIn && !whole ? kMixed : state;
  }

  const Export& e_;
  const int coarse_;
  SetValue value_;
  Box box_;
  Index3 n_{};
  std::vector<uint8_t> states_;
};

// The group of the vertices at a place, and in which block: bit d of `next` is that behind axis d. False: beyond the next blocks.
bool group_of(const Index3& place, const Box& box, unsigned& group, unsigned& next) {
  group = next = 0;
  for (int d = 0; d < 3; ++d) {
    if (place[d] < box.lo[d] || place[d] > box.hi[d]) return false;
    if (place[d] == box.hi[d]) next |= 1u << d;
    if (place[d] == box.lo[d] || place[d] == box.hi[d]) group |= 1u << d;
  }
  return true;
}

auto order(const Index3& block) { return std::tuple(block[2], block[1], block[0]); }

}  // namespace

uint64_t least_vertices(const Export& e, const std::vector<bool>& chosen, uint64_t enough) {
  const LevelShape shape = e.reader.shape(e.level);
  const SetValue material = strongest_material(e.reader.meta());
  const RayFrame frame = e.reader.meta().frame();
  uint64_t out = 0;
  e.reader.prefetch(e.level, e.box);
  std::shared_ptr<Chunk> scratch;
  for_each_part(shape, RayBox(e.box, frame), [&](const ChunkPart& p) {
    if (out > enough) return;
    e.progress(0);
    const bool first = p.first_w + p.w0 == e.box.lo[frame.w], last = p.first_w + p.w1 == e.box.hi[frame.w];
    if (const auto set = e.reader.uniform(p.key)) {
      if (chosen[material(*set)]) out += uint64_t{p.u1 - p.u0} * (p.v1 - p.v0) * (first + last);
      return;
    }
    const auto chunk = e.reader.chunk(p.key, scratch);
    SetMemo<bool> known;
    bool before = false;
    for_each_part_run(chunk->rays, p, [&](uint32_t, uint32_t, uint32_t from, uint32_t to, SetId set) {
      const bool in = known.get(set, [&] { return chosen[material(chunk->sets.members(set))]; });
      out += from == p.w0 ? first && in : in != before;
      out += to == p.w1 && last && in;
      before = in;
    });
  });
  return out;
}

Surface::Surface(const Export& e, Leg leg, const Room& room)
    : e_(e), room_(room), chosen_(chosen_materials(e)), rounds_(rounds_of_smoothing(e)), material_(strongest_material(e.reader.meta())) {
  double corners = 1;  // of all cells
  for (int d = 0; d < 3; ++d) corners *= static_cast<double>(e.box.hi[d] - e.box.lo[d] + 1);
  if (corners > static_cast<double>(std::min(room.vertices, room.facets / 2))) {
    const uint64_t least = least_vertices(e, chosen_, std::min(room.vertices, room.facets / 2));
    expect_room(least, 2 * least);
  }
  find_blocks(leg);
  if (facets_ > 0) return;
  const std::string names = chosen_names(e.reader.meta().materials, chosen_);
  throw UsageError(fmt::format("the surface would have no facet: expected cells of {} in the box, found none; --material chooses other materials",
                               names.empty() ? "a material beside the background" : names));
}

void Surface::expect_room(uint64_t vertices, uint64_t facets) const {
  const bool few = vertices <= room_.vertices;
  if (few && facets <= room_.facets) return;
  throw UsageError(fmt::format("--format: {} has at most {} {}, this surface has {} at least: take {}", room_.format,
                               few ? room_.facets : room_.vertices, few ? "facets" : "vertices", few ? facets : vertices, room_.advice));
}

// Blocks hold cells and the corners below them. The corners of the last cells' upper sides are those of cells one beyond.
Box Surface::box_of(const Index3& block) const {
  Box out;
  for (int d = 0; d < 3; ++d) {
    out.lo[d] = std::max(e_.box.lo[d], block[d] << kBlockBits);
    out.hi[d] = std::min(e_.box.hi[d] + 1, (block[d] + 1) << kBlockBits);
  }
  return out;
}

void Surface::find_blocks(Leg leg) {
  constexpr int64_t kAtOnce = 1024;
  Index3 lo, hi;
  double all = 1, done = 0;
  for (int d = 0; d < 3; ++d) lo[d] = e_.box.lo[d] >> kBlockBits, hi[d] = (e_.box.hi[d] >> kBlockBits) + 1, all *= static_cast<double>(hi[d] - lo[d]);
  BlockStates states(e_, chosen_);
  for (int64_t z = lo[2]; z < hi[2]; ++z)
    for (int64_t y = lo[1]; y < hi[1]; ++y)
      for (int64_t from = lo[0]; from < hi[0]; from += kAtOnce) {
        const int64_t to = std::min(hi[0], from + kAtOnce);
        e_.progress(leg.from + (leg.to - leg.from) * done / all);
        states.read({{from - 1, y - 1, z - 1}, {to + 1, y + 2, z + 2}});
        for (int64_t x = from; x < to; ++x, ++done) {
          if (!states.surface_near({x, y, z})) continue;
          e_.progress(leg.from + (leg.to - leg.from) * done / all);
          count({x, y, z});
        }
      }
  e_.progress(leg.to);
}

void Surface::read(const Box& box, int64_t margin) {
  Box found;  // of the cells that are exported
  Index3 n, offset;
  for (int d = 0; d < 3; ++d) {
    cells_.box.lo[d] = box.lo[d] - margin, cells_.box.hi[d] = box.hi[d] + margin;
    found.lo[d] = std::max(e_.box.lo[d], cells_.box.lo[d]), found.hi[d] = std::min(e_.box.hi[d], cells_.box.hi[d]);
    n[d] = cells_.box.hi[d] - cells_.box.lo[d], offset[d] = found.lo[d] - cells_.box.lo[d];
  }
  cells_.in.assign(static_cast<size_t>(n[0] * n[1] * n[2]), 0);
  cells_.material.resize(cells_.in.size());
  if (found.empty()) return;
  const auto first = static_cast<size_t>((offset[2] * n[1] + offset[1]) * n[0] + offset[0]);
  read_box<uint16_t>(e_.reader, e_.level, found, material_, 0, cells_.material.data() + first, {1, n[0], n[0] * n[1]});
  const std::vector<uint8_t> chosen(chosen_.begin(), chosen_.end());
  for (int64_t z = 0; z < found.hi[2] - found.lo[2]; ++z)
    for (int64_t y = 0; y < found.hi[1] - found.lo[1]; ++y) {
      const size_t row = first + static_cast<size_t>((z * n[1] + y) * n[0]);
      for (size_t i = row; i < row + static_cast<size_t>(found.hi[0] - found.lo[0]); ++i) cells_.in[i] = chosen[cells_.material[i]];
    }
}

void Surface::count(const Index3& at) {
  const Box box = box_of(at);
  read(box, kMargin);
  if (std::ranges::find(cells_.in, 1 - cells_.in[0]) == cells_.in.end()) return;
  piece_.find(cells_);
  uint64_t facets = 0;
  piece_.for_each_facet(box, [&](size_t, const auto&) { ++facets; });
  Block block{at, vertices_, {}};
  for (uint32_t v = 0; v < piece_.vertices(); ++v) {
    unsigned group, next;
    if (group_of(piece_.place(v), box, group, next) && next == 0) ++block.group[group + 1];
  }
  for (size_t i = 1; i < block.group.size(); ++i) block.group[i] += block.group[i - 1];
  if (facets == 0 && block.group.back() == 0) return;
  blocks_.push_back(block);
  vertices_ += block.group.back();
  facets_ += facets;
  expect_room(vertices_, facets_);
}

Planes Surface::planes() const {
  Planes out{cells_.box.lo, {}};
  for (int d = 0; d < 3; ++d)
    for (int64_t i = cells_.box.lo[d]; i <= cells_.box.hi[d]; ++i)
      out.at[d].push_back(plane_of(e_, d, std::clamp(i, e_.box.lo[d], e_.box.hi[d]) - e_.box.lo[d]));
  return out;
}

std::vector<uint64_t> Surface::numbers_of(const Block& block) const {
  const Box box = box_of(block.at);
  std::array<std::array<uint64_t, 8>, 8> following{};  // of the next block and the group: the number to give next
  for (unsigned next = 0; next < 8; ++next) {
    const Index3 at{block.at[0] + (next & 1), block.at[1] + (next >> 1 & 1), block.at[2] + (next >> 2)};
    const auto it = std::ranges::lower_bound(blocks_, order(at), {}, [](const Block& b) { return order(b.at); });
    if (it == blocks_.end() || it->at != at) continue;
    for (unsigned group = 0; group < 8; ++group) following[next][group] = it->first + it->group[group];
  }
  std::vector<uint64_t> out(piece_.vertices());
  for (uint32_t v = 0; v < piece_.vertices(); ++v) {
    unsigned group, next;
    if (group_of(piece_.place(v), box, group, next)) out[v] = following[next][group]++;
  }
  return out;
}

// Calls f(block, part) for each block in order, whose piece was found in cells with this margin.
void Surface::for_each_block(Leg leg, int64_t margin, const std::function<void(const Block&, Part&)>& f) {
  for (size_t i = 0; i < blocks_.size(); ++i) {
    e_.progress(leg.from + (leg.to - leg.from) * static_cast<double>(i) / static_cast<double>(blocks_.size()));
    Part part{box_of(blocks_[i].at), cells_, piece_, {}, {}, {}};
    read(part.box, margin);
    piece_.find(cells_);
    f(blocks_[i], part);
  }
  e_.progress(leg.to);
}

void Surface::for_each_placed(Leg leg, const std::function<void(const Part&)>& f) {
  for_each_block(leg, kMargin + int64_t{2} * rounds_, [&](const Block& block, Part& part) {
    place_vertices(piece_, planes(), rounds_, part.places);
    part.own.resize(block.group.back());
    std::array<uint32_t, 9> following = block.group;
    for (uint32_t v = 0; v < piece_.vertices(); ++v) {
      unsigned group, next;
      if (group_of(piece_.place(v), part.box, group, next) && next == 0) part.own[following[group]++] = v;
    }
    f(part);
  });
}

void Surface::for_each_numbered(Leg leg, const std::function<void(const Part&)>& f) {
  for_each_block(leg, kMargin, [&](const Block& block, Part& part) {
    part.numbers = numbers_of(block);
    f(part);
  });
}

std::vector<ExportOption> surface_options() {
  return {{"--material", "NAME,...", "the materials whose cells the surface encloses (default: all but the background)"},
          {"--smooth", "N", fmt::format("rounds of smoothing, 1 to {}; the surface still encloses the same cell centres", kMostRounds)}};
}

}  // namespace teracell::exports::faces

#include "mesher/tiles/bins.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "mesher/closing/vertex_hash.hpp"

namespace teracell::mesher {
namespace {

// The mean number of bins that a facet lies in, when facets are small compared with a bin.
constexpr double kBinsOfAFacet = 1.2;
// The memory per facet of a loaded bin: its record, its place in the store, and what counting it takes.
constexpr uint64_t kLoadedBytes = 160;
// More memory than this for buffers brought nothing while bins were filled (25.6 million facets, four times as much).
constexpr uint64_t kMostUseful = uint64_t{256} << 20;
// 25.6 million facets took a sixth more processor time with bins of 21,000 facets than with bins of 84,000, because more bins were split, and up to a
// twelfth less with 220,000.
constexpr uint64_t kMostFacets = 200'000;
constexpr uint64_t kLeastBuffer = 4096;

template <class T>
Vec3 vertex_of(const uint8_t* from) {
  std::array<T, 3> all;
  std::memcpy(all.data(), from, sizeof all);
  return {all[0], all[1], all[2]};
}
constexpr size_t kMostOfRecord = 9 * sizeof(double) + 2 * sizeof(uint32_t);

// By a hash of two words, so that it does not matter in what order facets come.
bool is_one_of_eight(std::span<const uint8_t> record) {
  uint64_t first, middle;
  std::memcpy(&first, record.data(), sizeof first), std::memcpy(&middle, record.data() + record.size() / 2, sizeof middle);
  return fold(first ^ kHashKeys[2], middle ^ kHashKeys[3]) % 8 == 0;
}

uint64_t expected_bytes(uint64_t facets, size_t record_bytes) {
  return static_cast<uint64_t>(kBinsOfAFacet * static_cast<double>(facets * record_bytes));
}

}  // namespace

FacetBins::FacetBins(const Metadata& meta, uint64_t facets, uint64_t whole, bool float32, const Budget& budget, bool own_writer, Move move,
                     std::vector<uint8_t> widened, const TreeRange& range, bool patches)
    : rays_(meta, std::move(widened)),
      range_(range),
      float32_(float32),
      patches_(patches),
      shape_{3 * (float32 ? sizeof(float) : sizeof(double)), (patches ? 2 : 1) * sizeof(uint32_t)},
      record_bytes_(shape_.bytes()),
      most_facets_(std::clamp<uint64_t>(budget.bytes / 16 / kLoadedBytes, 1024, kMostFacets)),
      move_(std::move(move)),
      welder_(shape_),
      log_(budget, expected_bytes(whole, record_bytes_), expected_bytes(facets, record_bytes_) <= budget.bytes / 2, own_writer),
      root_{.place = rays_.root()} {
  // Starts with as many bins as are likely to be needed, if their buffers fit: what a bin has when it is split is written twice. Parts of groups
  // are opened when a group has become too large.
  const uint64_t memory = std::min(budget.bytes, kMostUseful);
  fine_ = root_.place.depth;
  for (uint64_t bins = 1; fine_ > rays_.lowest && bins * most_facets_ < facets * 3 / 2 && bins_at(fine_ - 1) <= memory / 8 / kLeastBuffer;)
    bins = bins_at(--fine_);
  first_ = std::max(fine_, 0);
  const size_t room = room_in(memory / 16 / bins_at(first_));
  open(root_, first_, room);
  rooms_ = bins_at(first_) * room;
  most_rooms_ = memory / 8;
  first_u_ = (rays_.shape.nu + rays_.size(first_) - 1) / rays_.size(first_);
  for (uint32_t cv = 0; cv * rays_.size(first_) < rays_.shape.nv; ++cv)
    for (uint32_t cu = 0; cu < first_u_; ++cu) first_bins_.push_back(const_cast<Bin*>(&bin_at({first_, cu, cv})));
}

size_t FacetBins::room_in(uint64_t bytes) const {
  constexpr size_t kMost = PieceLog::kMostOfPiece / 4 * 3;
  static_assert(RecordWelder::most_bytes(kMost) <= PieceLog::kMostOfPiece);
  return std::clamp<uint64_t>(bytes, kLeastBuffer, kMost) / record_bytes_ * record_bytes_;
}

// Gives a bin all that lies below it, and in the grid, down to a depth.
void FacetBins::open(Bin& bin, int depth, size_t room) const {
  bin.room = room;
  if (bin.place.depth <= depth || bins_below(bin.place, depth) == 0) return;
  for (uint32_t k = 0; k < kChildren; ++k) {
    const TreePlace child = bin.place.child(k);
    bin.children.push_back({.place = child, .wanted = child.depth < 0 ? bin.wanted : range_.has_any(child.depth, child.cu, child.cv)});
    open(bin.children.back(), depth, room);
  }
}

// How many nodes of a depth lie below a place, and in the grid.
uint64_t FacetBins::bins_below(const TreePlace& place, int depth) const {
  const uint64_t size = rays_.size(depth);
  const int levels = kFanOutBits * (place.depth - depth);
  const auto along = [&](uint64_t at, uint64_t rays) {
    const uint64_t all = (rays + size - 1) / size, from = std::min(at << levels, all);
    return std::min((at + 1) << levels, all) - from;
  };
  return along(place.cu, rays_.shape.nu) * along(place.cv, rays_.shape.nv);
}

uint64_t FacetBins::bins_at(int depth) const { return bins_below(rays_.root(), depth); }

void FacetBins::add(const Ready& ready) {
  UnitRange units;
  for (std::span<const uint8_t> facets = ready.facets; !facets.empty(); facets = facets.subspan(sizeof units + record_bytes_)) {
    __builtin_prefetch(facets.data() + std::min<size_t>(1024, facets.size() - 1));  // written by another processor
    std::memcpy(&units, facets.data(), sizeof units);
    const auto record = facets.subspan(sizeof units, record_bytes_);
    for (uint64_t v = first_bin_of(units.first_v); v <= first_bin_of(units.last_v); ++v)
      for (uint64_t u = first_bin_of(units.first_u); u <= first_bin_of(units.last_u); ++u)
        put(*first_bins_[v * first_u_ + u], units, record, nullptr);
  }
  for_each_ready(ready.blocks, [&](const ReadyBlock& facts, std::span<const uint8_t> block) {
    put_block(*first_bins_[size_t{facts.v} * first_u_ + facts.u], facts, block);
  });
}

void FacetBins::add(BinnedPart part) {
  const uint32_t tag = part.layer | kInPlace, number = static_cast<uint32_t>(parts_.size());
  parts_.push_back(std::move(part));
  std::array<uint8_t, kMostOfRecord> buffer{};
  const std::span<uint8_t> record(buffer.data(), record_bytes_);
  encode({}, tag, 0, record);
  std::memcpy(record.data(), &number, sizeof number);
  put(root_, units_of(record), record, &parts_.back());
}

FacetBins::UnitRange FacetBins::units_of(std::span<const uint8_t> record) const {
  const uint32_t tag = tag_in(record.subspan(3 * shape_.vertex)), layer = layer_in(tag);
  if (is_part(tag)) {
    const BinnedPart& part = part_in(record);
    return units_of(rays_.range_of({{part.lo, part.hi, part.hi}}, layer));
  }
  Facet facet, room;
  for (size_t i = 0; i < 3; ++i) facet.vertex[i] = vertex_in(record.subspan(i * shape_.vertex));
  return units_of(rays_.range_of(placed(facet, tag, room), layer));
}

// About how many facets of a part lie in a bin, by the share of its box that does.
uint64_t FacetBins::facets_here(const TreePlace& place, const UnitRange& units, const BinnedPart& part) const {
  const auto share = [&](uint32_t first, uint32_t last, uint32_t at) {
    const int shift = rays_.shift(place.depth);
    const uint64_t from = std::max<uint64_t>(first, uint64_t{at} << shift), to = std::min<uint64_t>(last, ((uint64_t{at} + 1) << shift) - 1);
    return static_cast<double>(to + 1 - from) / (static_cast<double>(last - first) + 1);
  };
  const double here = share(units.first_u, units.last_u, place.cu) * share(units.first_v, units.last_v, place.cv);
  return 1 + static_cast<uint64_t>(here * static_cast<double>(part.facets));
}

// Puts a facet, or the record of a part, into a bin or into those below it.
void FacetBins::put(Bin& bin, const UnitRange& units, std::span<const uint8_t> record, const BinnedPart* part) {
  constexpr uint32_t kMostCopies = 4;  // of a part's record among the children of a bin: more of them would read the part too often
  if (!bin.wanted) return;
  if (bin.children.empty()) return put_here(bin, units, record, part);
  const Children in = children_of(bin, units);
  if (part && in.count() > kMostCopies) {
    std::array<uint8_t, kMostOfRecord> buffer;
    const std::span<uint8_t> facet(buffer.data(), record_bytes_);
    return part->read([&](const Facet& f) {
      encode(f, part->layer, part->patch, facet);
      const UnitRange of_facet = units_of(facet);
      if (meets(bin.place, of_facet)) put(bin, of_facet, facet, nullptr);
    });
  }
  for (uint32_t v = in.v0; v <= in.v1; ++v)
    for (uint32_t u = in.u0; u <= in.u1; ++u) put(bin.children[v * kFanOut + u], units, record, part);
}

void FacetBins::put_here(Bin& bin, const UnitRange& units, std::span<const uint8_t> record, const BinnedPart* part) {
  const uint64_t facets = part ? facets_here(bin.place, units, *part) : 1;
  bin.facets += facets;
  // A part's facets are spread when it is read, so each counts once. Of other facets one of eight stands for all.
  if (bin.place.depth <= 0 && bin.place.depth > rays_.lowest && (part || is_one_of_eight(record))) {
    const uint64_t all = part ? facets : 8;
    bin.looked_at += all;
    bin.copies += part ? facets : all * bins_met(bin.place, units, below(bin.place.depth));
    bin.copies_next += part ? facets : all * bins_met(bin.place, units, bin.place.depth - 1);
  }
  if (bin.buffer.empty()) bin.buffer.resize(bin.room);
  std::memcpy(bin.buffer.data() + bin.of_records, record.data(), record.size());
  bin.of_records += record.size();
  if (bin.of_records + record.size() > bin.room - bin.of_blocks) flush(bin);
  split_if_large(bin);
}

void FacetBins::split_if_large(Bin& bin) {
  if (bin.facets > most_facets_ && split_depth(bin) < bin.place.depth && rooms_ + rooms_of(bin.place, split_depth(bin), bin.room) <= most_rooms_)
    split(bin);
}

// Puts a block into a bin or into those below it.
void FacetBins::put_block(Bin& bin, const ReadyBlock& facts, std::span<const uint8_t> block) {
  if (!bin.wanted) return;
  if (!bin.children.empty()) return put_below(bin, block);
  bin.facets += WeldedRecords::records_in(block);
  bin.looked_at += facts.looked_at, bin.copies += facts.copies, bin.copies_next += facts.copies_next;
  if (block.size() > bin.room) {
    bin.pieces.push_back(log_.add(block));
  } else {
    if (block.size() > bin.room - bin.of_blocks - bin.of_records) flush(bin);
    if (bin.buffer.empty()) bin.buffer.resize(bin.room);
    bin.of_blocks += block.size();
    std::ranges::copy(block, bin.buffer.end() - static_cast<ptrdiff_t>(bin.of_blocks));
    if (bin.of_records + record_bytes_ > bin.room - bin.of_blocks) flush(bin);
  }
  split_if_large(bin);
}

// Puts the records of a block into bins, each for itself.
void FacetBins::put_facets(Bin& bin, const WeldedRecords& block) {
  std::array<uint8_t, kMostOfRecord> room;
  const std::span<uint8_t> record(room.data(), record_bytes_);
  block.for_each_run([&](size_t first, size_t last, std::span<const uint8_t> rest) {
    std::ranges::copy(rest, record.end() - static_cast<ptrdiff_t>(rest.size()));
    for (size_t i = first; i < last; ++i) {
      for (size_t k = 0; k < 3; ++k)
        std::ranges::copy(block.vertex(block.vertices_of(i)[k]), record.begin() + static_cast<ptrdiff_t>(k * shape_.vertex));
      put(bin, units_of(record), record, is_part(tag_in(rest)) ? &part_in(record) : nullptr);
    }
  });
}

bool FacetBins::meets(const TreePlace& place, const UnitRange& units) const {
  const int shift = rays_.shift(place.depth);
  const auto meets = [shift](uint64_t first, uint64_t last, uint32_t at) { return first >> shift <= at && last >> shift >= at; };
  return meets(units.first_u, units.last_u, place.cu) && meets(units.first_v, units.last_v, place.cv);
}

FacetBins::Children FacetBins::children_of(const Bin& bin, const UnitRange& units) const {
  const int shift = rays_.shift(bin.place.depth - 1);
  const uint32_t u = bin.place.cu * kFanOut, v = bin.place.cv * kFanOut;
  return {std::max(units.first_u >> shift, u) - u, std::min((units.last_u >> shift) - u, kFanOut - 1), std::max(units.first_v >> shift, v) - v,
          std::min((units.last_v >> shift) - v, kFanOut - 1)};
}

// How many bins below a node have a facet, counting those outside the range.
uint32_t FacetBins::bins_of(const Bin& bin, const UnitRange& units) const {
  if (bin.children.empty()) return 1;
  uint32_t bins = 0;
  const Children in = children_of(bin, units);
  for (uint32_t v = in.v0; v <= in.v1; ++v)
    for (uint32_t u = in.u0; u <= in.u1; ++u) bins += bins_of(bin.children[v * kFanOut + u], units);
  return bins;
}

void FacetBins::flush(Bin& bin) {
  if (bin.of_records > 0) {
    welder_.weld(std::span(bin.buffer).first(bin.of_records), block_);
    bin.pieces.push_back(log_.add(block_));
  }
  if (bin.of_blocks > 0) bin.pieces.push_back(log_.add(std::span(bin.buffer).last(bin.of_blocks)));
  bin.of_records = bin.of_blocks = 0;
}

int FacetBins::below(int depth) const { return std::min(depth - 1, fine_); }

// In how many nodes of a depth below a place something with these units lies. REQUIRES: it meets the place.
uint64_t FacetBins::bins_met(const TreePlace& place, const UnitRange& units, int depth) const {
  const int shift = rays_.shift(depth), levels = kFanOutBits * (place.depth - depth);
  const auto met = [&](uint64_t first, uint64_t last, uint64_t at) {
    return std::min(last >> shift, ((at + 1) << levels) - 1) - std::max(first >> shift, at << levels) + 1;
  };
  return met(units.first_u, units.last_u, place.cu) * met(units.first_v, units.last_v, place.cv);
}

// The depth of the bins that a bin is to be split into, or its own. A group is split only where most facets then lie in one bin: large ones would
// lie in all of them.
int FacetBins::split_depth(const Bin& bin) const {
  const int depth = bin.place.depth;
  if (depth == rays_.lowest) return depth;
  if (depth > 0 || bin.copies < 2 * bin.looked_at) return below(depth);
  return bin.copies_next < 2 * bin.looked_at ? depth - 1 : depth;
}

// The buffer of each bin that a place with one buffer is divided into, and all of them.
size_t FacetBins::room_of(const TreePlace& place, int depth, size_t room) const { return room_in(room / bins_below(place, depth)); }
uint64_t FacetBins::rooms_of(const TreePlace& place, int depth, size_t room) const { return bins_below(place, depth) * room_of(place, depth, room); }

void FacetBins::split(Bin& bin) {
  flush_all(bin);
  log_.finish();
  Bin whole = std::move(bin);
  bin = {.place = whole.place};
  const int depth = split_depth(whole);
  rooms_ += rooms_of(bin.place, depth, whole.room);
  open(bin, depth, room_of(bin.place, depth, whole.room));
  take_blocks(whole, [&](std::span<const uint8_t> block) { put_below(bin, block); });
}

void FacetBins::finish() {
  flush_all(root_);
  split_large(root_);
  log_.finish();
}

// Splits what was left whole because all its buffers would have taken too much memory, one bin after another.
void FacetBins::split_large(Bin& bin) {
  if (bin.children.empty() && bin.facets > most_facets_ && split_depth(bin) < bin.place.depth) {
    rooms_ = 0;  // all that was in buffers is written
    split(bin);
    flush_all(bin);
  }
  for (Bin& child : bin.children) split_large(child);
}

void FacetBins::flush_all(Bin& bin) {
  flush(bin);
  bin.buffer = std::vector<uint8_t>();  // = {} would keep the memory
  for (Bin& child : bin.children) flush_all(child);
}

const FacetBins::Bin& FacetBins::bin_at(const TreePlace& place) const {
  const Bin* bin = &root_;
  while (bin->place.depth > place.depth && !bin->children.empty()) {
    const int up = kFanOutBits * (bin->place.depth - 1 - place.depth);
    bin = &bin->children[(place.cv >> up) % kFanOut * kFanOut + (place.cu >> up) % kFanOut];
  }
  return *bin;
}

void FacetBins::for_each_bin(const TreePlace& place, const std::function<void(const TreePlace&)>& f) const {
  const auto visit = [&](const auto& self, const Bin& bin) -> void {
    if (bin.children.empty() && bin.facets > 0) f(bin.place);
    for (const Bin& child : bin.children) self(self, child);
  };
  visit(visit, bin_at(place));
}

void FacetBins::take_blocks(Bin& bin, const std::function<void(std::span<const uint8_t>)>& f) {
  std::vector<uint8_t> room;
  for (const PieceLog::Piece& piece : bin.pieces) WeldedRecords::for_each(log_.read(piece, room), f);
  bin.pieces = std::vector<PieceLog::Piece>();
}

uint32_t FacetBins::tag_in(std::span<const uint8_t> rest) {
  uint32_t tag;
  std::memcpy(&tag, rest.data(), sizeof tag);
  return tag;
}

uint32_t FacetBins::patch_in(std::span<const uint8_t> rest) const {
  uint32_t patch = 0;
  if (patches_) std::memcpy(&patch, rest.data() + sizeof patch, sizeof patch);
  return patch;
}

const BinnedPart& FacetBins::part_in(std::span<const uint8_t> record) const {
  uint32_t number;
  std::memcpy(&number, record.data(), sizeof number);
  return parts_[number];
}

Vec3 FacetBins::vertex_in(std::span<const uint8_t> bytes) const {
  return float32_ ? vertex_of<float>(bytes.data()) : vertex_of<double>(bytes.data());
}

}  // namespace teracell::mesher

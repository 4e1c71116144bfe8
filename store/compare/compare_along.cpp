// Two grids whose rays lie along the same axis: chunk by chunk of the first one. Where the chunks of both lie alike, the index often says
// all: equal chunks, chunks of one material, and how many cells of which materials face one material.
#include <algorithm>
#include <deque>

#include <fmt/format.h>

#include "store/base/in_order.hpp"
#include "store/compare/chunk_comparison.hpp"
#include "store/read/kept_chunks.hpp"
#include "store/runs/chunk_parts.hpp"

namespace teracell::inline store {
namespace {

constexpr size_t kKeptBytes = size_t{96} << 20;  // of the second grid's chunks, where several chunks of the first one lie in one of them
constexpr uint32_t kBlockRays = 256, kBlockChunks = 4096;
// Runs take some thirty times as much memory as in a frame, and what is held of them twice.
constexpr uint64_t kMemoryOfFrame = 64;

// The chunks of the second grid that meet a chunk of the first one.
class OtherChunks {
 public:
  OtherChunks(const GridReader& reader, const std::vector<MaterialName>& names, KeptChunks& kept)
      : reader_(reader), shape_(reader.shape(0)), names_(names), kept_(kept) {}

  void load(const RayBox& box) {
    u0_ = box.u0, v0_ = box.v0, first_u_ = box.u0 / shape_.chunk_rays, first_v_ = box.v0 / shape_.chunk_rays;
    width_ = (box.u1 - 1) / shape_.chunk_rays - first_u_ + 1;
    first_segment_ = box.w0 / shape_.chunk_cells;
    segments_ = static_cast<size_t>((box.w1 - 1) / shape_.chunk_cells - first_segment_ + 1);
    const int64_t height = (box.v1 - 1) / shape_.chunk_rays - first_v_ + 1;
    chunks_.resize(static_cast<size_t>(width_ * height) * segments_);
    for_each_part(shape_, box, [&](const ChunkPart& p) {
      NamedChunk& chunk = chunks_[place(p.key.cu, p.key.cv) + static_cast<size_t>(p.key.segment - first_segment_)];
      chunk.set(p.whole ? read(p.key) : kept_.get(p.key, [&] { return read(p.key); }), names_, p.key.segment * shape_.chunk_cells);
    });
  }

  // Ray (u, v) of the box. The runs hold until the next call.
  NamedRuns ray(uint32_t u, uint32_t v) {
    const auto ray_u = static_cast<uint32_t>(u0_ + u), ray_v = static_cast<uint32_t>(v0_ + v);
    const uint32_t cu = ray_u / shape_.chunk_rays, cv = ray_v / shape_.chunk_rays;
    const uint32_t ray = ray_v % shape_.chunk_rays * shape_.rays_u(cu) + ray_u % shape_.chunk_rays;
    const NamedChunk* const chunk = &chunks_[place(cu, cv)];
    if (segments_ == 1) return chunk->ray(ray);
    runs_.clear();
    ends_.clear();
    for (size_t s = 0; s < segments_; ++s) {
      const NamedRuns part = chunk[s].ray(ray);
      if (s > 0) ends_.push_back(part.first);
      for (uint32_t i = 0; i < part.changes; ++i) ends_.push_back(part.end(i));
      runs_.insert(runs_.end(), part.names, part.names + part.changes + 1);
    }
    return {runs_.data(), ends_.data(), static_cast<uint32_t>(ends_.size()), 0};
  }

 private:
  size_t place(int64_t cu, int64_t cv) const { return static_cast<size_t>((cv - first_v_) * width_ + cu - first_u_) * segments_; }
  std::shared_ptr<const Chunk> read(const ChunkKey& key) const {
    auto chunk = std::make_shared<Chunk>();
    reader_.read(key, *chunk);
    return chunk;
  }

  const GridReader& reader_;
  const LevelShape shape_;
  const std::vector<MaterialName>& names_;
  KeptChunks& kept_;
  int64_t u0_ = 0, v0_ = 0, first_u_ = 0, first_v_ = 0, width_ = 0, first_segment_ = 0;
  size_t segments_ = 0;
  std::vector<NamedChunk> chunks_;
  std::vector<MaterialName> runs_;
  std::vector<uint32_t> ends_;
};

// The chunks of the first grid, a block of them after the other, so that neighbours share chunks of the second grid.
class BlocksOfChunks {
 public:
  explicit BlocksOfChunks(const LevelShape& s)
      : s_(s),
        side_(std::max<uint32_t>(1, kBlockRays / s.chunk_rays)),
        depth_(std::max<uint32_t>(1, kBlockChunks / (side_ * side_))),
        blocks_{parts(s.chunks_u, side_), parts(s.chunks_v, side_), parts(s.segments, depth_)} {}
  uint64_t blocks() const { return blocks_[0] * blocks_[1] * blocks_[2]; }
  std::vector<ChunkKey> block(uint64_t i) const {
    std::vector<ChunkKey> out;
    const uint64_t s0 = i % blocks_[2] * depth_, u0 = i / blocks_[2] % blocks_[0] * side_, v0 = i / blocks_[2] / blocks_[0] * side_;
    for (uint64_t s = s0; s < std::min<uint64_t>(s0 + depth_, s_.segments); ++s)
      for (uint64_t v = v0; v < std::min<uint64_t>(v0 + side_, s_.chunks_v); ++v)
        for (uint64_t u = u0; u < std::min<uint64_t>(u0 + side_, s_.chunks_u); ++u)
          out.push_back({0, static_cast<uint32_t>(u), static_cast<uint32_t>(v), static_cast<uint32_t>(s)});
    return out;
  }

 private:
  static uint64_t parts(uint64_t whole, uint64_t part) { return (whole + part - 1) / part; }
  const LevelShape& s_;
  const uint32_t side_, depth_;
  const std::array<uint64_t, 3> blocks_;
};

class CompareAlong {
 public:
  explicit CompareAlong(const GridComparison& c)
      : c_(c),
        shape_(c.a.shape(0)),
        other_(c.b.shape(0)),
        alike_(shape_.chunk_rays == other_.chunk_rays && shape_.chunk_cells == other_.chunk_cells) {}

  void run() {
    KeptChunks kept(kKeptBytes);
    std::deque<ChunkComparison> comparisons;
    std::deque<OtherChunks> others;
    for (int i = 0; i < c_.threads; ++i) comparisons.emplace_back(c_), others.emplace_back(c_.b, c_.names.of_b, kept);
    const BlocksOfChunks all(shape_);
    struct Result {
      double share;
      std::vector<FoundChanges> known;  // by the index
      std::optional<FoundChanges> found;
    };
    struct Job {
      Result result;
      std::optional<PartToRead> part;
    };
    uint64_t next_block = 0;
    size_t next = 0;
    std::vector<PartToRead> left;  // of the block, what the index does not decide
    in_order(
        c_.threads,
        [&]() -> std::optional<Job> {
          Job job;
          job.result.share = static_cast<double>(next_block) / static_cast<double>(all.blocks());
          if (next == left.size()) {
            if (next_block == all.blocks()) return std::nullopt;
            left = undecided(all.block(next_block++), job.result.known);
            next = 0;
          }
          if (next < left.size()) job.part = left[next++];
          return job;
        },
        [&](Job job, int worker) {
          if (!job.part) return std::move(job.result);
          const auto& [key, w0, w1] = *job.part;
          RayBox box(box_of(key), c_.a.meta().frame());
          box.w0 = w0, box.w1 = w1;
          OtherChunks& other = others[static_cast<size_t>(worker)];
          other.load(box);
          job.result.found = comparisons[static_cast<size_t>(worker)].compare(key, w0, w1, [&](uint32_t u, uint32_t v) { return other.ray(u, v); });
          return std::move(job.result);
        },
        [&](Result result) {
          for (FoundChanges& f : result.known) c_.found(std::move(f));
          if (result.found) c_.found(std::move(*result.found));
          c_.progress(result.share);
        },
        16);
  }

 private:
  // A chunk of the first grid, or the cells [w0, w1) of its rays.
  struct PartToRead {
    ChunkKey key;
    uint32_t w0, w1;
  };

  Box box_of(const ChunkKey& key) const {
    const RayFrame f = c_.a.meta().frame();
    const int64_t u = int64_t{key.cu} * shape_.chunk_rays, v = int64_t{key.cv} * shape_.chunk_rays, w = int64_t{key.segment} * shape_.chunk_cells;
    return f.box({u, v, w}, {u + shape_.rays_u(key.cu), v + shape_.rays_v(key.cv), w + shape_.length(key.segment)});
  }

  // What has to be read of the chunks of a block. What the index says of the others goes to `known`.
  std::vector<PartToRead> undecided(std::vector<ChunkKey> keys, std::vector<FoundChanges>& known) const {
    const bool far = c_.a.source().is_far() || c_.b.source().is_far();
    if (far)
      for (const GridReader* reader : {&c_.a, &c_.b}) reader->prefetch(0, around(keys), false);
    if (alike_) std::erase_if(keys, [&](const ChunkKey& key) { return decide(key, known); });
    if (far && !keys.empty())
      for (const GridReader* reader : {&c_.a, &c_.b}) {
        std::vector<ByteRange> soon;
        for (const ChunkKey& key : keys)
          for_each_part(reader->shape(0), RayBox(box_of(key), c_.a.meta().frame()), [&](const ChunkPart& p) {
            if (const auto e = reader->entry(p.key); e->size != 0) soon.push_back({e->offset, e->size});
          });
        reader->source().prefetch(soon);
      }
    std::vector<PartToRead> out;
    for (const ChunkKey& key : keys) add_parts(key, out);
    return out;
  }

  // Chunks of the second grid may be much shorter than one of the first, and hold much more. Then it is compared in parts, and decoded for
  // each of them.
  void add_parts(const ChunkKey& key, std::vector<PartToRead>& out) const {
    const uint32_t first = key.segment * shape_.chunk_cells, end = first + shape_.length(key.segment);
    PartToRead part{key, first, end};
    const uint64_t most = c_.memory / kMemoryOfFrame / static_cast<uint64_t>(c_.threads);
    uint64_t bytes = 0;
    if (other_.chunk_cells < shape_.chunk_cells)
      for_each_part(other_, RayBox(box_of(key), c_.a.meta().frame()), [&](const ChunkPart& p) {  // segment by segment
        const auto w0 = static_cast<uint32_t>(p.first_w + p.w0);
        if (bytes > most && w0 > part.w0 && p.w0 == 0) {
          part.w1 = w0;
          out.push_back(part);
          part = {key, w0, end};
          bytes = 0;
        }
        bytes += c_.b.entry(p.key)->size;
      });
    out.push_back(part);
  }

  Box around(const std::vector<ChunkKey>& keys) const {
    Box box = box_of(keys.front());
    box.hi = box_of(keys.back()).hi;
    return box;
  }

  // Whether the index says all of the chunk.
  bool decide(const ChunkKey& key, std::vector<FoundChanges>& known) const {
    const auto a = c_.a.entry(key), b = c_.b.entry(key);
    const auto &name_a = c_.names.of_a, &name_b = c_.names.of_b;
    if (a->size != 0 && a->size == b->size && a->checksum == b->checksum && a->stats == b->stats)
      return std::ranges::all_of(a->stats, [&](const LabelStats& l) { return name_a[l.label] == name_b[l.label]; });
    const auto one_name = [](const ChunkEntry& e, const std::vector<MaterialName>& names) -> std::optional<MaterialName> {
      if (e.size == 0) return names[e.uniform[0]];
      for (const LabelStats& l : e.stats)
        if (names[l.label] != names[e.stats[0].label]) return std::nullopt;
      return e.stats.empty() ? std::nullopt : std::optional(names[e.stats[0].label]);
    };
    const auto in_a = one_name(*a, name_a), in_b = one_name(*b, name_b);
    if (in_a && in_a == in_b) return true;
    if (c_.with_cells || (!in_a && !in_b)) return false;
    const ChunkEntry& e = in_a ? *b : *a;  // the other one has one material, or both have
    const auto& [lo, hi] =
        std::pair(std::array<uint32_t, 3>{0, 0, 0}, std::array{shape_.rays_u(key.cu), shape_.rays_v(key.cv), shape_.length(key.segment)});
    FoundChanges out{key, key.segment * shape_.chunk_cells, hi[2], {}, {}};
    const std::vector<LabelStats> whole = {{e.size == 0 ? e.uniform[0] : 0, uint64_t{hi[0]} * hi[1] * hi[2], lo, hi}};
    for (LabelStats l : e.size == 0 ? whole : e.stats) {
      for (int d = 0; d < 3; ++d)
        if (l.hi[d] > hi[d])
          throw FormatError(fmt::format("{}: {}: its statistics reach outside of it", (in_a ? c_.b : c_.a).name(), chunk_name(key)));
      const MaterialName from = in_a ? *in_a : name_a[l.label], to = in_a ? name_b[l.label] : *in_b;
      if (from == to) continue;
      l.label = c_.numbers.of(from, to);
      out.stats.push_back(l);
    }
    known.push_back(std::move(out));
    return true;
  }

  const GridComparison& c_;
  const LevelShape shape_, other_;
  const bool alike_;
};

}  // namespace

void compare_along(const GridComparison& c) { CompareAlong(c).run(); }

}  // namespace teracell::store

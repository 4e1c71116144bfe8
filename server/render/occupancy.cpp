#include "server/render/occupancy.hpp"

#include "store/base/bit_words.hpp"
#include "store/base/in_order.hpp"
#include "store/base/wanted.hpp"
#include "store/grid/set_memo.hpp"

namespace teracell::server {
namespace {

size_t words_per_ray(uint32_t cells) { return (size_t{cells} + 63) / 64; }

}  // namespace

Occupancy::Bits::Bits(const LevelShape& shape)
    : nu(shape.nu), nv(shape.nv), nw(shape.nw), per_ray(words_per_ray(nw)), words(size_t{nu} * nv * per_ray) {}

Occupancy::Occupancy(const GridReader& reader, const Visible& visible, int level, int threads) : first_(level) {
  size_for(reader);
  read(reader, visible, threads);
  for (size_t i = 1; i < levels_.size(); ++i) halve(levels_[i - 1], levels_[i]);
}

Occupancy::Occupancy(const GridReader& reader, int level, const std::function<uint32_t(int, const Index3&)>& seen) : first_(level) {
  size_for(reader);
  const RayFrame frame = reader.meta().frame();
  Bits& bits = levels_.front();
  std::function<void(int, const Index3&)> fill = [&](int at, const Index3& cell) {
    if (seen(at, cell) == 0) return;
    if (at == first_) {
      const size_t w = static_cast<size_t>(cell[frame.w]);
      bits.words[(static_cast<size_t>(cell[frame.v]) * bits.nu + static_cast<size_t>(cell[frame.u])) * bits.per_ray + w / 64] |= uint64_t{1}
                                                                                                                                 << (w % 64);
      return;
    }
    Wanted::stop_if_not();
    int finer = at - 1;
    while (finer > first_ && !reader.stored(finer)) --finer;
    const Index3 n = reader.meta().grid.cells(finer);
    const int shift = at - finer;
    Index3 lo, hi, c;
    for (int d = 0; d < 3; ++d) lo[d] = cell[d] << shift, hi[d] = std::min((cell[d] + 1) << shift, n[d]);
    for (c[2] = lo[2]; c[2] < hi[2]; ++c[2])
      for (c[1] = lo[1]; c[1] < hi[1]; ++c[1])
        for (c[0] = lo[0]; c[0] < hi[0]; ++c[0]) fill(finer, c);
  };
  fill(reader.levels() - 1, {0, 0, 0});
  for (size_t i = 1; i < levels_.size(); ++i) halve(levels_[i - 1], levels_[i]);
}

void Occupancy::size_for(const GridReader& reader) {
  const auto too_many = [&] {
    const LevelShape shape = reader.shape(first_);
    return double{1} * shape.nu * shape.nv * static_cast<double>(words_per_ray(shape.nw)) > kMostWords;
  };
  while (too_many()) ++first_;
  for (int l = first_; l < reader.levels(); ++l) levels_.emplace_back(reader.shape(l));
}

void Occupancy::read(const GridReader& reader, const Visible& visible, int threads) {
  const LevelShape shape = reader.shape(first_);
  try {
    reader.prefetch(first_, reader.meta().grid.box(first_));
  } catch (const FormatError&) {  // the chunks that can be read are read below
    if (!visible.shows_damage()) throw;
  }
  Bits& bits = levels_.front();
  std::vector<std::shared_ptr<Chunk>> scratch(threads);
  uint64_t next = 0;
  const uint64_t columns = uint64_t{shape.chunks_u} * shape.chunks_v;
  // Segments of a column share words, so one thread takes all of them.
  in_order(
      threads,
      [&]() -> std::optional<uint64_t> {
        Wanted::stop_if_not();
        return next < columns ? std::optional(next++) : std::nullopt;
      },
      [&](uint64_t column, int worker) {
        const auto cu = static_cast<uint32_t>(column % shape.chunks_u), cv = static_cast<uint32_t>(column / shape.chunks_u);
        for (uint32_t segment = 0; segment < shape.segments; ++segment) {
          const ChunkKey key{first_, cu, cv, segment};
          const uint32_t w0 = segment * shape.chunk_cells;
          const auto ray_words = [&](uint32_t u, uint32_t v) {
            return &bits.words[((size_t{cv} * shape.chunk_rays + v) * bits.nu + size_t{cu} * shape.chunk_rays + u) * bits.per_ray];
          };
          const auto fill = [&] {
            for (uint32_t v = 0; v < shape.rays_v(cv); ++v)
              for (uint32_t u = 0; u < shape.rays_u(cu); ++u) set_bits(ray_words(u, v), w0, w0 + shape.length(segment));
          };
          try {
            if (const auto set = reader.uniform(key)) {
              if (visible.of(*set) != 0) fill();
              continue;
            }
            const auto chunk = reader.chunk(key, scratch[worker]);
            const RayBlock& rays = chunk->rays;
            SetMemo<bool> known;
            for (uint32_t ray = 0; ray < rays.rays(); ++ray)
              rays.for_each_run(ray, [&](uint32_t from, uint32_t to, SetId set) {
                if (known.get(set, [&] { return visible.of(chunk->sets.members(set)) != 0; }))
                  set_bits(ray_words(ray % rays.nu, ray / rays.nu), w0 + from, w0 + to);
              });
          } catch (const FormatError&) {
            if (!visible.shows_damage()) throw;
            fill();
          }
        }
        return 0;
      },
      [](int) {});
}

size_t Occupancy::memory() const {
  size_t words = 0;
  for (const Bits& bits : levels_) words += bits.words.size();
  return words * sizeof(uint64_t);
}

void Occupancy::halve(const Bits& fine, Bits& coarse) const {
  for (uint32_t v = 0; v < fine.nv; ++v)
    for (uint32_t u = 0; u < fine.nu; ++u) {
      const uint64_t* const from = &fine.words[(size_t{v} * fine.nu + u) * fine.per_ray];
      uint64_t* const to = &coarse.words[(size_t{v / 2} * coarse.nu + u / 2) * coarse.per_ray];
      for (size_t i = 0; i < fine.per_ray; ++i) to[i / 2] |= uint64_t{pairs_of_bits(from[i])} << (32 * (i % 2));
    }
}

}  // namespace teracell::server

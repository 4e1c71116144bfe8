#include "store/channels/fraction_reader.hpp"

#include <algorithm>

#include "store/base/in_order.hpp"
#include "store/runs/chunk_parts.hpp"

namespace teracell::inline store {

FractionReader::FractionReader(const GridReader& reader, std::shared_ptr<FractionCache> cache)
    : reader_(reader),
      chunks_(reader, find_fractions(reader.meta()), kFractions, std::move(cache),
              [this](const ChunkKey& key, const Bytes* frame, MixedCells& out) {
                if (frame) return decode_fractions(reader_.meta(), *find_fractions(reader_.meta()), key, samples_, *frame, out);
                const LevelShape s = reader_.shape(0);
                out.reset(s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), sub_samples(samples_));
                out.begin.resize(size_t{out.nu} * out.nv + 1);
              }),
      samples_(subdivision_of(*find_fractions(reader.meta()))) {}

std::vector<FractionReader::LabelCount> FractionReader::cell(const Index3& c) const {
  const LevelShape s = reader_.shape(0);
  const RayFrame f = reader_.meta().frame();
  const auto u = static_cast<uint32_t>(c[f.u]), v = static_cast<uint32_t>(c[f.v]), w = static_cast<uint32_t>(c[f.w]);
  const auto cells = chunk({0, u / s.chunk_rays, v / s.chunk_rays, w / s.chunk_cells});
  std::vector<LabelCount> out;
  for (const MixedCells::Run& run : cells->of_ray(v % s.chunk_rays * cells->nu + u % s.chunk_rays))
    if (run.from <= w % s.chunk_cells && w % s.chunk_cells < run.to)
      for (size_t i = 0; i < cells->labels(run).size(); ++i) out.push_back({cells->labels(run)[i], cells->counts_of(run)[i]});
  return out;
}

void FractionReader::for_each_mixed(const Box& box, const Visit& visit) const {
  const RayFrame f = reader_.meta().frame();
  chunks_.prefetch(box);
  for_each_part(reader_.shape(0), RayBox(box, f), [&](const ChunkPart& p) {
    const auto mixed = chunk(p.key);
    for_each_ray(p, [&](uint32_t u, uint32_t v) {
      for (const MixedCells::Run& run : mixed->of_ray(v * mixed->nu + u)) {
        const uint32_t from = std::max(run.from, p.w0), to = std::min(run.to, p.w1);
        if (from >= to) continue;
        visit(f.cell(p.first_u + u, p.first_v + v, p.first_w + from), to - from, mixed->labels(run), mixed->counts_of(run));
      }
    });
  });
}

template <class T>
void FractionReader::read_box(const Box& box, uint32_t material, T outside, T* data, const Index3& stride, int threads) const {
  std::vector<double> values(reader_.meta().materials.size());
  values[material] = 1;
  read(box, values, Strangers::kCounted, outside, data, stride, threads);
}

void FractionReader::read_means(const Box& box, std::span<const double> values, double* data, const Index3& stride) const {
  read(box, values, Strangers::kOwn, 0.0, data, stride, 1);
}

template <class T>
void FractionReader::read(const Box& box, std::span<const double> values, Strangers strangers, T outside, T* data, const Index3& stride,
                          int threads) const {
  const Metadata& meta = reader_.meta();
  const RayFrame f = meta.frame();
  Box inner = box;
  const Index3 n = meta.grid.cells();
  for (int d = 0; d < 3; ++d) inner.lo[d] = std::clamp<int64_t>(box.lo[d], 0, n[d]), inner.hi[d] = std::clamp<int64_t>(box.hi[d], inner.lo[d], n[d]);
  const auto place = [&](int64_t x, int64_t y, int64_t z) {
    return data + (x - box.lo[0]) * stride[0] + (y - box.lo[1]) * stride[1] + (z - box.lo[2]) * stride[2];
  };
  if (inner != box)
    for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
      for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
        for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) *place(x, y, z) = outside;
  if (inner.empty()) return;

  reader_.prefetch(0, inner);
  chunks_.prefetch(inner);
  std::vector<ChunkPart> parts;
  for_each_part(reader_.shape(0), RayBox(inner, f), [&](const ChunkPart& p) { parts.push_back(p); });
  const auto value = [&](Label label) { return values[meta.labels[label].material]; };
  size_t next = 0;
  in_order(
      std::min<int>(threads, static_cast<int>(std::min<size_t>(parts.size(), 1024))),
      [&]() -> std::optional<size_t> { return next == parts.size() ? std::nullopt : std::optional(next++); },
      [&](size_t i, int) {
        const ChunkPart& p = parts[i];
        std::shared_ptr<Chunk> scratch;
        const auto labels = reader_.chunk(p.key, scratch);
        const auto mixed = chunk(p.key);
        for_each_ray(p, [&](uint32_t u, uint32_t v) {
          const Index3 cell = f.cell(p.first_u + u, p.first_v + v, p.first_w);
          T* const ray = place(cell[0], cell[1], cell[2]);
          const auto fill = [&](uint32_t from, uint32_t to, T share) {
            for (int64_t w = std::max(from, p.w0); w < std::min(to, p.w1); ++w) ray[w * stride[f.w]] = share;
          };
          const auto for_each_own = [&](uint32_t from, uint32_t to, auto&& take) {
            labels->rays.for_each_run(v * labels->rays.nu + u, from, to, take);
          };
          for_each_own(p.w0, p.w1, [&](uint32_t from, uint32_t to, SetId label) { fill(from, to, static_cast<T>(value(label))); });
          for (const MixedCells::Run& run : mixed->of_ray(v * mixed->nu + u)) {
            const uint32_t begin = std::max(run.from, p.w0), end = std::min(run.to, p.w1);
            if (begin >= end) continue;
            double sum = 0;
            for (size_t k = 0; k < mixed->labels(run).size(); ++k) sum += value(mixed->labels(run)[k]) * mixed->counts_of(run)[k];
            const auto mean = static_cast<T>(sum / mixed->total);
            if (strangers == Strangers::kCounted) fill(begin, end, mean);
            else
              for_each_own(begin, end, [&](uint32_t from, uint32_t to, SetId own) {
                const auto is_own = [&](Label label) { return meta.labels[label].material == meta.labels[own].material; };
                if (std::ranges::any_of(mixed->labels(run), is_own)) fill(from, to, mean);
              });
          }
        });
        return true;
      },
      [](bool) {});
}

template void FractionReader::read_box(const Box&, uint32_t, float, float*, const Index3&, int) const;
template void FractionReader::read_box(const Box&, uint32_t, double, double*, const Index3&, int) const;

}  // namespace teracell::store

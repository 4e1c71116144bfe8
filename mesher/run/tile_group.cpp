#include "mesher/run/tile_group.hpp"

namespace teracell::mesher {

TileGroupWork::TileGroupWork(TileGroup group, const Tiling& tiling, const Metadata& meta, std::shared_ptr<PyramidNode> above)
    : group_(std::move(group)), tiling_(tiling), meta_(meta), shape_(meta, 0), above_(std::move(above)), chunks_(kChildren + 1) {}

void TileGroupWork::make_row(uint32_t row, Worker& worker) {
  const auto facets = tiling_.split(group_, row);
  const uint64_t exact_before = worker.exact_decisions();
  for (uint32_t u = 0; u < kFanOut; ++u)
    if (group_.cu * kFanOut + u < shape_.chunks_u && group_.cv * kFanOut + row < shape_.chunks_v) make_chunk(row * kFanOut + u, facets[u], worker);
  totals_[row].exact_decisions = worker.exact_decisions() - exact_before;
  totals_[row].cells = worker.composer.take_cells();
  totals_[row].tallies.add(worker.marker.take_tallies());
  if (--rows_left_ == 0 && meta_.grid.levels() > 2) make_level2(worker);
}

void TileGroupWork::make_chunk(uint32_t i, std::span<const SceneFacet* const> facets, Worker& worker) {
  const uint32_t cu = group_.cu * kFanOut + i % kFanOut, cv = group_.cv * kFanOut + i / kFanOut, nu = shape_.rays_u(cu), nv = shape_.rays_v(cv);
  Chunk& fine = worker.fine;
  if (facets.empty() && !worker.engine->searches_scene()) {  // most tiles of a large grid
    fine.rays.fill(nu, nv, shape_.nw, 0);
  } else {
    const RayFrame f = meta_.frame();
    Tile tile{f, {}, {}, &meta_.grid.axis[f.w]};
    const int64_t first_u = int64_t{cu} * shape_.chunk_rays, first_v = int64_t{cv} * shape_.chunk_rays;
    const Box cells = f.box({first_u, first_v, 0}, {first_u + nu, first_v + nv, shape_.nw});
    tile.u.reserve(nu), tile.v.reserve(nv);
    for (uint32_t u = 0; u < nu; ++u) tile.u.push_back(meta_.grid.axis[f.u].centre(first_u + u));
    for (uint32_t v = 0; v < nv; ++v) tile.v.push_back(meta_.grid.axis[f.v].centre(first_v + v));
    const auto solids = worker.marker.solids(facets);
    worker.engine->cast(tile, solids, worker.crossings);
    totals_[i / kFanOut].crossings += worker.crossings.all.size();
    worker.marker.mark(tile, cells, worker.crossings);
    worker.composer.compose(worker.crossings, nu, nv, shape_.nw, fine.rays);
    tally_pairs(worker.composer.crossing_pairs(), cells, totals_[i / kFanOut].tallies);
    totals_[i / kFanOut].overlaps.add(worker.composer.take_overlaps(cells));
    make_frames(i, cells, facets, fine.rays, worker);
  }
  pieces_[i] = worker.coarsener.coarsen(fine, 2);
  chunks_[i] = encode_level(worker.encoder, meta_, 0, cu, cv, fine);
  totals_[i / kFanOut].labels += worker.adder.sum({0, cu, cv, 0}, fine.rays);
}

void TileGroupWork::add_amounts(CellSums& sums) const {
  const RayFrame f = meta_.frame();
  for (const LevelChunk& tile : std::span(chunks_).first(kChildren))
    for (uint32_t s = 0; s < tile.segments.size(); ++s) sums.add_amounts(shape_, f, {0, tile.cu, tile.cv, s}, tile.segments[s].entry);
}

// In the order of the channels (plan.cpp).
void TileGroupWork::make_frames(uint32_t i, const Box& cells, std::span<const SceneFacet* const> facets, const RayBlock& runs, Worker& worker) {
  if (worker.fractions) {
    worker.fractions->count({cells, worker.crossings.all.size(), &runs}, worker.marker.solids(facets), *worker.engine, worker.mixed);
    if (worker.sums_shares) add_shares(worker.mixed, runs, totals_[i / kFanOut].shares);
    std::vector<Bytes>& out = frames_[i].emplace_back();
    for (uint32_t s = 0; s < shape_.segments; ++s) {
      const uint32_t from = s * shape_.chunk_cells;
      const MixedCells& part = shape_.segments == 1 ? worker.mixed : worker.mixed_part = cut(worker.mixed, from, from + shape_.length(s));
      out.push_back(part.empty() ? Bytes() : worker.mixed_encoder.encode(part));
    }
  }
  if (worker.links) {
    std::vector<Bytes>& out = frames_[i].emplace_back(shape_.segments);
    if (!facets.empty())
      worker.links->find({cells, &worker.crossings, &runs}, facets, *worker.engine, shape_.chunk_cells,
                         [&](uint32_t segment, const ChunkLinks& links) {
                           if (!links.empty()) out[segment] = worker.links_encoder.encode(links);
                         });
  }
}

void TileGroupWork::tally_pairs(const std::vector<CrossingPairs>& all, const Box& cells, Tallies& tallies) const {
  const RayFrame f = meta_.frame();
  const int64_t nu = cells.hi[f.u] - cells.lo[f.u];
  for (size_t i = 0; i < all.size();) {
    const TallyKey key{TallyKey::What::kPairs, all[i].body, static_cast<uint8_t>(f.w)};
    Tally sum;
    for (; i < all.size() && all[i].body == key.of; ++i) {
      const Index3 lower = f.cell(cells.lo[f.u] + all[i].ray % nu, cells.lo[f.v] + all[i].ray / nu, int64_t{all[i].cell} - 1);
      sum.add({all[i].pairs, 0, kSubPositions, 0, lower});
    }
    tallies.add(key, sum);
  }
}

void TileGroupWork::make_level2(Worker& worker) {
  const Chunk level2 = join_pieces(pieces_.data(), kFanOut, kFanOut, meta_.chunk_rays, static_cast<uint32_t>(meta_.labels.size()));
  pieces_ = {};
  chunks_[kChildren] = encode_level(worker.encoder, meta_, 2, group_.cu, group_.cv, level2);
  if (above_) above_->add(group_.cu, group_.cv, worker.coarsener.coarsen(level2, 1), worker.encoder);
}

}  // namespace teracell::mesher

#include "mesher/unit.hpp"

#include "store/pyramid.hpp"

namespace teracell {

void CastTotals::add(const CastTotals& other) {
  crossings += other.crossings;
  exact_decisions += other.exact_decisions;
  cells.resize(std::max(cells.size(), other.cells.size()));
  covered.resize(cells.size());
  for (size_t b = 0; b < other.cells.size(); ++b) cells[b] += other.cells[b], covered[b] += other.covered[b];
}

UnitWork::UnitWork(Unit unit, const Tiling& tiling, const Metadata& meta)
    : unit_(std::move(unit)), tiling_(tiling), meta_(meta), shape_(meta, 0), chunks_(17) {}

void UnitWork::make_row(uint32_t row, Worker& worker) {
  const auto facets = tiling_.split(unit_, row);
  const uint64_t exact_before = worker.engine->exact_decisions();
  for (uint32_t u = 0; u < 4; ++u)
    if (unit_.cu * 4 + u < shape_.chunks_u && unit_.cv * 4 + row < shape_.chunks_v) make_chunk(row * 4 + u, facets[u], worker);
  totals_[row].exact_decisions = worker.engine->exact_decisions() - exact_before;
  totals_[row].cells = worker.composer.take_cells();
  totals_[row].covered = worker.composer.take_covered();
  if (--rows_left_ == 0 && meta_.grid.levels() > 2) make_level2(worker);
}

void UnitWork::make_chunk(uint32_t i, std::span<const SceneFacet* const> facets, Worker& worker) {
  const uint32_t cu = unit_.cu * 4 + i % 4, cv = unit_.cv * 4 + i / 4, nu = shape_.rays_u(cu), nv = shape_.rays_v(cv);
  Chunk fine{{}, SetTable(static_cast<uint32_t>(meta_.labels.size()))};
  if (facets.empty() && !worker.engine->searches_scene()) {  // most tiles of a large grid
    fine.rays.fill(nu, nv, shape_.nw, 0);
  } else {
    const Frame f = meta_.frame();
    Tile tile{f, {}, {}, &meta_.grid.axis[f.w]};
    for (uint32_t u = 0; u < nu; ++u) tile.u.push_back(meta_.grid.axis[f.u].centre(cu * shape_.chunk_rays + u));
    for (uint32_t v = 0; v < nv; ++v) tile.v.push_back(meta_.grid.axis[f.v].centre(cv * shape_.chunk_rays + v));
    worker.engine->cast(tile, facets, worker.crossings);
    totals_[i / 4].crossings += worker.crossings.all.size();
    worker.composer.compose(worker.crossings, nu, nv, shape_.nw, fine.rays);
  }
  pieces_[i] = coarsen(fine, 2);
  chunks_[i] = encode_level(worker.encoder, meta_, 0, cu, cv, fine);
}

CastTotals UnitWork::totals() const {
  CastTotals sum;
  for (const CastTotals& row : totals_) sum.add(row);
  return sum;
}

void UnitWork::make_level2(Worker& worker) {
  const Chunk level2 = join_pieces(pieces_.data(), 4, 4, meta_.chunk_rays, static_cast<uint32_t>(meta_.labels.size()));
  pieces_ = {};
  chunks_[16] = encode_level(worker.encoder, meta_, 2, unit_.cu, unit_.cv, level2);
  coarse_ = coarsen(level2, 1);
}

}  // namespace teracell

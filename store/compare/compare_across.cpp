// Two grids whose rays lie along different axes. The first grid's axes are w, along its rays, b, along the rays of the second grid, and t.
// A band of planes across t is taken at a time: in it, the second grid's runs along b are turned into runs along w (turned_runs.hpp),
// which are compared with those of the first grid. Each chunk of the second grid is decoded once for each band that it meets, and each
// chunk of the first one once for as many rows of the second grid as memory holds, which is nearly always all rows.
#include <algorithm>
#include <atomic>
#include <deque>

#include "store/base/in_order.hpp"
#include "store/compare/chunk_comparison.hpp"
#include "store/runs/turned_runs.hpp"

namespace teracell::inline store {
namespace {

constexpr size_t kMostChangesOfPlane = size_t{1} << 18, kSweepBytes = 12;  // a change while its plane is swept
constexpr uint32_t kLeastBlock = 4096, kFetchedAhead = 16;

uint32_t round_up(uint64_t n, uint32_t by) { return static_cast<uint32_t>((n + by - 1) / by * by); }

// Chunks of the second grid: rows of them along w.
struct LoadedChunks {
  uint32_t row0, row1, tile0, tiles, segment0, segments;  // along w, t and b
  std::vector<NamedChunk> chunks;
  const NamedChunk& at(uint32_t row, uint32_t tile, uint32_t segment) const {
    return chunks[(size_t{row - row0} * tiles + tile - tile0) * segments + segment - segment0];
  }
};

class CompareAcross {
 public:
  explicit CompareAcross(const GridComparison& c)
      : c_(c),
        frame_(c.a.meta().frame()),
        other_frame_(c.b.meta().frame()),
        b_(other_frame_.w),
        t_(3 - b_ - frame_.w),
        shape_(c.a.shape(0)),
        other_(c.b.shape(0)),
        cells_(c.a.meta().grid.cells()),
        sweeps_(static_cast<size_t>(c.threads)) {
    for (int i = 0; i < c.threads; ++i) comparisons_.emplace_back(c);
  }

  void run() {
    const auto nt = static_cast<uint32_t>(cells_[t_]), nb = static_cast<uint32_t>(cells_[b_]), nw = shape_.nw;
    const uint32_t band = round_up(other_.chunk_rays, shape_.chunk_rays);
    const uint32_t block = round_up(std::max(other_.chunk_cells, kLeastBlock), shape_.chunk_rays);
    for (uint64_t t0 = 0; t0 < nt; t0 += band) {
      t0_ = static_cast<uint32_t>(t0), t1_ = static_cast<uint32_t>(std::min<uint64_t>(t0 + band, nt));
      planes_.resize(t1_ - t0_);
      for (uint64_t b0 = 0; b0 < nb; b0 += block) {
        const auto b1 = static_cast<uint32_t>(std::min<uint64_t>(b0 + block, nb));
        for (uint32_t w0 = 0; w0 < nw;) {
          load(static_cast<uint32_t>(b0), b1, w0 / other_.chunk_rays);
          const auto w1 = static_cast<uint32_t>(std::min<uint64_t>(uint64_t{loaded_.row1} * other_.chunk_rays, nw));
          const double in_block = static_cast<double>(w0) / nw, in_band = (static_cast<double>(b0) + in_block * (b1 - static_cast<double>(b0))) / nb;
          share_ = (t0_ + in_band * (t1_ - t0_)) / nt;
          compare_rows(static_cast<uint32_t>(b0), b1, w0, w1);
          w0 = w1;
        }
      }
    }
  }

 private:
  Box box(uint32_t b0, uint32_t b1, uint32_t w0, uint32_t w1) const {
    Box out;
    out.lo[t_] = t0_, out.hi[t_] = t1_;
    out.lo[b_] = b0, out.hi[b_] = b1;
    out.lo[frame_.w] = w0, out.hi[frame_.w] = std::min<int64_t>(w1, shape_.nw);
    return out;
  }

  // The chunks of the band and of [b0, b1), from a row of chunks on, as many rows as half of the memory holds.
  void load(uint32_t b0, uint32_t b1, uint32_t row0) {
    const bool w_is_u = other_frame_.u == frame_.w;
    const uint32_t rows = w_is_u ? other_.chunks_u : other_.chunks_v, size = other_.chunk_rays;
    loaded_ = {row0, row0, t0_ / size, (t1_ - 1) / size - t0_ / size + 1, b0 / other_.chunk_cells, 0, {}};
    loaded_.segments = (b1 - 1) / other_.chunk_cells - loaded_.segment0 + 1;
    const uint64_t in_row = uint64_t{loaded_.tiles} * loaded_.segments;
    std::atomic<size_t> bytes = 0;
    uint64_t next = 0;
    in_order(
        c_.threads,
        [&]() -> std::optional<ChunkKey> {
          const auto row = static_cast<uint32_t>(row0 + next / in_row);
          if (row == rows || (next > 0 && next % in_row == 0 && bytes > c_.memory / 2)) return std::nullopt;
          if (next % (in_row * kFetchedAhead) == 0)
            c_.b.prefetch(0, box(b0, b1, row * size, static_cast<uint32_t>(std::min<uint64_t>(uint64_t{row + kFetchedAhead} * size, shape_.nw))));
          const auto tile = static_cast<uint32_t>(loaded_.tile0 + next % in_row / loaded_.segments);
          const auto segment = static_cast<uint32_t>(loaded_.segment0 + next % loaded_.segments);
          ++next;
          return w_is_u ? ChunkKey{0, row, tile, segment} : ChunkKey{0, tile, row, segment};
        },
        [&](const ChunkKey& key, int) {
          auto chunk = std::make_shared<Chunk>();
          c_.b.read(key, *chunk);
          NamedChunk named;
          named.set(std::move(chunk), c_.names.of_b, key.segment * other_.chunk_cells);
          return named;
        },
        [&](NamedChunk chunk) {
          bytes += chunk.memory();
          loaded_.chunks.push_back(std::move(chunk));
          c_.progress(share_);
        });
    loaded_.row1 = static_cast<uint32_t>(row0 + loaded_.chunks.size() / in_row);
  }

  // Compares the cells of the band in the rows [w0, w1), which are loaded, with as many columns at once as the other half of the
  // memory holds turned. If there is no room for the columns of a single chunk, then with fewer rows.
  void compare_rows(uint32_t b0, uint32_t b1, uint32_t w0, uint32_t w1) {
    const uint32_t side = shape_.chunk_rays;
    const size_t for_plane = c_.memory / 2 / (t1_ - t0_);
    const size_t for_sweeps = c_.memory / 8 / kSweepBytes / static_cast<size_t>(c_.threads);
    const size_t changes = std::max<size_t>(side, std::min({for_plane / 2 / kChangeBytes, for_sweeps, kMostChangesOfPlane}));
    uint32_t width = b1 - b0;
    const auto halve = [&] { width = round_up(width / 2, side); };
    while (width > side && width * kColumnBytes > for_plane / 2) halve();
    for (uint32_t b = b0; b < b1;) {
      uint32_t w = w0, end = std::min<uint32_t>(b + std::min(width, b1 - b), b1);
      while (w < w1) {
        const uint32_t reached = turn(b, end, w, w1, changes);
        if (reached < w1 && end - b > side) {
          width = end - b;
          halve();
          end = b + width;
          continue;
        }
        compare(b, end, w, reached);
        w = reached;
      }
      b = end;
    }
  }

  // Turns the columns [b0, b1) of the rows [w0, w1) of all planes. Returns the end of the rows that all planes have.
  uint32_t turn(uint32_t b0, uint32_t b1, uint32_t w0, uint32_t w1, size_t most) {
    uint32_t next = t0_, reached = w1;
    std::atomic<bool> too_many = false;  // some plane has not reached w1: the others need not go on if they will be turned again
    const bool again = b1 - b0 > shape_.chunk_rays;
    in_order(
        c_.threads, [&] { return next == t1_ || (again && too_many) ? std::nullopt : std::optional(next++); },
        [&](uint32_t t, int worker) {
          const uint32_t end = sweeps_[static_cast<size_t>(worker)].turn(rows_of(t), b0, b1, w0, w1, most, planes_[t - t0_]);
          if (end < w1) too_many = true;
          return end;
        },
        [&](uint32_t end) { reached = std::min(reached, end); });
    return reached;
  }

  RowSweep::Rows rows_of(uint32_t t) const {
    RowSweep::Rows rows{{}, other_.chunk_rays, {}};
    for (uint32_t s = loaded_.segment0; s < loaded_.segment0 + loaded_.segments; ++s) rows.ends.push_back(s * other_.chunk_cells + other_.length(s));
    const bool w_is_u = other_frame_.u == frame_.w;
    const uint32_t tile = t / other_.chunk_rays, in_tile = t % other_.chunk_rays;
    rows.chunk = [this, w_is_u, tile, in_tile](size_t stretch, uint32_t row) {
      const NamedChunk& chunk = loaded_.at(row / other_.chunk_rays, tile, static_cast<uint32_t>(loaded_.segment0 + stretch));
      return w_is_u ? RowStretch{&chunk, in_tile * chunk.rays().nu, 1} : RowStretch{&chunk, in_tile, chunk.rays().nu};
    };
    return rows;
  }

  // Compares the first grid's cells of the band with the planes.
  void compare(uint32_t b0, uint32_t b1, uint32_t w0, uint32_t w1) {
    const bool b_is_u = frame_.u == b_;
    const uint32_t side = shape_.chunk_rays, segment0 = w0 / shape_.chunk_cells;
    const uint64_t columns = (b1 - b0 + side - 1) / side, tiles = (t1_ - t0_ + side - 1) / side,
                   segments = (w1 - 1) / shape_.chunk_cells - segment0 + 1;
    c_.a.prefetch(0, box(b0, b1, w0, w1));
    uint64_t next = 0;
    in_order(
        c_.threads,
        [&]() -> std::optional<ChunkKey> {
          if (next == columns * tiles * segments) return std::nullopt;
          const uint64_t i = next++;
          const auto column = static_cast<uint32_t>(b0 / side + i % columns), tile = static_cast<uint32_t>(t0_ / side + i / columns % tiles);
          const auto segment = static_cast<uint32_t>(segment0 + i / columns / tiles);
          return b_is_u ? ChunkKey{0, column, tile, segment} : ChunkKey{0, tile, column, segment};
        },
        [&](const ChunkKey& key, int worker) {
          const uint32_t first = key.segment * shape_.chunk_cells, u0 = key.cu * side, v0 = key.cv * side;
          return comparisons_[static_cast<size_t>(worker)].compare(key, std::max(w0, first), std::min(w1, first + shape_.length(key.segment)),
                                                                   [&](uint32_t u, uint32_t v) {
                                                                     const TurnedPlane& plane = planes_[b_is_u ? v0 + v - t0_ : u0 + u - t0_];
                                                                     const uint32_t column = b_is_u ? u0 + u - b0 : v0 + v - b0;
                                                                     plane.prefetch(column + 2);
                                                                     return plane.column(column);
                                                                   });
        },
        [&](std::optional<FoundChanges> found) {
          if (found) c_.found(std::move(*found));
          c_.progress(share_);
        },
        8);
  }

  const GridComparison& c_;
  const RayFrame frame_, other_frame_;
  const int b_, t_;
  const LevelShape shape_, other_;
  const Index3 cells_;
  std::vector<RowSweep> sweeps_;  // of each thread
  std::deque<ChunkComparison> comparisons_;
  LoadedChunks loaded_;
  uint32_t t0_ = 0, t1_ = 0;         // the band
  std::vector<TurnedPlane> planes_;  // of the band
  double share_ = 0;
};

}  // namespace

void compare_across(const GridComparison& c) { CompareAcross(c).run(); }

}  // namespace teracell::store

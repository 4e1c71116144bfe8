// Three cases, by how the rays lie in the picture:
//
//   across it    A row of chunks holds chunk_rays rows. Each ray gives one cell.
//   upright      The columns of the picture are rays. Their changes are sorted along the rays. Then one sweep keeps the
//                current row and applies what changes from one row to the next. (Filling 10^8 cells column by column
//                would miss the cache 10^8 times; the sweep touches only what changes.)
//   lying        The rows of the picture are rays. A run is a stretch of a row.
//
// However wide a row is, a bounded number of cells is in memory. Where the rows of a row of chunks are too many to be held
// together, fewer are made at a time, down to single ones that are delivered part by part. The chunks are then decoded again
// for each group of rows. (Rejected: keeping decoded chunks as runs. They are small for most bodies, but nothing bounds them.)
#include "store/read/slice.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "store/base/in_order.hpp"
#include "store/base/system/vector_units.hpp"
#include "store/grid/set_memo.hpp"

namespace teracell::inline store {
namespace {

// The values of the sets of one chunk. Each is asked for once. `unreadable`: that of a set without members.
class Values {
 public:
  Values(const SetTable& sets, const SetValue& value, std::optional<uint16_t> unreadable) : sets_(sets), value_(value), unreadable_(unreadable) {}
  uint16_t operator()(SetId set) {
    return known_.get(set, [&] {
      const std::vector<Label> members = sets_.members(set);
      return members.empty() ? unreadable_.value() : static_cast<uint16_t>(value_(members));
    });
  }

 private:
  const SetTable& sets_;
  const SetValue& value_;
  const std::optional<uint16_t> unreadable_;
  SetMemo<uint16_t> known_;
};

struct Picture {
  const GridReader& reader;
  const SliceView& view;
  const SetValue& value;
  bool top_down;
  int threads;
  const RowSink& row;
  const int64_t held;  // cells
  const std::optional<uint16_t> unreadable;
  LevelShape shape;
  RayFrame rays;

  int64_t width() const { return view.u1 - view.u0; }
  static constexpr size_t kTall = 1 << 20;  // rows of a band that are too many to count the changes of each

  // Rows [from, to).
  struct Band {
    int64_t from, to;
  };
  // The first band of the rows that are left, cut at multiples of `size`.
  Band next_band(const Band& left, int64_t size) const {
    if (top_down) return {std::max(left.from, (left.to - 1) / size * size), left.to};
    return {left.from, std::min(left.to, (left.from / size + 1) * size)};
  }
  // The rows of a band that are delivered first, and the others.
  Band head(const Band& band, int64_t rows) const { return top_down ? Band{band.to - rows, band.to} : Band{band.from, band.from + rows}; }
  Band tail(const Band& band, int64_t rows) const { return top_down ? Band{band.from, band.to - rows} : Band{band.from + rows, band.to}; }
  int64_t nth(const Band& band, int64_t i) const { return top_down ? band.to - 1 - i : band.from + i; }

  // Makes ready what a band needs.
  void prefetch(const Band& band) const {
    const RayFrame f = RayFrame::along(view.axis);
    try {
      reader.prefetch(view.level, f.box({view.u0, band.from, view.index}, {view.u1, band.to, view.index + 1}));
    } catch (const FormatError&) {  // what can be read is read below
      if (!unreadable) throw;
    }
  }
  // What a chunk has: the value of all its cells, or its cells.
  struct Known {
    std::optional<uint16_t> all;
    std::shared_ptr<const Chunk> cells;
  };
  // What is used again from one chunk to the next.
  struct Scratch {
    std::shared_ptr<Chunk> chunk;
    std::vector<Label> set;  // the last one that filled a chunk, and its value: it is mostly the same
    std::optional<uint16_t> value;
  };
  Known known(const ChunkKey& key, Scratch& scratch) const {
    try {
      if (auto set = reader.uniform(key)) {
        if (!scratch.value || scratch.set != *set) scratch.value = static_cast<uint16_t>(value(*set)), scratch.set = std::move(*set);
        return {scratch.value, nullptr};
      }
      return {std::nullopt, reader.chunk(key, scratch.chunk)};
    } catch (const FormatError&) {
      if (!unreadable) throw;
      if (reader.stored(key.level)) return {unreadable, nullptr};
      const auto rest = std::make_shared<Chunk>();  // of its chunks below, those that can be read
      reader.derive(key, *rest, true);
      return {std::nullopt, rest};
    }
  }
  // The same for all of a small picture, in fewer round trips.
  void prefetch_if_small() const {
    if (width() * (view.v1 - view.v0) <= kSmall) prefetch({view.v0, view.v1});
  }
  static constexpr int64_t kSmall = 1 << 20;  // pixels

  // The columns [u0, u1) of a band, the lowest row first.
  struct Part {
    Band band;
    int64_t u0, u1;
    std::unique_ptr<uint16_t[]> cells{};
    int64_t width() const { return u1 - u0; }
    std::span<const uint16_t> row(int64_t v) const { return {&cells[static_cast<size_t>((v - band.from) * width())], static_cast<size_t>(width())}; }
  };

  // Makes the cells of parts on the threads and delivers them in order. Bands are cut at multiples of size_v, parts at
  // multiples of size_u.
  template <class Fill>
  void by_parts(int64_t size_u, int64_t size_v, Fill fill) const {
    // One thread has one part in hand: few parts, since a chunk that several share may have to be decoded for each.
    const int64_t wide = std::max<int64_t>(1, held / (threads == 1 ? 8 : 1024)), rows = std::clamp<int64_t>(held / width(), 1, size_v);
    Band left{view.v0, view.v1}, band{};
    int64_t u = view.u1;
    std::vector<Part> parts;  // of a band that is not complete
    // The memory of parts that were delivered: new memory for each would take a fifth of the time.
    std::vector<std::unique_ptr<uint16_t[]>> spare;
    std::mutex mutex;
    const auto largest = static_cast<size_t>(rows * std::min(wide, width()));
    in_order(
        threads,
        [&]() -> std::optional<Part> {
          if (u == view.u1) {
            if (left.from == left.to) return std::nullopt;
            band = next_band(left, size_v);
            prefetch(band);
            band = head(band, std::min(rows, band.to - band.from));
            left = tail(left, band.to - band.from);
            u = view.u0;
          }
          const int64_t from = u, cut = (u + wide) / size_u * size_u;
          u = view.u1 - u <= wide ? view.u1 : cut > u ? cut : u + wide;
          return Part{band, from, u};
        },
        [&](Part part, int) {
          {
            std::lock_guard lock(mutex);
            if (!spare.empty()) part.cells = std::move(spare.back()), spare.pop_back();
          }
          if (!part.cells) part.cells = std::make_unique_for_overwrite<uint16_t[]>(largest);
          fill(part);
          return part;
        },
        [&](Part&& part) {
          const Band of = part.band;
          const bool last = part.u1 == view.u1;
          parts.push_back(std::move(part));
          if (!last && of.to - of.from > 1) return;
          for (int64_t i = 0; i < of.to - of.from; ++i)
            for (const Part& p : parts) row(nth(of, i), p.row(nth(of, i)));
          std::lock_guard lock(mutex);
          for (Part& p : parts) spare.push_back(std::move(p.cells));
          parts.clear();
        });
  }

  // The part of the picture that one chunk gives where the rays lie across it: the pixels [u0, u1) x [v0, v1), counted from the
  // chunk's corner.
  struct Patch {
    uint32_t u0, u1, v0, v1;
    uint16_t* out;  // the pixel (u0, v0)
    int64_t stride;  // from row to row
  };

  // Makes a picture that the rays lie across from chunks of `level`, each `side` pixels wide. Calls paint(chunk, patch) for
  // those that are not uniform.
  template <class Paint>
  void by_chunks(int level, int64_t side, uint32_t segment, Paint paint) const {
    by_parts(side, side, [&](Part& part) {
      const Band& band = part.band;
      const auto cv = static_cast<uint32_t>(band.from / side);
      Scratch scratch;
      int64_t alike = part.u0;  // from here on all rows are to be like the lowest one
      const auto repeat = [&](int64_t end) {
        const uint16_t* const lowest = part.cells.get() + (alike - part.u0);
        for (int64_t v = 1; v < band.to - band.from; ++v) std::copy_n(lowest, end - alike, part.cells.get() + v * part.width() + (alike - part.u0));
      };
      for (int64_t first = part.u0 / side * side; first < part.u1; first += side) {
        const ChunkKey key{level, static_cast<uint32_t>(first / side), cv, segment};
        const int64_t u0 = std::max(part.u0, first), u1 = std::min(part.u1, first + side);
        uint16_t* const out = part.cells.get() + (u0 - part.u0);
        const auto [all, decoded] = known(key, scratch);
        if (all) {
          std::fill_n(out, u1 - u0, *all);
          continue;
        }
        repeat(u0);
        alike = u1;
        const auto within = [&](int64_t n, int64_t begin) { return static_cast<uint32_t>(n - begin); };
        paint(*decoded, Patch{within(u0, first), within(u1, first), within(band.from, cv * side), within(band.to, cv * side), out, part.width()});
      }
      repeat(part.u1);
    });
  }

  // The loops over rays and runs are functions of their own, as in chunk_decoder.cpp.
  void across() const {
    if (!reader.stored(view.level)) return across_derived();
    const auto segment = static_cast<uint32_t>(view.index / shape.chunk_cells), cell = static_cast<uint32_t>(view.index % shape.chunk_cells);
    by_chunks(
        view.level, shape.chunk_rays, segment, [&](const Chunk& chunk, const Patch& p) __attribute__((noinline)) {
          const RayBlock& b = chunk.rays;
          Values values(chunk.sets, value, unreadable);
          Alike alike;
          const bool whole_rows = p.u1 - p.u0 == b.nu;  // then those of one pattern, which are most, are painted at once
          for (uint32_t v = p.v0, rows = 1; v < p.v1; v += std::exchange(rows, 1)) {
            const uint32_t from = v * b.nu + p.u0, end = v * b.nu + p.u1;
            for (uint32_t ray = from, next; ray < end; ray = next) {
              next = end_of_alike(b, ray, whole_rows && ray == from ? p.v1 * b.nu : end);
              if (next > end) rows = (next - from) / b.nu, next = end;
              if (alike.pattern != b.pattern[ray]) alike = Alike(b, b.pattern[ray], values);
              uint16_t* const out = p.out + (v - p.v0) * p.stride + (ray - from);
              if (alike.runs > 0) {
                paint_alike(alike, b.at.data() + b.begin[ray], cell, {out, p.stride, next - ray, rows});
                continue;
              }
              for (uint32_t row = 0; row < rows; ++row)
                for (uint32_t i = 0; i < next - ray; ++i) out[row * p.stride + i] = values(b.set_at(row * b.nu + ray + i, cell));
            }
          }
        });
  }

  // The end of the rays of [from, end) that have the pattern of the first.
  static uint32_t end_of_alike(const RayBlock& b, uint32_t from, uint32_t end) {
    const uint32_t* const pattern = b.pattern.data();
    // Rays that equal the next ones are all alike. Mostly all of them are; otherwise, some at a time.
    const auto alike = [&](uint32_t ray, uint32_t rays) { return std::memcmp(pattern + ray, pattern + ray + 1, rays * sizeof *pattern) == 0; };
    if (alike(from, end - from - 1)) return end;
    constexpr uint32_t kSome = 16;
    while (from + kSome < end && alike(from, kSome)) from += kSome;
    const uint32_t first = pattern[from];
    while (from < end && pattern[from] == first) ++from;
    return from;
  }

  // A pattern and the values of its runs, if these are few; otherwise `runs` is 0.
  struct Alike {
    uint32_t pattern = ~0u, runs = 0;
    std::array<uint16_t, 4> of_runs{};
    Alike() = default;
    Alike(const RayBlock& b, uint32_t number, Values& values) : pattern(number) {
      const std::span<const SetId> sets = b.patterns.sets(number);
      if (sets.size() > of_runs.size()) return;
      runs = static_cast<uint32_t>(sets.size());
      std::transform(sets.begin(), sets.end(), of_runs.begin(), std::ref(values));
    }
  };

  // Rows of pixels.
  struct Pixels {
    uint16_t* out;
    int64_t stride;
    uint32_t wide, rows;
  };
  // Rays of one pattern, of which each gives the value of one cell. `changes`: theirs.
  static void paint_alike(const Alike& alike, const uint32_t* changes, uint32_t cell, const Pixels& pixels) {
    // A value is that of the first run, changed by each change up to the cell: without look-ups, so that it is done for several rays at once.
    const auto paint = [&]<uint32_t N>(std::integral_constant<uint32_t, N>) {
      on_vector_unit([&alike, changes, cell, pixels]() TERACELL_IN_LINE {
        std::array<uint16_t, N> changed;
        for (uint32_t i = 0; i < N; ++i) changed[i] = alike.of_runs[i] ^ alike.of_runs[i + 1];
        const uint16_t first = alike.of_runs[0];
        const uint32_t* at = changes;
        const uint32_t last = cell;
        uint16_t* row = pixels.out;
        const size_t wide = pixels.wide;
        for (uint32_t left = pixels.rows; left > 0; --left, row += pixels.stride, at += N * wide) {
          uint16_t* __restrict const out = row;
          for (size_t ray = 0; ray < wide; ++ray) {
            uint16_t shown = first;
            for (size_t i = 0; i < N; ++i) shown ^= at[N * ray + i] <= last ? changed[i] : 0;
            out[ray] = shown;
          }
        }
      });
    };
    switch (alike.runs) {
      case 1: paint(std::integral_constant<uint32_t, 0>()); break;
      case 2: paint(std::integral_constant<uint32_t, 1>()); break;
      case 3: paint(std::integral_constant<uint32_t, 2>()); break;
      default: paint(std::integral_constant<uint32_t, 3>());
    }
  }

  // Of a derived level: takes the two cells of each ray of the level below that the slice covers. (Deriving its chunks as a
  // whole takes twice as long.)
  void across_derived() const {
    const LevelShape below = reader.shape(view.level - 1);
    const auto segment = static_cast<uint32_t>(2 * view.index / below.chunk_cells);
    const auto cell = static_cast<uint32_t>(2 * view.index % below.chunk_cells);  // even, like chunk_cells
    by_chunks(view.level - 1, below.chunk_rays / 2, segment, [&](const Chunk& chunk, const Patch& p) {
      const RayBlock& b = chunk.rays;
      SetTable sets = chunk.sets;  // unions get ids
      Values values(sets, value, unreadable);
      const auto set_of = [&](uint32_t ray) {
        const auto changes = b.changes(ray);
        const auto of_ray = b.sets(ray);
        const uint32_t run = run_at(changes, cell);
        return run < changes.size() && changes[run] == cell + 1 ? sets.unite(of_ray[run], of_ray[run + 1]) : of_ray[run];
      };
      for (uint32_t v = p.v0; v < p.v1; ++v) {
        uint16_t* out = p.out + (v - p.v0) * p.stride;
        const uint32_t first = 2 * v, rows = std::min(2u, b.nv - first);
        for (uint32_t column = 2 * p.u0; column < 2 * p.u1; column += 2) {
          const uint32_t columns = std::min(2u, b.nu - column);
          SetId set = set_of(first * b.nu + column);
          for (uint32_t i = 1; i < rows * columns; ++i) set = sets.unite(set, set_of((first + i / columns) * b.nu + column + i % columns));
          *out++ = values(set);
        }
      }
    });
  }

  // Where the rays lie in the picture, one of rays.u and rays.v is the slice's own axis, which is fixed, and the other one
  // counts rays. Calls f(ray, from, to, value) for the runs of the rays [lo, hi) within the cells `along` of one segment; both are
  // counted in the level.
  template <class F>
  void runs(int64_t lo, int64_t hi, uint32_t segment, const Band& along, F&& f) const {
    const bool fixed_u = rays.u == view.axis;
    const int64_t first_cell = int64_t{segment} * shape.chunk_cells;
    const auto w0 = static_cast<uint32_t>(std::max<int64_t>(along.from - first_cell, 0));
    const auto w1 = static_cast<uint32_t>(std::min<int64_t>(along.to - first_cell, shape.length(segment)));
    const auto fixed_chunk = static_cast<uint32_t>(view.index / shape.chunk_rays), fixed = static_cast<uint32_t>(view.index % shape.chunk_rays);
    Scratch scratch;
    for (int64_t c = lo / shape.chunk_rays; c * shape.chunk_rays < hi; ++c) {
      const int64_t first = c * shape.chunk_rays, from = std::max(lo, first), to = std::min<int64_t>(hi, first + shape.chunk_rays);
      const auto counted = static_cast<uint32_t>(c);
      const ChunkKey key{view.level, fixed_u ? fixed_chunk : counted, fixed_u ? counted : fixed_chunk, segment};
      const auto [all, decoded] = known(key, scratch);
      if (all) {
        for (int64_t i = from; i < to; ++i) f(i, first_cell + w0, first_cell + w1, *all);
        continue;
      }
      const Chunk& chunk = *decoded;
      Values values(chunk.sets, value, unreadable);
      for (int64_t i = from; i < to; ++i) {
        const auto r = static_cast<uint32_t>(i - first);
        const uint32_t ray = fixed_u ? r * chunk.rays.nu + fixed : fixed * chunk.rays.nu + r;
        chunk.rays.for_each_run(ray, w0, w1, [&](uint32_t a, uint32_t b, SetId set) { f(i, first_cell + a, first_cell + b, values(set)); });
      }
    }
  }

  // Neighbouring columns of a band in the form that the sweep takes: changes, or, where many cells differ from the one before,
  // the cells themselves. Their memory is never more than two bytes per cell.
  struct Columns {
    struct Change {
      uint32_t row;  // counted from the first one delivered
      uint16_t u, value;
    };
    size_t first, wide;           // in the view
    std::vector<Change> changes;  // by row
    size_t next = 0;              // of them
    std::vector<uint16_t> cells;  // or these, row by row

    size_t bytes() const { return changes.capacity() * sizeof(Change) + cells.capacity() * sizeof(uint16_t); }
    // Drops the rows from `end` on.
    void cut(size_t end) {
      changes.resize(static_cast<size_t>(std::ranges::lower_bound(changes, end, {}, &Change::row) - changes.begin()));
      changes.shrink_to_fit();
      cells.resize(std::min(cells.size(), end * wide));
      cells.shrink_to_fit();
    }
    // Turns the row before into this one. `out` begins at the first of these columns.
    void turn(size_t at, uint16_t* out) {
      if (!cells.empty()) std::copy_n(cells.data() + at * wide, wide, out);
      for (; next < changes.size() && changes[next].row == at; ++next) out[changes[next].u] = changes[next].value;
    }
  };

  static void sort_by_row(std::vector<Columns::Change>& changes, size_t rows) {
    if (rows > kTall) {
      std::ranges::stable_sort(changes, {}, &Columns::Change::row);
      return;
    }
    std::vector<uint32_t> start(rows + 1, 0);  // of each row, sorted
    for (const Columns::Change& c : changes) ++start[c.row + 1];
    for (size_t r = 0; r < rows; ++r) start[r + 1] += start[r];
    std::vector<Columns::Change> sorted(changes.size());
    for (const Columns::Change& c : changes) sorted[start[c.row]++] = c;
    changes = std::move(sorted);
  }

  [[gnu::noinline]] Columns columns(const Band& band, int64_t from, int64_t to) const {
    const auto rows = static_cast<size_t>(band.to - band.from), wide = static_cast<size_t>(to - from);
    Columns out{static_cast<size_t>(from - view.u0), wide, {}};
    std::vector<Columns::Change>& found = out.changes;
    const size_t most = rows * wide * sizeof(uint16_t) / sizeof(Columns::Change);
    const auto fill = [&](size_t first, size_t last, const Columns::Change& c) {
      for (size_t r = first; r < last; ++r) out.cells[r * wide + c.u] = c.value;
    };
    runs(from, to, static_cast<uint32_t>(band.from / shape.chunk_cells), band, [&](int64_t u, int64_t a, int64_t b, uint16_t v) {
      // For the sweep, a run begins at the end that is delivered first.
      const auto first = static_cast<uint32_t>(top_down ? band.to - b : a - band.from);
      const Columns::Change change{first, static_cast<uint16_t>(u - from), v};
      if (!out.cells.empty()) return fill(first, first + static_cast<size_t>(b - a), change);
      found.push_back(change);
      if (found.size() <= most) return;
      out.cells.resize(rows * wide);
      for (size_t i = 0; i < found.size(); ++i) {
        // The run ends where its neighbour begins. What is not found yet overwrites the rest.
        const size_t next = top_down ? i - 1 : i + 1;
        fill(found[i].row, next < found.size() && found[next].u == found[i].u ? found[next].row : rows, found[i]);
      }
      found = {};
    });
    sort_by_row(found, rows);
    return out;
  }

  [[gnu::noinline]] void upright() const {
    Band left{view.v0, view.v1};
    while (left.from < left.to) left = tail(left, sweep(next_band(left, shape.chunk_cells)));  // one segment at a time
  }

  // Delivers the first rows of a band within a segment, as many as can be held. Returns their number.
  int64_t sweep(const Band& band) const {
    prefetch(band);
    int64_t rows = 2 * width() <= held ? band.to - band.from : 1;
    std::vector<uint16_t> current(rows > 1 ? static_cast<size_t>(width()) : 0);
    std::vector<Columns> parts;  // those of all columns so far
    size_t bytes = current.size() * sizeof(uint16_t);
    const auto keep = [&](Columns&& made) {
      made.cut(static_cast<size_t>(rows));
      bytes += made.bytes();
      parts.push_back(std::move(made));
      while (rows > 1 && bytes > static_cast<size_t>(held) * sizeof(uint16_t)) {
        rows = (rows + 1) / 2;
        bytes = current.size() * sizeof(uint16_t);
        for (Columns& p : parts) p.cut(static_cast<size_t>(rows)), bytes += p.bytes();
      }
      if (rows > 1) return;
      for (Columns& p : parts) {
        current.resize(p.wide);
        p.turn(0, current.data());
        row(nth(band, 0), current);
      }
      parts.clear();
      bytes = 0;
    };
    // At most 1024 columns, and so few that they take a fraction of what is held.
    const int64_t several = std::clamp<int64_t>(held / 4 / (band.to - band.from), 1, 4 * int64_t{shape.chunk_rays});
    const int64_t part = several < shape.chunk_rays ? several : several / shape.chunk_rays * shape.chunk_rays;
    int64_t next = view.u0;
    in_order(
        threads,
        [&]() -> std::optional<int64_t> {
          if (next >= view.u1) return std::nullopt;
          return std::exchange(next, std::min(view.u1, (next / part + 1) * part));
        },
        [&](int64_t from, int) { return columns(band, from, std::min(view.u1, (from / part + 1) * part)); }, keep);
    for (int64_t r = 0; !parts.empty() && r < rows; ++r) {
      for (Columns& p : parts) p.turn(static_cast<size_t>(r), current.data() + p.first);
      row(nth(band, r), current);
    }
    return rows;
  }

  [[gnu::noinline]] void lying() const {
    by_parts(shape.chunk_cells, shape.chunk_rays, [&](Part& part) {
      for (int64_t s = part.u0 / shape.chunk_cells; s * shape.chunk_cells < part.u1; ++s)
        runs(part.band.from, part.band.to, static_cast<uint32_t>(s), {part.u0, part.u1}, [&](int64_t v, int64_t a, int64_t b, uint16_t value_of_run) {
          std::fill_n(part.cells.get() + (v - part.band.from) * part.width() + (a - part.u0), b - a, value_of_run);
        });
    });
  }
};

}  // namespace

SliceView whole_slice(const Metadata& meta, int axis, int64_t index, int level) {
  meta.grid.check_level(level);
  const Index3 n = meta.grid.cells(level);
  const RayFrame f = RayFrame::along(axis);
  const SliceView view{axis, index, level, 0, 0, n[f.u], n[f.v]};
  check_view(meta, view);
  return view;
}

void check_view(const Metadata& meta, const SliceView& view) {
  meta.grid.check_level(view.level);
  const Index3 n = meta.grid.cells(view.level);
  const RayFrame f = RayFrame::along(view.axis);
  if (view.index < 0 || view.index >= n[view.axis])
    throw UsageError(
        fmt::format("index along {} must be 0 to {} on level {}, found {}", axis_name(view.axis), n[view.axis] - 1, view.level, view.index));
  const auto check = [&](int axis, int64_t lo, int64_t hi) {
    if (lo < 0 || hi > n[axis] || lo >= hi)
      throw UsageError(fmt::format("the region along {} must lie in 0 to {} (half open) on level {} and not be empty, found {} to {}",
                                   axis_name(axis), n[axis], view.level, lo, hi));
  };
  check(f.u, view.u0, view.u1);
  check(f.v, view.v0, view.v1);
}

void for_each_row(const GridReader& reader, const SliceView& view, const SetValue& value, bool top_down, int threads, const RowSink& row,
                  int64_t held, std::optional<uint16_t> unreadable) {
  check_view(reader.meta(), view);
  const RayFrame rays = reader.meta().frame();
  const Picture picture{reader, view, value, top_down, threads, row, held, unreadable, reader.shape(view.level), rays};
  picture.prefetch_if_small();
  if (rays.w == view.axis) picture.across();
  else if (rays.w == RayFrame::along(view.axis).v) picture.upright();
  else picture.lying();
}

}  // namespace teracell::store

// A block of pixels at a time: which stretches of its rows lie in which chunk, then chunk by chunk, so that each is decoded once for a block.
#include "store/read/plane.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <tuple>
#include <utility>

#include "store/base/in_order.hpp"
#include "store/base/wanted.hpp"
#include "store/grid/set_memo.hpp"

namespace teracell::inline store {
namespace {

constexpr int64_t kPatch = 1024;   // pixels along a side
constexpr int64_t kFetched = 256;  // pixels along a side of what is made ready at once: a box of cells around them, which is mostly empty
constexpr int64_t kRowsOfJob = 16;

// Pixels of a row whose cells lie in one chunk.
struct PixelStretch {
  uint64_t chunk;  // its number
  int64_t j, from, to;
};

class PlaneReader {
 public:
  PlaneReader(const GridReader& reader, const PlaneView& view, const SetValue& value, uint16_t outside, int threads)
      : reader_(reader),
        grid_(reader.meta().grid),
        view_(view),
        value_(value),
        outside_(outside),
        threads_(threads),
        shape_(reader.shape(view.level)),
        frame_(reader.meta().frame()) {}

  // The pixels of columns [i0, i1) and rows [j0, j1); that of column view.i0 in row j is at out[(j - j0) * width].
  void read(int64_t i0, int64_t i1, int64_t j0, int64_t j1, uint16_t* out) {
    const int64_t width = view_.i1 - view_.i0;
    std::atomic<bool> late = false;
    const auto unless_late = [&](auto&& read_some) {
      try {
        read_some();
      } catch (const Later&) {
        late = true;
      }
    };
    for (int64_t j = j0; j < j1; j += kFetched)
      for (int64_t i = i0; i < i1; i += kFetched) unless_late([&] { prefetch(i, std::min(i + kFetched, i1), j, std::min(j + kFetched, j1)); });
    std::vector<PixelStretch> stretches = stretches_of(i0, i1, j0, j1);
    std::ranges::sort(stretches, {}, [](const PixelStretch& s) { return std::tuple(s.chunk, s.j, s.from); });
    std::vector<std::shared_ptr<Chunk>> scratch(static_cast<size_t>(std::max(threads_, 1)));
    std::span<const PixelStretch> left = stretches;
    in_order(
        threads_,
        [&]() -> std::optional<std::span<const PixelStretch>> {
          if (left.empty()) return std::nullopt;
          size_t n = 1;
          while (n < left.size() && left[n].chunk == left[0].chunk) ++n;
          const auto of_chunk = left.first(n);
          left = left.subspan(n);
          return of_chunk;
        },
        [&](std::span<const PixelStretch> of_chunk, int worker) {
          Wanted::stop_if_not();
          const auto put = [&](auto&& value_at) {
            for (const PixelStretch& s : of_chunk)
              for (int64_t i = s.from; i < s.to; ++i) out[(s.j - j0) * width + i - view_.i0] = value_at(i, s.j);
          };
          if (of_chunk.front().chunk == kNone) put([&](int64_t, int64_t) { return outside_; });
          else unless_late([&] { read_chunk(of_chunk.front().chunk, scratch[static_cast<size_t>(worker)], put); });
          return 0;
        },
        [](int) { Wanted::stop_if_not(); }, 16);
    if (late) throw Later("bytes of some pixels come later");
  }

 private:
  static constexpr uint64_t kNone = ~uint64_t{0};  // in place of a chunk: outside the grid

  // The cell, of the level, of a pixel along an axis; -1 outside.
  int64_t cell(int axis, int64_t i, int64_t j) const {
    const Axis& of = grid_.axis[static_cast<size_t>(axis)];
    const double x = view_.middle(static_cast<size_t>(axis), i, j);
    return x >= of.min() && x < of.max() ? of.cell_at(x) >> view_.level : -1;
  }

  void prefetch(int64_t i0, int64_t i1, int64_t j0, int64_t j1) const {
    Box box = grid_.box(view_.level);
    for (size_t d = 0; d < 3; ++d) {
      const Axis& axis = grid_.axis[d];
      double low = axis.max(), high = axis.min();
      for (const int64_t i : {i0, i1 - 1})
        for (const int64_t j : {j0, j1 - 1}) {
          const double x = std::clamp(view_.middle(d, i, j), axis.min(), axis.max());
          low = std::min(low, x), high = std::max(high, x);
        }
      box.lo[d] = axis.cell_at(low) >> view_.level, box.hi[d] = (axis.cell_at(high) >> view_.level) + 1;
    }
    reader_.prefetch(view_.level, box);
  }

  std::vector<PixelStretch> stretches_of(int64_t i0, int64_t i1, int64_t j0, int64_t j1) const {
    std::vector<PixelStretch> out;
    int64_t next = j0;
    in_order(
        threads_, [&] { return next < j1 ? std::optional(std::exchange(next, std::min(next + kRowsOfJob, j1))) : std::nullopt; },
        [&](int64_t from, int) {
          std::vector<PixelStretch> found;
          for (int64_t j = from; j < std::min(from + kRowsOfJob, j1); ++j) add_row(i0, i1, j, found);
          return found;
        },
        [&](std::vector<PixelStretch>&& found) { out.insert(out.end(), found.begin(), found.end()); }, 4);
    return out;
  }

  void add_row(int64_t i0, int64_t i1, int64_t j, std::vector<PixelStretch>& out) const {
    Box here{};  // of the chunk of the pixel before, in cells of the frame of the rays; empty: none
    for (int64_t i = i0; i < i1; ++i) {
      const Index3 at{cell(frame_.u, i, j), cell(frame_.v, i, j), cell(frame_.w, i, j)};
      const bool outside = at[0] < 0 || at[1] < 0 || at[2] < 0;
      const bool same = i > i0 && (outside ? out.back().chunk == kNone
                                           : at[0] >= here.lo[0] && at[0] < here.hi[0] && at[1] >= here.lo[1] && at[1] < here.hi[1] &&
                                                 at[2] >= here.lo[2] && at[2] < here.hi[2]);
      if (same) {
        ++out.back().to;
        continue;
      }
      here = {};
      uint64_t chunk = kNone;
      if (!outside) {
        const Index3 sizes{shape_.chunk_rays, shape_.chunk_rays, shape_.chunk_cells};
        ChunkKey key{view_.level, static_cast<uint32_t>(at[0] / sizes[0]), static_cast<uint32_t>(at[1] / sizes[1]),
                     static_cast<uint32_t>(at[2] / sizes[2])};
        for (size_t d = 0; d < 3; ++d) here.lo[d] = at[d] / sizes[d] * sizes[d], here.hi[d] = here.lo[d] + sizes[d];
        const uint64_t page = shape_.page_of(key);
        chunk = page * shape_.page_chunks * shape_.page_chunks + shape_.slot_of(key, page);
      }
      out.push_back({chunk, j, i, i + 1});
    }
  }

  template <class Put>
  void read_chunk(uint64_t number, std::shared_ptr<Chunk>& scratch, const Put& put) const {
    const uint64_t of_page = uint64_t{shape_.page_chunks} * shape_.page_chunks;
    const ChunkKey key = shape_.key_of(number / of_page, static_cast<uint32_t>(number % of_page));
    if (const auto set = reader_.uniform(key)) return put([v = static_cast<uint16_t>(value_(*set))](int64_t, int64_t) { return v; });
    const auto chunk = reader_.chunk(key, scratch);
    const RayBlock& rays = chunk->rays;
    SetMemo<uint16_t> known;
    const int64_t u0 = int64_t{key.cu} * shape_.chunk_rays, v0 = int64_t{key.cv} * shape_.chunk_rays, w0 = int64_t{key.segment} * shape_.chunk_cells;
    put([&](int64_t i, int64_t j) {
      const auto ray = static_cast<uint32_t>((cell(frame_.v, i, j) - v0) * rays.nu + cell(frame_.u, i, j) - u0);
      const SetId set = rays.set_at(ray, static_cast<uint32_t>(cell(frame_.w, i, j) - w0));
      return known.get(set, [&] { return static_cast<uint16_t>(value_(chunk->sets.members(set))); });
    });
  }

  const GridReader& reader_;
  const Grid& grid_;
  const PlaneView& view_;
  const SetValue& value_;
  const uint16_t outside_;
  const int threads_;
  const LevelShape shape_;
  const RayFrame frame_;
};

}  // namespace

void for_each_plane_row(const GridReader& reader, const PlaneView& view, const SetValue& value, uint16_t outside, bool top_down, int threads,
                        const RowSink& row, int64_t held) {
  reader.meta().grid.check_level(view.level);
  PlaneReader plane(reader, view, value, outside, threads);
  const int64_t width = view.i1 - view.i0, most = std::max<int64_t>(1, std::min(held / width, kPatch));
  std::vector<uint16_t> pixels;
  for (int64_t done = 0; done < view.j1 - view.j0;) {
    const int64_t rows = std::min(most, view.j1 - view.j0 - done);
    const int64_t j0 = top_down ? view.j1 - done - rows : view.j0 + done;
    pixels.resize(static_cast<size_t>(rows * width));
    for (int64_t i = view.i0; i < view.i1; i += kPatch) plane.read(i, std::min(i + kPatch, view.i1), j0, j0 + rows, pixels.data());
    for (int64_t n = 0; n < rows; ++n) {
      const int64_t j = top_down ? j0 + rows - 1 - n : j0 + n;
      row(j, std::span(pixels).subspan(static_cast<size_t>((j - j0) * width), static_cast<size_t>(width)));
    }
    done += rows;
  }
}

}  // namespace teracell::store

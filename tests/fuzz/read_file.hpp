// Reads everything of a file that may be hostile, for fuzzers: an Error or sound cells, and a file that verify passes can be read
// throughout, the same in every way. Anything else aborts.
#pragma once
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "store/channels/fraction_reader.hpp"
#include "store/channels/link_reader.hpp"
#include "store/read/query.hpp"
#include "store/read/slice.hpp"
#include "store/read/stats.hpp"
#include "store/whole/info.hpp"
#include "store/whole/verify.hpp"
#include "tests/support/stored.hpp"

namespace teracell::testing {

// Hostile metadata may describe grids that take hours to walk: no fault of the reader's.
inline bool affordable(const GridReader& reader) {
  double rays = 0, chunks = 0;
  for (const LevelInfo& l : reader.meta().levels()) {
    const LevelShape s = reader.shape(l.level);
    rays += double{1} * s.nu * s.nv * s.segments;
    chunks += double{1} * s.chunks_u * s.chunks_v * s.segments;
  }
  return rays < 1 << 18 && chunks < 1 << 10;
}

// Up to 8 cells a side at the lower corner, in the middle, at the upper corner and across it.
inline std::vector<Box> some_boxes(const Index3& n) {
  std::vector<Box> boxes(4);
  for (int d = 0; d < 3; ++d) {
    const int64_t size = std::min<int64_t>(n[d], 8), middle = (n[d] - size) / 2;
    boxes[0].hi[d] = size;
    boxes[1].lo[d] = middle, boxes[1].hi[d] = middle + size;
    boxes[2].lo[d] = n[d] - size, boxes[2].hi[d] = n[d];
    boxes[3].lo[d] = n[d] - 1, boxes[3].hi[d] = n[d] + 3;
  }
  return boxes;
}

inline void read_some(const GridReader& reader, int level) {
  const SetValue value = strongest_material(reader.meta());
  const Index3 n = reader.meta().grid.cells(level);
  for (const Box& box : some_boxes(n)) {
    const int64_t nx = box.hi[0] - box.lo[0], ny = box.hi[1] - box.lo[1], nz = box.hi[2] - box.lo[2];
    std::vector<uint16_t> cells(static_cast<size_t>(nx * ny * nz));
    read_box<uint16_t>(reader, level, box, value, 0, cells.data(), {1, nx, nx * ny});
    if (box.hi[0] > n[0]) continue;
    uint64_t covered = 0;
    for_each_run(reader, level, box, [&](const BoxRun& run) { covered += static_cast<uint64_t>(run.length); });
    if (covered != cells.size()) std::abort();
    if (level == 0) read_stats(reader, box);
    SliceView view{2, box.lo[2], level, box.lo[0], box.lo[1], box.hi[0], box.hi[1]};
    for_each_row(reader, view, value, true, 1, [&](int64_t v, std::span<const uint16_t> row) {
      if (!std::equal(row.begin(), row.end(), cells.begin() + (v - box.lo[1]) * nx)) std::abort();
    });
    view = {0, box.lo[0], level, box.lo[1], box.lo[2], box.hi[1], box.hi[2]};
    for_each_row(reader, view, value, false, 1, [](int64_t, std::span<const uint16_t>) {});
  }
  if (level != 0) return;
  for (int axis = 0; axis < 3; ++axis)
    if (n[axis] < 4096) read_column(reader, axis, 0, 0);
}

inline void read_boundary(const GridReader& reader) {
  const Index3 n = reader.meta().grid.cells();
  for (Box box : some_boxes(n)) {
    if (find_links(reader.meta()))
      for (int axis = 0; axis < 3; ++axis)
        LinkReader(reader).for_each(axis, box, [&](std::span<const CellLink> links) {
          for (const CellLink& l : links)
            if (l.end > l.begin || l.begin > 65536 || (l.end == 0) != (l.begin == 0) ||
                !overlap(box, {l.cell, {l.cell[0] + 1, l.cell[1] + 1, l.cell[2] + 1}}))
              std::abort();
        });
    if (!find_fractions(reader.meta())) continue;
    const FractionReader fractions(reader);
    for (int d = 0; d < 3; ++d) box.hi[d] = std::min(box.hi[d], n[d]);
    fractions.for_each_mixed(box, [&](const Index3&, int64_t length, std::span<const Label> labels, std::span<const uint32_t> counts) {
      uint64_t sum = 0;
      for (const uint32_t count : counts) sum += count;
      if (length < 1 || labels.size() != counts.size() || sum != sub_samples(fractions.samples())) std::abort();
    });
  }
}

inline void read_file(const Bytes& bytes) {
  bool sound = false;
  try {
    const GridReader reader = reader_of(bytes);
    if (!affordable(reader)) return;
    try {
      verify(reader, 1, [](double) {});
      sound = true;
    } catch (const FormatError&) {
    }
    for (int level = 0; level < std::min(reader.levels(), 6); ++level) {
      try {
        read_some(reader, level);
        if (level == 0) read_boundary(reader);
      } catch (const FormatError&) {
        if (sound) std::abort();
      } catch (const IoError&) {
        if (sound) std::abort();
      }
    }
    if (!nlohmann::json::accept(info_json(reader))) std::abort();
  } catch (const FormatError&) {
    if (sound) std::abort();
  } catch (const IoError&) {
    if (sound) std::abort();
  }
}

}  // namespace teracell::testing

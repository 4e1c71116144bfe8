// The C API. Here are the checks of arguments and the way from exceptions to codes; everything else is in the files that it calls.
#include "store/teracell.h"

#include <cxxabi.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <thread>

#include <fmt/format.h>

#include "store/base/system/once.hpp"
#include "store/base/system/system.hpp"
#include "store/base/wanted.hpp"
#include "store/channels/fraction_reader.hpp"
#include "store/channels/link_reader.hpp"
#include "store/read/kept_chunks.hpp"
#include "store/read/query.hpp"
#include "store/read/stats.hpp"
#include "store/refine/leaves.hpp"
#include "store/remote/sources.hpp"
#include "store/text/color.hpp"
#include "store/whole/info.hpp"
#include "store/whole/partition.hpp"

using namespace teracell;

struct tc_partition {
  const Partition read;
};

struct tc_grid {
  tc_grid(const char* path, const SourceOptions& source) : reader(open_source(path, source), std::make_shared<KeptChunks>(kKept)) {
    for (const MaterialInfo& m : reader.meta().materials) {
      const Rgba c = parse_color(m.color).value_or(Rgba{0, 0, 0, 255});
      materials.push_back({m.name.c_str(), {c[0], c[1], c[2], c[3]}, m.rank});
    }
  }

  static constexpr size_t kKept = size_t{16} << 20;  // bytes of decoded chunks: boxes next to each other share them. malloc may take twice as much.
  const GridReader reader;
  const std::string hash = reader.hash();
  std::atomic<int64_t> owners = 1;
  std::vector<tc_material> materials;
  mutable Once fractions_opened;
  mutable std::unique_ptr<FractionReader> fractions;
  mutable Once links_opened;
  mutable std::unique_ptr<LinkReader> links;
  mutable Once info_made;
  mutable std::string info;
};

namespace {

constexpr uint64_t kMostPartition = uint64_t{1} << 30;  // bytes of JSON

// Coordinates that are this small can be added and multiplied by a stride without overflow.
constexpr int64_t kFarthest = int64_t{1} << 53;

thread_local std::string last_error;
thread_local int last_errno = 0;
thread_local tc_watcher watcher{nullptr, nullptr};
thread_local bool asking = false;  // whether this thread is in the watcher: it may hold what a nested call would wait for

// A function of the caller asked to stop.
struct Stopped : Unwanted {
  using Unwanted::Unwanted;
};

int failed(int status, const char* message, int number = 0) noexcept {
  last_errno = number;
  try {
    last_error = message;
  } catch (...) {
    last_error.clear();
  }
  return status;
}

// Calls f(), and turns what it throws into a code. Every function of the API that can fail goes through it.
template <class F>
int guarded(F&& f) {
  if (asking) return failed(TC_USAGE, "expected no call of this library from a function that watches another call");
  try {
    last_error.clear();
    last_errno = 0;
    std::optional<Wanted> watched;
    if (watcher.watch)
      watched.emplace([w = watcher] {
        asking = true;
        const bool stop = w.watch(w.user) != 0;
        asking = false;
        if (stop) throw Stopped("stopped by the caller");
      });
    f();
    return TC_OK;
  } catch (abi::__forced_unwind&) {  // the thread is being cancelled
    throw;
  } catch (const UsageError& e) {
    return failed(TC_USAGE, e.what());
  } catch (const IoError& e) {
    return failed(TC_IO, e.what(), e.number);
  } catch (const FormatError& e) {
    return failed(TC_FORMAT, e.what());
  } catch (const InputError& e) {
    return failed(TC_FORMAT, e.what());
  } catch (const Stopped& e) {
    return failed(TC_STOPPED, e.what());
  } catch (const std::bad_alloc&) {
    return failed(TC_MEMORY, "there is not enough memory");
  } catch (const std::length_error&) {
    return failed(TC_MEMORY, "there is not enough memory");
  } catch (const std::exception& e) {
    return failed(TC_INTERNAL, e.what());
  } catch (...) {
    return failed(TC_INTERNAL, "unknown");
  }
}

void check(bool good, const char* expected) {
  if (!good) throw UsageError(fmt::format("expected {}", expected));
}

// Structures of the caller, whose header may be older or newer than this library. As long as none has grown, all have their first size.
template <class T>
class Structures {
 public:
  Structures(T* data, size_t size, const char* type) : data_(reinterpret_cast<char*>(data)), size_(size) {
    if (size < sizeof(T) || size > kMost) throw UsageError(fmt::format("size: expected sizeof({}), at least {}, found {}", type, sizeof(T), size));
  }
  void put(int64_t i, const T& value) {
    char* const to = data_ + i * static_cast<int64_t>(size_);
    std::memcpy(to, &value, sizeof value);
    std::memset(to + sizeof value, 0, size_ - sizeof value);
  }

 private:
  static constexpr size_t kMost = 4096;  // more is an argument in the wrong place
  char* const data_;
  const size_t size_;
};

const GridReader& reader_of(const tc_grid* grid) {
  check(grid != nullptr, "an open grid, found NULL");
  return grid->reader;
}

int axis_of(int axis) {
  if (axis < 0 || axis > 2) throw UsageError(fmt::format("axis: expected 0, 1 or 2 (x, y, z), found {}", axis));
  return axis;
}

int threads_of(int threads) {
  if (threads < 0 || threads > 1024) throw UsageError(fmt::format("threads: expected 0 (one per core) to 1024, found {}", threads));
  if (threads > 0) return threads;
  return system::cores();
}

Index3 index_of(const int64_t* from, const char* name) {
  check(from != nullptr, "three numbers, found NULL");
  for (int d = 0; d < 3; ++d)
    if (from[d] < -kFarthest || from[d] > kFarthest) throw UsageError(fmt::format("{}: expected numbers of at most 2^53, found {}", name, from[d]));
  return {from[0], from[1], from[2]};
}

Box box_of(const int64_t* lo, const int64_t* hi) { return {index_of(lo, "lo"), index_of(hi, "hi")}; }

// The part of a box that lies in a level.
Box within(const GridReader& reader, int level, Box box) {
  reader.meta().grid.check_level(level);
  const Index3 n = reader.meta().grid.cells(level);
  for (int d = 0; d < 3; ++d) {
    box.lo[d] = std::clamp<int64_t>(box.lo[d], 0, n[d]);
    box.hi[d] = std::clamp<int64_t>(box.hi[d], box.lo[d], n[d]);
  }
  return box;
}

void check_part(int64_t first, int64_t count, int64_t all, const char* what) {
  if (first < 0 || count < 0 || first > all || count > all - first)
    throw UsageError(fmt::format("expected {} among 0 to {} (half open), found {} from {}", what, all, count, first));
}

// The first level-0 cell of a coarse one, or the grid's end.
int64_t first_below(const Axis& axis, int level, int64_t cell) { return std::min(axis.cells(), cell << level); }

// The value of each material, all of which fit the type; none when it is the id.
std::vector<uint32_t> values_of(const GridReader& reader, const uint32_t* map, int64_t map_size, int type, uint32_t outside) {
  if (type != TC_U8 && type != TC_U16 && type != TC_U32) throw UsageError(fmt::format("type: expected TC_U8, TC_U16 or TC_U32, found {}", type));
  const std::vector<MaterialInfo>& materials = reader.meta().materials;
  const auto n = static_cast<int64_t>(materials.size());
  if (map && map_size < n) throw UsageError(fmt::format("map: expected a value for each of {} materials, found {}", n, map_size));
  const uint32_t most = type == TC_U8 ? 0xff : type == TC_U16 ? 0xffff : 0xffffffff;
  const auto fail = [&](const std::string& whose, uint32_t value) {
    throw UsageError(fmt::format("{}: expected a value of at most {}, which the type holds, found {}", whose, most, value));
  };
  if (outside > most) fail("outside", outside);
  if (!map && n - 1 > most) fail(fmt::format("material '{}'", materials[most + 1].name), most + 1);
  if (!map) return {};
  for (uint32_t id = 0; id < n; ++id)
    if (map[id] > most) fail(fmt::format("material '{}'", materials[id].name), map[id]);
  return {map, map + n};
}

// The elements that a read writes must have addresses.
void check_strides(const Index3& count, const Index3& stride) {
  __int128 reach = 0;
  for (int d = 0; d < 3; ++d)
    if (count[d] > 0) reach += static_cast<__int128>(count[d] - 1) * std::abs(stride[d]);
  check(reach < std::numeric_limits<int64_t>::max() / 8, "strides and a box that fit into memory");
}

void read_cells(const GridReader& reader, int level, const Lattice& lattice, int type, void* data, const int64_t* strides, uint32_t outside,
                const uint32_t* map, int64_t map_size, int threads) {
  const Index3 stride = index_of(strides, "stride");
  const std::vector<uint32_t> values = values_of(reader, map, map_size, type, outside);
  for (int d = 0; d < 3; ++d) {
    check(lattice.step[d] > 0, "steps above 0");
    check(lattice.count[d] >= 0, "counts of at least 0");
    check(static_cast<__int128>(lattice.count[d]) * lattice.step[d] <= kFarthest, "a box of at most 2^53 cells along an axis");
  }
  check_strides(lattice.count, stride);
  if (lattice.count[0] == 0 || lattice.count[1] == 0 || lattice.count[2] == 0) return;
  for (int d = 0; d < 3; ++d) check(lattice.count[d] == 1 || stride[d] != 0, "strides other than 0 where there are several cells");
  check(data != nullptr, "memory for the cells, found NULL");
  const SetValue id = strongest_material(reader.meta());
  const SetValue value = values.empty() ? id : [&](const std::vector<Label>& set) { return values[id(set)]; };
  const auto read = [&]<class T>(T* cells) {
    read_lattice<T>(reader, level, lattice, value, static_cast<T>(outside), cells, stride, threads_of(threads));
  };
  if (type == TC_U8) read(static_cast<uint8_t*>(data));
  else if (type == TC_U16) read(static_cast<uint16_t*>(data));
  else read(static_cast<uint32_t*>(data));
}

}  // namespace

const char* tc_version(void) { return TERACELL_VERSION; }

const char* tc_error(void) { return last_error.c_str(); }

int tc_errno(void) { return last_errno; }

int tc_open(const char* path, tc_grid** grid) { return tc_open_source(path, nullptr, 0, grid); }

int tc_open_source(const char* path, const tc_source* source, size_t size, tc_grid** grid) {
  return guarded([&] {
    check(path != nullptr && grid != nullptr, "a path and a place for the grid, found NULL");
    *grid = nullptr;
    tc_source given{};  // an older program knows fewer members
    if (source != nullptr) std::memcpy(&given, source, std::min(size, sizeof given));
    SourceOptions options;
    if (given.cache_dir != nullptr) options.cache_dir = given.cache_dir;
    if (given.cache_dir_bytes != 0) options.cache_dir_bytes = given.cache_dir_bytes;
    if (given.endpoint != nullptr) options.endpoint = given.endpoint;
    options.allow_http = given.allow_http != 0;
    *grid = new tc_grid(path, options);
  });
}

tc_grid* tc_share(tc_grid* grid) {
  if (grid) ++grid->owners;
  return grid;
}

void tc_close(tc_grid* grid) {
  if (grid && --grid->owners == 0) delete grid;
}

int tc_levels(const tc_grid* grid) { return grid ? grid->reader.levels() : 0; }

int tc_ray_axis(const tc_grid* grid) { return grid ? grid->reader.meta().ray_axis : 0; }

const char* tc_units(const tc_grid* grid) { return grid ? grid->reader.meta().units.c_str() : ""; }

const char* tc_hash(const tc_grid* grid) { return grid ? grid->hash.c_str() : ""; }

int tc_info(const tc_grid* grid, const char** json) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    check(json != nullptr, "a place for the text, found NULL");
    grid->info_made([&] { grid->info = info_json(reader); });
    *json = grid->info.c_str();
  });
}

int tc_shape(const tc_grid* grid, int level, int64_t cells[3]) {
  return guarded([&] {
    const Grid& g = reader_of(grid).meta().grid;
    g.check_level(level);
    check(cells != nullptr, "a place for three numbers, found NULL");
    std::ranges::copy(g.cells(level), cells);
  });
}

int tc_planes(const tc_grid* grid, int level, int axis, int64_t first, int64_t count, double* out) {
  return guarded([&] {
    const Grid& g = reader_of(grid).meta().grid;
    g.check_level(level);
    const Axis& a = g.axis[axis_of(axis)];
    check_part(first, count, g.cells(level)[axis] + 1, "planes");
    check(out != nullptr || count == 0, "memory for the planes, found NULL");
    for (int64_t i = 0; i < count; ++i) out[i] = a.plane(first_below(a, level, first + i));
  });
}

int tc_samples(const tc_grid* grid, int level, int axis, int64_t first, int64_t count, double* out) {
  return guarded([&] {
    const Grid& g = reader_of(grid).meta().grid;
    g.check_level(level);
    const Axis& a = g.axis[axis_of(axis)];
    check_part(first, count, g.cells(level)[axis], "cells");
    check(out != nullptr || count == 0, "memory for the sample points, found NULL");
    for (int64_t i = 0; i < count; ++i) {
      const int64_t from = first_below(a, level, first + i), to = first_below(a, level, first + i + 1);
      out[i] = to - from == 1 ? a.centre(from) : 0.5 * (a.centre(from) + a.centre(to - 1));
    }
  });
}

int64_t tc_material_count(const tc_grid* grid) { return grid ? static_cast<int64_t>(grid->materials.size()) : 0; }

int tc_materials(const tc_grid* grid, int64_t first, int64_t count, tc_material* out, size_t size) {
  return guarded([&] {
    reader_of(grid);
    check_part(first, count, tc_material_count(grid), "materials");
    check(out != nullptr || count == 0, "memory for the materials, found NULL");
    Structures structures(out, size, "tc_material");
    for (int64_t i = 0; i < count; ++i) structures.put(i, grid->materials[static_cast<size_t>(first + i)]);
  });
}

int tc_read_box(const tc_grid* grid, int level, const int64_t lo[3], const int64_t hi[3], int type, void* data, const int64_t stride[3],
                uint32_t outside, const uint32_t* map, int64_t map_size, int threads) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    const Box box = box_of(lo, hi);
    Lattice lattice{box.lo};
    for (int d = 0; d < 3; ++d) lattice.count[d] = std::max<int64_t>(0, box.hi[d] - box.lo[d]);
    read_cells(reader, level, lattice, type, data, stride, outside, map, map_size, threads);
  });
}

int tc_read_lattice(const tc_grid* grid, int level, const int64_t first[3], const int64_t count[3], const int64_t step[3], int type, void* data,
                    const int64_t stride[3], uint32_t outside, const uint32_t* map, int64_t map_size, int threads) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    const Lattice lattice{index_of(first, "first"), index_of(count, "count"), index_of(step, "step")};
    read_cells(reader, level, lattice, type, data, stride, outside, map, map_size, threads);
  });
}

int tc_runs(const tc_grid* grid, int level, const int64_t lo[3], const int64_t hi[3], int (*visit)(void*, const tc_run*), void* user) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    check(visit != nullptr, "a function to call, found NULL");
    const Metadata& meta = reader.meta();
    const SetValue strongest = strongest_material(meta);
    for_each_run(reader, level, within(reader, level, box_of(lo, hi)), [&](const BoxRun& run) {
      const std::vector<uint32_t> materials = materials_of(meta, *run.set);
      const tc_run out{
          {run.start[0], run.start[1], run.start[2]}, run.length, strongest(*run.set), static_cast<uint32_t>(materials.size()), materials.data()};
      if (visit(user, &out) != 0) throw Stopped("stopped by the caller");
    });
  });
}

int tc_column(const tc_grid* grid, int axis, int64_t a, int64_t b, int64_t from, int64_t to, tc_column_run* runs, size_t size, int64_t capacity,
              int64_t* count) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    check(count != nullptr, "a place for the number of runs, found NULL");
    check(capacity >= 0 && (runs != nullptr || capacity == 0), "memory for the runs");
    Structures structures(runs, size, "tc_column_run");
    const int64_t n = reader.meta().grid.axis[axis_of(axis)].cells();
    const int64_t lo = std::clamp<int64_t>(from, 0, n), hi = std::clamp<int64_t>(to, 0, n);
    const std::vector<ColumnRun> found = lo < hi ? read_column(reader, axis, a, b, lo, hi) : std::vector<ColumnRun>();
    *count = static_cast<int64_t>(found.size());
    for (int64_t i = 0; i < std::min(*count, capacity); ++i) {
      const ColumnRun& run = found[static_cast<size_t>(i)];
      structures.put(i, {run.from, run.to, run.material});
    }
  });
}

int tc_stats(const tc_grid* grid, const int64_t lo[3], const int64_t hi[3], tc_cells* by_material, size_t size, int64_t count) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    check(by_material != nullptr, "memory for the counts, found NULL");
    Structures structures(by_material, size, "tc_cells");
    const int64_t materials = tc_material_count(grid);
    if (count != materials) throw UsageError(fmt::format("count: expected {}, the number of materials, found {}", materials, count));
    const std::vector<CellStats> stats = read_stats(reader, within(reader, 0, box_of(lo, hi)));
    for (int64_t id = 0; id < materials; ++id) {
      const auto& [cells, volume, box] = stats[static_cast<size_t>(id)];
      tc_cells out{static_cast<uint64_t>(cells), static_cast<uint64_t>(cells >> 64), volume, {}, {}};
      std::ranges::copy(box.lo, out.lo), std::ranges::copy(box.hi, out.hi);
      structures.put(id, out);
    }
  });
}

int tc_uniform(const tc_grid* grid, int level, const int64_t lo[3], const int64_t hi[3], int* uniform, uint32_t* material) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    check(uniform != nullptr && material != nullptr, "places for the answers, found NULL");
    const Box box = within(reader, level, box_of(lo, hi));
    check(!box.empty(), "a box with cells of the grid, found an empty one");
    const std::optional<uint32_t> one = uniform_value(reader, level, box, strongest_material(reader.meta()));
    *uniform = one ? 1 : 0;
    if (one) *material = *one;
  });
}

int tc_fractions(const tc_grid* grid, uint32_t material, const int64_t lo[3], const int64_t hi[3], double* data, const int64_t stride[3],
                 double outside, int threads) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    grid->fractions_opened([&] { grid->fractions = std::make_unique<FractionReader>(reader); });
    if (material >= grid->materials.size())
      throw UsageError(fmt::format("material: expected 0 to {}, found {}", grid->materials.size() - 1, material));
    Box box = box_of(lo, hi);
    Index3 count;
    for (int d = 0; d < 3; ++d) box.hi[d] = std::max(box.lo[d], box.hi[d]), count[d] = box.hi[d] - box.lo[d];
    const Index3 strides = index_of(stride, "stride");
    check_strides(count, strides);
    if (box.empty()) return;
    for (int d = 0; d < 3; ++d) check(count[d] == 1 || strides[d] != 0, "strides other than 0 where there are several cells");
    check(data != nullptr, "memory for the shares, found NULL");
    grid->fractions->read_box<double>(box, material, outside, data, strides, threads_of(threads));
  });
}

int64_t tc_patch_count(const tc_grid* grid) { return grid ? static_cast<int64_t>(grid->reader.meta().patches.size()) : 0; }

int tc_patches(const tc_grid* grid, int64_t first, int64_t count, tc_patch* out, size_t size) {
  return guarded([&] {
    const std::vector<PatchInfo>& patches = reader_of(grid).meta().patches;
    check_part(first, count, tc_patch_count(grid), "patches");
    check(out != nullptr || count == 0, "memory for the patches, found NULL");
    Structures structures(out, size, "tc_patch");
    for (int64_t i = 0; i < count; ++i) {
      const PatchInfo& p = patches[static_cast<size_t>(first + i)];
      structures.put(i, tc_patch{p.name.c_str(), p.body.c_str(), p.area});
    }
  });
}

int tc_links(const tc_grid* grid, int axis, const int64_t lo[3], const int64_t hi[3], int (*visit)(void*, const tc_link*), void* user) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    check(axis >= 0 && axis <= 2, "axis 0, 1 or 2");
    check(visit != nullptr, "a function to call, found NULL");
    grid->links_opened([&] { grid->links = std::make_unique<LinkReader>(reader); });
    grid->links->for_each(axis, box_of(lo, hi), [&](std::span<const CellLink> links) {
      for (const CellLink& l : links) {
        const tc_link out{{l.cell[0], l.cell[1], l.cell[2]}, l.end, l.begin, l.patch == kNoPatch ? -1 : int64_t{l.patch}};
        if (visit(user, &out) != 0) throw Stopped("stopped by the caller");
      }
    });
  });
}

int tc_leaves(const tc_grid* grid, const int64_t lo[3], const int64_t hi[3], int coarsest, int layers, const char* want, int threads,
              int (*visit)(void*, const tc_leaf*), void* user) {
  return guarded([&] {
    const GridReader& reader = reader_of(grid);
    check(visit != nullptr, "a function to call, found NULL");
    const int workers = threads_of(threads);
    const Refinement refinement = parse_refinement(reader.meta(), coarsest, layers, want == nullptr ? "" : want);
    const Box box = within(reader, 0, box_of(lo, hi));
    if (box.empty()) return;
    const auto watched = [](double) { Wanted::stop_if_not(); };
    Leaves leaves(reader, refinement, temporary_folder());
    leaves.prepare(box, workers, watched);
    leaves.for_each(box, workers, watched, [&](std::span<const Leaf> found) {
      for (const Leaf& leaf : found) {
        const tc_leaf out{{leaf.cell[0], leaf.cell[1], leaf.cell[2]}, leaf.level, reader.meta().labels[leaf.label].material};
        if (visit(user, &out) != 0) throw Stopped("stopped by the caller");
      }
    });
  });
}

int tc_partition_open(const char* path, tc_partition** partition) {
  return guarded([&] {
    check(path != nullptr && partition != nullptr, "a path and a place for the partition, found NULL");
    *partition = nullptr;
    const InputFile file(path);
    if (file.size() > kMostPartition)
      throw InputError(fmt::format("{}: expected a partition of at most {} bytes, found {}", path, kMostPartition, file.size()));
    std::string text(file.size(), '\0');
    file.read(0, {reinterpret_cast<uint8_t*>(text.data()), text.size()});
    *partition = new tc_partition{parse_partition(text)};
  });
}

void tc_partition_close(tc_partition* partition) { delete partition; }

int tc_partition_plan(const tc_partition* partition, tc_plan* plan, size_t size) {
  return guarded([&] {
    check(partition != nullptr && plan != nullptr, "a partition and a place for its plan, found NULL");
    const Partition& p = partition->read;
    tc_plan out{p.options.ranks, {}, p.options.align, p.options.halo, p.total, name_of(p.options.method), p.grid_hash.c_str()};
    std::ranges::copy(p.cells, out.cells);
    Structures(plan, size, "tc_plan").put(0, out);
  });
}

int tc_partition_part(const tc_partition* partition, int64_t rank, tc_part* part, size_t size) {
  return guarded([&] {
    check(partition != nullptr && part != nullptr, "a partition and a place for the part, found NULL");
    const std::vector<Part>& parts = partition->read.parts;
    if (rank < 0 || rank >= static_cast<int64_t>(parts.size()))
      throw UsageError(fmt::format("rank: expected 0 to {}, found {}", parts.size() - 1, rank));
    const Part& p = parts[static_cast<size_t>(rank)];
    tc_part out{{}, {}, {}, {}, p.weight, p.neighbours.data(), static_cast<int64_t>(p.neighbours.size())};
    std::ranges::copy(p.box.lo, out.lo), std::ranges::copy(p.box.hi, out.hi);
    std::ranges::copy(p.halo_box.lo, out.halo_lo), std::ranges::copy(p.halo_box.hi, out.halo_hi);
    Structures(part, size, "tc_part").put(0, out);
  });
}

tc_watcher tc_watch(tc_watcher next) { return std::exchange(watcher, next); }

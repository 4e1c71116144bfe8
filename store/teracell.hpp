// teracell for C++20: grids with a destructor, spans and exceptions over the functions of teracell.h, which has the definitions.
//
//   tc::Grid grid("stadium.tcell");
//   std::vector<uint8_t> cells = grid.read<uint8_t>({{0, 0, 0}, {64, 64, 64}});  // [z][y][x]
#pragma once
#if __cplusplus < 202002L
#error "teracell.hpp needs C++20: -std=c++20, or in CMake set(CMAKE_CXX_STANDARD 20). For older standards there is teracell.h"
#endif
#include <array>
#include <concepts>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "teracell.h"

namespace tc {

using Index = std::array<int64_t, 3>;  // x, y, z

// Half open: lo <= cell < hi.
struct Box {
  Index lo{}, hi{};
  Index shape() const { return {hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]}; }
  size_t cells() const {  // 0 for a box that is inverted
    const auto n = shape();
    return n[0] > 0 && n[1] > 0 && n[2] > 0 ? static_cast<size_t>(n[0]) * static_cast<size_t>(n[1]) * static_cast<size_t>(n[2]) : 0;
  }
  friend bool operator==(const Box&, const Box&) = default;
};

struct Error : std::runtime_error {
  Error(int s, const char* message, int number = 0) : std::runtime_error(message), status(s), error_number(number) {}
  int status;        // TC_USAGE ...
  int error_number;  // the errno of a TC_IO, where it is known
};

inline void check(int status) {
  if (status != TC_OK) throw Error(status, tc_error(), tc_errno());
}

template <class T>
concept Element = std::same_as<T, uint8_t> || std::same_as<T, uint16_t> || std::same_as<T, uint32_t>;

// How cells are read; the defaults are ids of materials of level 0, x fastest, on every core.
struct Reading {
  int level = 0;
  uint32_t outside = 0;                // the value of cells outside the grid
  std::span<const uint32_t> map = {};  // the value of each material; empty: its id
  std::optional<Index> stride = {};    // in elements; absent: {1, nx, nx * ny}
  int threads = 0;                     // 0: one per core
};

// Any number of threads may use one grid. Every function throws Error.
class Grid {
 public:
  explicit Grid(const std::string& path) {
    tc_grid* opened = nullptr;
    check(tc_open(path.c_str(), &opened));
    grid_.reset(opened);
  }

  const tc_grid* get() const { return grid_.get(); }
  int levels() const { return tc_levels(get()); }
  int ray_axis() const { return tc_ray_axis(get()); }
  std::string_view units() const { return tc_units(get()); }
  std::string_view hash() const { return tc_hash(get()); }
  std::string_view info() const {
    const char* json = nullptr;
    check(tc_info(get(), &json));
    return json;
  }
  Index shape(int level = 0) const {
    Index n;
    check(tc_shape(get(), level, n.data()));
    return n;
  }
  Box box(int level = 0) const { return {{0, 0, 0}, shape(level)}; }
  std::vector<double> planes(int axis, int level = 0) const {
    std::vector<double> out(static_cast<size_t>(length(axis, level) + 1));
    check(tc_planes(get(), level, axis, 0, static_cast<int64_t>(out.size()), out.data()));
    return out;
  }
  std::vector<double> samples(int axis, int level = 0) const {
    std::vector<double> out(static_cast<size_t>(length(axis, level)));
    check(tc_samples(get(), level, axis, 0, static_cast<int64_t>(out.size()), out.data()));
    return out;
  }
  // By id.
  std::vector<tc_material> materials() const {
    std::vector<tc_material> out(static_cast<size_t>(tc_material_count(get())));
    check(tc_materials(get(), 0, static_cast<int64_t>(out.size()), out.data(), sizeof(tc_material)));
    return out;
  }

  // Reads the cells of a box into `out`, which must have an element for each, unless the caller gives strides of its own.
  template <Element T>
  void read(const Box& box, std::span<T> out, const Reading& how = {}) const {
    const Index n = box.shape(), stride = how.stride.value_or(Index{1, n[0], n[0] * n[1]});
    if (!how.stride && out.size() != box.cells()) throw Error(TC_USAGE, "expected memory for as many elements as the box has cells");
    double last = 0;  // the farthest element; those before the first one can't be in the span
    for (size_t d = 0; d < 3; ++d) {
      if (n[d] > 1 && stride[d] < 0) throw Error(TC_USAGE, "expected strides of at least 0; take tc_read_box() for others");
      if (n[d] > 1) last += static_cast<double>(n[d] - 1) * static_cast<double>(stride[d]);
    }
    if (n[0] > 0 && n[1] > 0 && n[2] > 0 && last >= static_cast<double>(out.size()))
      throw Error(TC_USAGE, "expected memory for the elements that the strides reach");
    check(tc_read_box(get(), how.level, box.lo.data(), box.hi.data(), static_cast<int>(sizeof(T)), out.data(), stride.data(), how.outside,
                      how.map.empty() ? nullptr : how.map.data(), static_cast<int64_t>(how.map.size()), how.threads));
  }
  // As an array [z][y][x].
  template <Element T>
  std::vector<T> read(const Box& box, const Reading& how = {}) const {
    if (how.stride) throw Error(TC_USAGE, "expected no strides: the array that is made is [z][y][x]");
    std::vector<T> out(box.cells());
    read<T>(box, std::span(out), how);
    return out;
  }

  // Calls visit(const tc_run&) for the runs of a box. What it throws ends the reading and is thrown here.
  template <class Visit>
  void runs(const Box& box, Visit&& visit, int level = 0) const {
    visited<tc_run>(visit, [&](auto call, void* user) { return tc_runs(get(), level, box.lo.data(), box.hi.data(), call, user); });
  }
  // The column of level 0 along `axis` through (a, b).
  std::vector<tc_column_run> column(int axis, int64_t a, int64_t b) const {
    std::vector<tc_column_run> runs;
    int64_t count = 16;
    do {
      runs.resize(static_cast<size_t>(count));
      check(tc_column(get(), axis, a, b, 0, length(axis, 0), runs.data(), sizeof(tc_column_run), static_cast<int64_t>(runs.size()), &count));
    } while (count > static_cast<int64_t>(runs.size()));
    runs.resize(static_cast<size_t>(count));
    return runs;
  }
  // Exact counts of level 0, by material.
  std::vector<tc_cells> stats(const Box& box) const {
    std::vector<tc_cells> out(static_cast<size_t>(tc_material_count(get())));
    check(tc_stats(get(), box.lo.data(), box.hi.data(), out.data(), sizeof(tc_cells), static_cast<int64_t>(out.size())));
    return out;
  }
  // The material of all cells of a box, if they have the same one.
  std::optional<uint32_t> uniform(const Box& box, int level = 0) const {
    int one = 0;
    uint32_t material = 0;
    check(tc_uniform(get(), level, box.lo.data(), box.hi.data(), &one, &material));
    return one ? std::optional(material) : std::nullopt;
  }

  // The share of a material in each cell of a box of level 0, from 0 to 1, as an array [z][y][x].
  std::vector<double> fractions(uint32_t material, const Box& box, double outside = 0, int threads = 0) const {
    std::vector<double> out(box.cells());
    const Index n = box.shape(), stride{1, n[0], n[0] * n[1]};
    check(tc_fractions(get(), material, box.lo.data(), box.hi.data(), out.data(), stride.data(), outside, threads));
    return out;
  }

  // By number.
  std::vector<tc_patch> patches() const {
    std::vector<tc_patch> out(static_cast<size_t>(tc_patch_count(get())));
    check(tc_patches(get(), 0, static_cast<int64_t>(out.size()), out.data(), sizeof(tc_patch)));
    return out;
  }
  // Calls visit(const tc_link&) for the links along an axis (0, 1, 2 for x, y, z) whose cells lie in a box of level 0. What it throws ends the
  // reading and is thrown here.
  template <class Visit>
  void links(int axis, const Box& box, Visit&& visit) const {
    visited<tc_link>(visit, [&](auto call, void* user) { return tc_links(get(), axis, box.lo.data(), box.hi.data(), call, user); });
  }

  // How a grid is refined: as tc_leaves() says.
  struct Refined {
    int coarsest, layers = 2;
    std::string want{};
    int threads = 0;
  };
  // Calls visit(const tc_leaf&) for the leaves that have a cell in a box of level 0, in Morton order. What it throws ends the reading and is
  // thrown here.
  template <class Visit>
  void leaves(const Box& box, const Refined& how, Visit&& visit) const {
    visited<tc_leaf>(visit, [&](auto call, void* user) {
      return tc_leaves(get(), box.lo.data(), box.hi.data(), how.coarsest, how.layers, how.want.c_str(), how.threads, call, user);
    });
  }

 private:
  struct Close {
    void operator()(tc_grid* grid) const { tc_close(grid); }
  };
  // Calls read(function, argument), which calls the function with each T, and takes what visit(T) throws past the C functions.
  template <class T, class Visit, class Read>
  static void visited(Visit& visit, Read&& read) {
    struct Call {
      Visit& visit;
      std::exception_ptr error;
    } call{visit, nullptr};
    const auto forward = [](void* user, const T* value) {
      Call& c = *static_cast<Call*>(user);
      try {
        c.visit(*value);
        return 0;
      } catch (...) {
        c.error = std::current_exception();
        return 1;
      }
    };
    const int status = read(static_cast<int (*)(void*, const T*)>(forward), &call);
    if (call.error) std::rethrow_exception(call.error);
    check(status);
  }
  int64_t length(int axis, int level) const {
    if (axis < 0 || axis > 2) throw Error(TC_USAGE, "axis: expected 0, 1 or 2 (x, y, z)");
    return shape(level)[static_cast<size_t>(axis)];
  }
  std::unique_ptr<tc_grid, Close> grid_;
};

struct Part {
  Box box;       // the cells of level 0 that the rank computes
  Box halo_box;  // those that it reads: with the halo, clipped to the grid
  double weight = 0;
  std::span<const int64_t> neighbours;  // ranks, ascending; valid as long as the partition
};

// A file that `teracell partition` has written. Threads may share it. Every function throws Error.
class Partition {
 public:
  explicit Partition(const std::string& path) {
    tc_partition* opened = nullptr;
    check(tc_partition_open(path.c_str(), &opened));
    partition_.reset(opened);
  }
  const tc_partition* get() const { return partition_.get(); }
  // What holds for all parts; its texts are valid as long as the partition.
  tc_plan plan() const {
    tc_plan out;
    check(tc_partition_plan(get(), &out, sizeof out));
    return out;
  }
  Part part(int64_t rank) const {
    tc_part p;
    check(tc_partition_part(get(), rank, &p, sizeof p));
    const auto index = [](const int64_t* n) { return Index{n[0], n[1], n[2]}; };
    return {{index(p.lo), index(p.hi)}, {index(p.halo_lo), index(p.halo_hi)}, p.weight, {p.neighbours, static_cast<size_t>(p.count)}};
  }

 private:
  struct Close {
    void operator()(tc_partition* partition) const { tc_partition_close(partition); }
  };
  std::unique_ptr<tc_partition, Close> partition_;
};

}  // namespace tc

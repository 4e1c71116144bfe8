// A wave of pressure in air, on as many ranks as there are: each reads its own box of cells with a layer of ghost cells around it, and
// exchanges that layer of pressures at every step. The numbers that are printed are the same, to the last bit, for any number of ranks.
//
//   mpicxx -std=c++20 -O2 wave_mpi.cpp $(pkg-config --cflags --libs teracell) -o wave_mpi
//   mpirun -n 4 ./wave_mpi stadium.tcell air [STEPS [CELLS]]
//
// It takes the finest level with at most CELLS (default 200) cells along each axis. Cells of other materials than air reflect, and so do
// the sides of the grid. u is the pressure, and du = u(t) - u(t - 1): du += c^2 * (sum over neighbours in air of (their u - u)); u += du.
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <teracell.hpp>

namespace {

constexpr double kCourant2 = 0.25;  // (sound speed * time step / cell)^2, below 1/3

// A rank's box of the level, with a ghost layer: cell (x, y, z) of the level is at index(x, y, z).
struct Block {
  tc::Box box;
  tc::Index n;  // with the ghost layers
  explicit Block(const tc::Box& b) : box(b), n{b.hi[0] - b.lo[0] + 2, b.hi[1] - b.lo[1] + 2, b.hi[2] - b.lo[2] + 2} {}
  size_t index(int64_t x, int64_t y, int64_t z) const {
    return static_cast<size_t>(((z - box.lo[2] + 1) * n[1] + (y - box.lo[1] + 1)) * n[0] + (x - box.lo[0] + 1));
  }
  bool has(const tc::Index& c) const {
    return c[0] >= box.lo[0] && c[0] < box.hi[0] && c[1] >= box.lo[1] && c[1] < box.hi[1] && c[2] >= box.lo[2] && c[2] < box.hi[2];
  }
  size_t size() const { return static_cast<size_t>(n[0] * n[1] * n[2]); }
};

// The layer of cells on one side of the block, within it or the ghost layer next to it, packed into a buffer and back.
template <class F>
void for_layer(const Block& b, int axis, int64_t at, F&& f) {
  tc::Box layer{b.box.lo, b.box.hi};
  layer.lo[static_cast<size_t>(axis)] = at, layer.hi[static_cast<size_t>(axis)] = at + 1;
  for (int64_t z = layer.lo[2]; z < layer.hi[2]; ++z)
    for (int64_t y = layer.lo[1]; y < layer.hi[1]; ++y)
      for (int64_t x = layer.lo[0]; x < layer.hi[0]; ++x) f(b.index(x, y, z));
}

void exchange(const Block& b, MPI_Comm ranks, std::vector<double>& u) {
  std::vector<double> out, in;
  for (int axis = 0; axis < 3; ++axis)
    for (const int up : {0, 1}) {
      int from, to;
      MPI_Cart_shift(ranks, axis, up ? 1 : -1, &from, &to);
      const auto a = static_cast<size_t>(axis);
      const int64_t send = up ? b.box.hi[a] - 1 : b.box.lo[a], receive = up ? b.box.lo[a] - 1 : b.box.hi[a];
      out.clear();
      for_layer(b, axis, send, [&](size_t i) { out.push_back(u[i]); });
      in.resize(out.size());
      MPI_Sendrecv(out.data(), static_cast<int>(out.size()), MPI_DOUBLE, to, axis, in.data(), static_cast<int>(in.size()), MPI_DOUBLE, from, axis,
                   ranks, MPI_STATUS_IGNORE);
      if (from == MPI_PROC_NULL) continue;
      size_t k = 0;
      for_layer(b, axis, receive, [&](size_t i) { u[i] = in[k++]; });
    }
}

void run(const tc::Grid& grid, const std::string& air, int steps, int64_t most) {
  int level = 0;
  while (std::ranges::max(grid.shape(level)) > most) ++level;
  const tc::Index n = grid.shape(level);
  const auto materials = grid.materials();
  const auto found = std::ranges::find(materials, std::string_view(air), &tc_material::name);
  if (found == materials.end()) throw std::runtime_error("the grid has no material " + air);
  const auto id = static_cast<uint32_t>(found - materials.begin());

  int size, rank, dims[3] = {0, 0, 0}, place[3];
  const int no[3] = {0, 0, 0};
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  MPI_Dims_create(size, 3, dims);
  MPI_Comm ranks;
  MPI_Cart_create(MPI_COMM_WORLD, 3, dims, no, 1, &ranks);
  MPI_Comm_rank(ranks, &rank);
  MPI_Cart_coords(ranks, rank, 3, place);
  tc::Box box;
  for (size_t d = 0; d < 3; ++d) box.lo[d] = n[d] * place[d] / dims[d], box.hi[d] = n[d] * (place[d] + 1) / dims[d];
  const Block b(box);

  // 1 for air; everything else, and what lies outside the grid, is a wall.
  std::vector<uint32_t> is_air(materials.size(), 0);
  is_air[id] = 1;
  const tc::Box with_ghosts{{box.lo[0] - 1, box.lo[1] - 1, box.lo[2] - 1}, {box.hi[0] + 1, box.hi[1] + 1, box.hi[2] + 1}};
  const std::vector<uint8_t> open = grid.read<uint8_t>(with_ghosts, {.level = level, .outside = 0, .map = is_air, .threads = 1});

  std::vector<double> u(b.size(), 0), du(b.size(), 0);
  const auto for_air = [&](auto&& f) {
    for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
      for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
        for (int64_t x = box.lo[0]; x < box.hi[0]; ++x)
          if (const size_t i = b.index(x, y, z); open[i]) f(x, y, z, i);
  };
  const tc::Index centre = {n[0] / 2, n[1] / 2, n[2] / 2};
  for_air([&](int64_t x, int64_t y, int64_t z, size_t i) {  // a burst in the middle
    const auto r2 = static_cast<double>((x - centre[0]) * (x - centre[0]) + (y - centre[1]) * (y - centre[1]) + (z - centre[2]) * (z - centre[2]));
    if (r2 < 16) u[i] = 1;
  });
  const int64_t sx = 1, sy = b.n[0], sz = b.n[0] * b.n[1];
  for (int step = 0; step < steps; ++step) {
    exchange(b, ranks, u);
    for_air([&](int64_t, int64_t, int64_t, size_t i) {
      double sum = 0;
      for (const int64_t s : {-sx, sx, -sy, sy, -sz, sz})
        if (const size_t next = i + static_cast<size_t>(s); open[next]) sum += u[next] - u[i];
      du[i] += kCourant2 * sum;
    });
    for_air([&](int64_t, int64_t, int64_t, size_t i) { u[i] += du[i]; });
  }

  // The maximum does not depend on the order of ranks, as a sum of doubles would.
  double loudest = 0, all = 0;
  for_air([&](int64_t, int64_t, int64_t, size_t i) { loudest = std::max(loudest, u[i]); });
  MPI_Reduce(&loudest, &all, 1, MPI_DOUBLE, MPI_MAX, 0, ranks);
  if (rank == 0)
    std::printf("%lld x %lld x %lld cells of level %d, %d steps\nhighest pressure %.17g\n", static_cast<long long>(n[0]),
                static_cast<long long>(n[1]), static_cast<long long>(n[2]), level, steps, all);
  for (int gauge = 1; gauge < 8; ++gauge) {  // on a diagonal
    const tc::Index at = {n[0] * gauge / 8, n[1] * gauge / 8, n[2] * gauge / 8};
    double here = b.has(at) ? u[b.index(at[0], at[1], at[2])] : -1e300, value;
    MPI_Reduce(&here, &value, 1, MPI_DOUBLE, MPI_MAX, 0, ranks);
    if (rank == 0) std::printf("gauge %d %.17g\n", gauge, value);
  }
  MPI_Comm_free(&ranks);
}

// A launcher of another MPI starts processes that each believe to be alone, and would all compute the whole.
void expect_own_launcher() {
  int size;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* launched = std::getenv(name); size == 1 && launched && std::atoi(launched) > 1)
      throw std::runtime_error(std::string("expected ") + launched + " ranks, found 1: start it with the mpirun of the MPI that it was built with");
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  try {
    expect_own_launcher();
    if (argc < 3) throw std::runtime_error("usage: wave_mpi GRID.tcell MATERIAL [STEPS [CELLS]]");
    run(tc::Grid(argv[1]), argv[2], argc > 3 ? std::atoi(argv[3]) : 200, argc > 4 ? std::atoi(argv[4]) : 200);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "wave_mpi: %s\n", e.what());
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  MPI_Finalize();
}

// The share of a material in each layer of cells along z, from runs: no cell is expanded.
//
//   c++ -std=c++20 porosity.cpp $(pkg-config --cflags --libs teracell) -o porosity && ./porosity stadium.tcell air
#include <algorithm>
#include <cstdio>
#include <teracell.hpp>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: porosity GRID.tcell MATERIAL\n");
    return 2;
  }
  const tc::Grid grid(argv[1]);
  const auto materials = grid.materials();
  const auto found = std::ranges::find(materials, std::string_view(argv[2]), &tc_material::name);
  if (found == materials.end()) throw std::runtime_error("the grid has no material " + std::string(argv[2]));
  const auto id = static_cast<uint32_t>(found - materials.begin());

  const auto [nx, ny, nz] = grid.shape();
  std::vector<int64_t> cells(static_cast<size_t>(nz));
  grid.runs(grid.box(), [&](const tc_run& run) {
    if (run.material != id) return;
    if (grid.ray_axis() != 2) cells[static_cast<size_t>(run.start[2])] += run.length;
    else
      for (int64_t z = run.start[2]; z < run.start[2] + run.length; ++z) ++cells[static_cast<size_t>(z)];
  });
  const std::vector<double> z = grid.samples(2);
  for (size_t k = 0; k < cells.size(); ++k) std::printf("%g %g\n", z[k], static_cast<double>(cells[k]) / static_cast<double>(nx * ny));
} catch (const std::exception& e) {
  std::fprintf(stderr, "porosity: %s\n", e.what());
  return 1;
}

// Reads lines "coarsest layers want x0 y0 z0 x1 y1 z1" and writes the leaves of the box, a line for each, through the C++ header.
#include <iostream>

#include <teracell.hpp>

int main(int, char** argv) try {
  const tc::Grid grid(argv[1]);
  tc::Grid::Refined how{};
  tc::Box box;
  while (std::cin >> how.coarsest >> how.layers >> how.want >> box.lo[0] >> box.lo[1] >> box.lo[2] >> box.hi[0] >> box.hi[1] >> box.hi[2])
    grid.leaves(box, how, [](const tc_leaf& l) {
      std::cout << l.level << ' ' << l.cell[0] << ' ' << l.cell[1] << ' ' << l.cell[2] << ' ' << l.material << '\n';
    });
} catch (const tc::Error& e) {
  std::cerr << e.what() << '\n';
  return 1;
}

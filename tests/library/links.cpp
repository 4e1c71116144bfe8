// Reads lines "axis x0 y0 z0 x1 y1 z1" and writes the links of the box, a line for each, through the C++ header.
#include <iostream>

#include <teracell.hpp>

int main(int, char** argv) try {
  const tc::Grid grid(argv[1]);
  int axis = 0;
  tc::Box box;
  while (std::cin >> axis >> box.lo[0] >> box.lo[1] >> box.lo[2] >> box.hi[0] >> box.hi[1] >> box.hi[2])
    grid.links(axis, box, [](const tc_link& l) {
      std::cout << l.cell[0] << ' ' << l.cell[1] << ' ' << l.cell[2] << ' ' << l.end << ' ' << l.begin << ' ' << l.patch << '\n';
    });
} catch (const tc::Error& e) {
  std::cerr << e.what() << '\n';
  return 1;
}

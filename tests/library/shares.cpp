// Reads lines "material x0 y0 z0 x1 y1 z1" and writes the shares of the box, [z][y][x], through the C++ header.
#include <iostream>

#include <teracell.hpp>

int main(int, char** argv) try {
  const tc::Grid grid(argv[1]);
  uint32_t material = 0;
  tc::Box box;
  while (std::cin >> material >> box.lo[0] >> box.lo[1] >> box.lo[2] >> box.hi[0] >> box.hi[1] >> box.hi[2]) {
    const std::vector<double> shares = grid.fractions(material, box, 7);
    std::cout.write(reinterpret_cast<const char*>(shares.data()), static_cast<std::streamsize>(shares.size() * sizeof(double)));
  }
} catch (const tc::Error& e) {
  std::cerr << e.what() << '\n';
  return 1;
}

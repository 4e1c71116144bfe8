// The same as boxes.c through the C++ header.
#include <iostream>

#include <teracell.hpp>

template <class T>
void put(const tc::Grid& grid, const tc::Box& box, const tc::Reading& how) {
  const std::vector<T> cells = grid.read<T>(box, how);
  std::cout.write(reinterpret_cast<const char*>(cells.data()), static_cast<std::streamsize>(cells.size() * sizeof(T)));
}

int main(int, char** argv) try {
  const tc::Grid grid(argv[1]);
  tc::Reading how;
  int bytes = 0;
  tc::Box box;
  while (std::cin >> how.level >> bytes >> how.outside >> box.lo[0] >> box.lo[1] >> box.lo[2] >> box.hi[0] >> box.hi[1] >> box.hi[2]) {
    if (bytes == 1) put<uint8_t>(grid, box, how);
    else if (bytes == 2) put<uint16_t>(grid, box, how);
    else put<uint32_t>(grid, box, how);
  }
} catch (const tc::Error& e) {
  std::cerr << e.what() << '\n';
  return 1;
}

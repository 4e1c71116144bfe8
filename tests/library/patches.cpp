// Writes the names of all patches, a line for each, through the C++ header.
#include <iostream>

#include <teracell.hpp>

int main(int, char** argv) try {
  const tc::Grid grid(argv[1]);
  for (const tc_patch& p : grid.patches()) std::cout << p.name << '\n';
} catch (const tc::Error& e) {
  std::cerr << e.what() << '\n';
  return 1;
}

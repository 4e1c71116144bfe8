// What a look through the cells of a grid looks for.
#pragma once

namespace teracell::inline store {

struct CheckOptions {
  int threads = 1;
  double thin_cells = 3;    // walls that are thinner are found; 0: none
  double narrow_cells = 0;  // gaps of the background that are narrower are found; 0: none
};

}  // namespace teracell::store

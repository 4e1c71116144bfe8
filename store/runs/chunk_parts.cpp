#include "store/runs/chunk_parts.hpp"

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::inline store {

void check_box(const Metadata& meta, int level, const Box& box) {
  meta.grid.check_level(level);
  const Index3 n = meta.grid.cells(level);
  for (int d = 0; d < 3; ++d)
    if (box.lo[d] < 0 || box.hi[d] > n[d])
      throw UsageError(fmt::format("the box along {} must lie in 0 to {} (half open) on level {}, found {} to {}", axis_name(d), n[d], level,
                                   box.lo[d], box.hi[d]));
}

}  // namespace teracell::store

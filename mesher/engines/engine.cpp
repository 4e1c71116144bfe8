#include "mesher/engines/engine.hpp"

#include <fmt/format.h>

#include "store/error.hpp"

namespace teracell {

void check_crossings(const Tile& tile, uint64_t crossings) {
  constexpr uint64_t kMost = uint64_t{1} << 28;  // 2 GiB
  if (crossings > kMost)
    throw InputError(fmt::format("{} x {} rays cross the surfaces {} times, more than {} times: they are too many sheets for one tile",
                                 tile.u.size(), tile.v.size(), crossings, kMost));
}

}  // namespace teracell

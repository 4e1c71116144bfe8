#include "mesher/engines/engine.hpp"

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::mesher {

void check_crossings(const Tile& tile, uint64_t crossings) {
  constexpr uint64_t kMost = uint64_t{1} << 28;  // 2 GiB
  if (crossings > kMost)
    throw InputError(fmt::format(
        "{} x {} rays cross the surfaces {} times, but a tile holds at most {} crossings: too many layers of surface lie above one another",
        tile.u.size(), tile.v.size(), crossings, kMost));
}

}  // namespace teracell::mesher

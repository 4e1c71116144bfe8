#include "store/text/color.hpp"

#include <array>

#include <fmt/format.h>

namespace teracell::inline store {

std::string palette_color(uint32_t id) {
  // M. Okabe, K. Ito: Color Universal Design, 2008; its black is left out.
  constexpr std::array<std::array<int, 3>, 7> kColors = {
      {{0x56, 0xb4, 0xe9}, {0xe6, 0x9f, 0x00}, {0x00, 0x9e, 0x73}, {0xd5, 0x5e, 0x00}, {0xcc, 0x79, 0xa7}, {0xf0, 0xe4, 0x42}, {0x00, 0x72, 0xb2}}};
  constexpr std::array<int, 3> kPercent = {100, 65, 40};
  const auto& c = kColors[(id - 1) % kColors.size()];
  const int shade = kPercent[(id - 1) / kColors.size() % kPercent.size()];
  return fmt::format("#{:02x}{:02x}{:02x}", c[0] * shade / 100, c[1] * shade / 100, c[2] * shade / 100);
}

}  // namespace teracell::store

#include "store/format/channel_kinds.hpp"

#include <algorithm>

namespace teracell::inline store {

std::span<const ChannelKind> channel_kinds() {
#define LISTED(name) name,
  static const ChannelKind kinds[] = {TERACELL_CHANNEL_KINDS(LISTED)};
#undef LISTED
  return kinds;
}

const ChannelKind* find_kind(std::span<const ChannelKind> kinds, std::string_view name, std::string_view coding) {
  const auto it = std::ranges::find_if(kinds, [&](const ChannelKind& k) { return k.name == name && k.coding == coding; });
  return it == kinds.end() ? nullptr : &*it;
}

}  // namespace teracell::store

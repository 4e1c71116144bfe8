// The protocols of other programs, in the order of the start page. A new one is a file that defines a function NAME(), which returns
// its Protocol, and a line here.
#pragma once
#include <vector>

#include "server/protocols/protocol.hpp"

// clang-format off
#define TERACELL_PROTOCOLS(protocol) \
  protocol(zarr3) \
  protocol(zarr2) \
  protocol(xarray) \
  protocol(precomputed) \
  protocol(deep_zoom) \
  protocol(iiif)
// clang-format on

namespace teracell::server {

#define DECLARED(name) Protocol name();
#define LISTED(name) name(),

TERACELL_PROTOCOLS(DECLARED)

inline const std::vector<Protocol>& protocols() {
  static const std::vector<Protocol> all = {TERACELL_PROTOCOLS(LISTED)};
  return all;
}

#undef DECLARED
#undef LISTED

}  // namespace teracell::server

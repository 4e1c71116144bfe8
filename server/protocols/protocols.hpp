// The protocols of other programs. A new one is a file that defines a Protocol, and its name in the two lists below.
#pragma once
#include <vector>

#include "server/protocols/protocol.hpp"

namespace teracell {

Protocol zarr3(), zarr2(), xarray(), precomputed(), deep_zoom(), iiif();

// In the order of the start page.
inline const std::vector<Protocol>& protocols() {
  static const std::vector<Protocol> all = {zarr3(), zarr2(), xarray(), precomputed(), deep_zoom(), iiif()};
  return all;
}

}  // namespace teracell

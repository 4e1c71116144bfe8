// The documents of a hierarchy: what its groups and arrays are, of Zarr 3 with OME-Zarr 0.5 or of Zarr 2 with OME-Zarr 0.4.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "tools/export/zarr/layout.hpp"

namespace teracell::exports::zarr {

inline constexpr int kZstdLevel = 1;

struct Hierarchy {
  const Export& e;
  std::vector<Layout> arrays;
  size_t bytes_per_cell;
  // What cells have in chunks that are not there: the number of the background.
  uint32_t fill;
};

// By name, that of the root first.
using Documents = std::vector<std::pair<std::string, nlohmann::ordered_json>>;
Documents documents3(const Hierarchy& h);
Documents documents2(const Hierarchy& h);

}  // namespace teracell::exports::zarr

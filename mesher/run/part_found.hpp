// What the run of a part found, on its way to the one who merges. Part 0 has what the report says of the surfaces, too.
#pragma once
#include <optional>

#include "mesher/bodies/bodies.hpp"
#include "mesher/run/cast_totals.hpp"
#include "mesher/run/plan.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell::mesher {

struct SurfacesFound {
  Scene scene;
  Bodies bodies;  // without facets
  std::vector<SurfaceCounts> counts;  // one per body
  AxisChoice rays;
  bool thin = false;  // what is lost was counted for all solids
  bool all_patches = true;  // Plan::all_patches
  std::optional<PlanesReport> planes;  // Plan::planes
};

struct PartFound {
  CastTotals totals;
  std::optional<SurfacesFound> surfaces;
};

// `surfaces`: for part 0; null for the others.
Bytes encode_found(const CastTotals& totals, const SurfacesFound* surfaces);
PartFound decode_found(std::span<const uint8_t> bytes, const std::string& name);
// Throws FormatError unless a report can be made of these. `name`: whose totals these are.
void expect_fit(const CastTotals& totals, const SurfacesFound& surfaces, const Metadata& meta, const std::string& name);

}  // namespace teracell::mesher

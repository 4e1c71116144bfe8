// Where cells lie, for clients that know only equal steps.
//
// The cells of a level are `step` wide, and the centre of the first is at `first`. For level L this is
// first(L) = centre(0) + (2^L - 1) / 2 steps of level 0: the middle of the sample points that a whole coarse cell covers.
//
// Equal steps can't describe a graded axis, and a picture with one axis counted in cells would be distorted. So when an axis is
// graded, all three axes count cells ("index space"): step(L) = 2^L, and cell 0 of level 0 is at 0. The same holds for a file
// whose unit is not known.
#pragma once
#include <optional>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "store/grid/metadata.hpp"

namespace teracell::inline store {

// Per unit of lengths, by its name in the file; none when it is not known.
std::optional<double> nanometres_of(std::string_view unit);

struct Space {
  explicit Space(const Metadata& meta);
  double step(int axis, int level) const;
  double first(int axis, int level) const;

  bool index;         // index space: there is no unit
  const char* unit;   // its name in UDUNITS-2: "millimeter"
  double nanometres;  // per unit; 1 in index space

 private:
  const Grid& grid_;
};

// For people who read the documents: {"units", "space"}.
nlohmann::ordered_json space_json(const Metadata& meta);
// Where a cell of a level lies along an axis, graded or not: at its sample point; above level 0 halfway between its planes.
double coordinate(const Axis& axis, int level, int64_t i);

}  // namespace teracell::store

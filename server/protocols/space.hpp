// Where cells lie, for clients that know nothing but equal steps.
//
// A level's cells are `step` wide and the first has its centre at `first`. Cells of level L lie over those of level 0 that
// they cover: first(L) = centre(0) + (2^L - 1) / 2 steps of level 0, the middle of the sample points of a whole coarse cell.
//
// Equal steps can't say where cells of a graded axis lie. Stretching one axis only would bend the picture, so then all three
// axes count cells ("index space"): step(L) = 2^L, cell 0 of level 0 at 0. The same where the file's unit is not known.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "store/metadata.hpp"

namespace teracell {

struct Space {
  explicit Space(const Metadata& meta);
  double step(int axis, int level) const;
  double first(int axis, int level) const;

  bool index;          // cells are counted: no unit
  const char* unit;    // as UDUNITS-2 has it, "millimeter"
  double nanometres;   // of a unit; 1 in index space

 private:
  const Grid& grid_;
};

// What documents say of it, for people: {"units", "space"}.
nlohmann::ordered_json space_json(const Metadata& meta);
// An entry of OME-Zarr's "multiscales" whose levels are the arrays "0", "1" ...
nlohmann::ordered_json multiscale_json(const Metadata& meta, const std::string& name);

// Where a cell of a level lies, graded or not: its sample point; above level 0 the middle between its planes.
double coordinate(const Axis& axis, int level, int64_t i);

}  // namespace teracell

#include "store/grid/space.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace teracell::inline store {
namespace {

using nlohmann::ordered_json;

struct Unit {
  std::string_view ours;
  const char* name;
  double nanometres;
};
constexpr Unit kUnits[] = {{"m", "meter", 1e9},    {"cm", "centimeter", 1e7}, {"mm", "millimeter", 1e6}, {"um", "micrometer", 1e3},
                           {"nm", "nanometer", 1}, {"in", "inch", 2.54e7},    {"ft", "foot", 3.048e8}};

const Unit* known_unit(std::string_view name) {
  const auto known = std::ranges::find(kUnits, name, &Unit::ours);
  return known == std::end(kUnits) ? nullptr : known;
}

}  // namespace

std::optional<double> nanometres_of(std::string_view unit) {
  const Unit* const known = known_unit(unit);
  return known ? std::optional(known->nanometres) : std::nullopt;
}

Space::Space(const Metadata& meta) : index(true), unit(""), nanometres(1), grid_(meta.grid) {
  const Unit* const known = known_unit(meta.units);
  if (!known || std::ranges::any_of(meta.grid.axis, &Axis::is_graded)) return;
  index = false;
  unit = known->name;
  nanometres = known->nanometres;
}

double Space::step(int axis, int level) const { return std::ldexp(index ? 1.0 : grid_.axis[axis].step(), level); }

double Space::first(int axis, int level) const {
  const double behind = (std::ldexp(1.0, level) - 1) / 2;  // in steps of level 0
  return index ? behind : grid_.axis[axis].centre(0) + behind * grid_.axis[axis].step();
}

ordered_json space_json(const Metadata& meta) { return {{"units", meta.units}, {"space", Space(meta).index ? "index" : "physical"}}; }

double coordinate(const Axis& axis, int level, int64_t i) {
  if (level == 0) return axis.centre(i);
  const int64_t lo = i << level, hi = std::min(axis.cells(), (i + 1) << level);
  return (axis.plane(lo) + axis.plane(hi)) / 2;
}

}  // namespace teracell::store

#include "store/grid/space.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace teracell::inline store {
namespace {

using nlohmann::ordered_json;

struct Unit {
  const char *ours, *name;
  double nanometres;
};
constexpr Unit kUnits[] = {{"m", "meter", 1e9},    {"cm", "centimeter", 1e7}, {"mm", "millimeter", 1e6}, {"um", "micrometer", 1e3},
                           {"nm", "nanometer", 1}, {"in", "inch", 2.54e7},    {"ft", "foot", 3.048e8}};

}  // namespace

Space::Space(const Metadata& meta) : index(true), unit(""), nanometres(1), grid_(meta.grid) {
  const auto known = std::ranges::find(kUnits, meta.units, [](const Unit& u) { return std::string(u.ours); });
  if (known == std::end(kUnits) || std::ranges::any_of(meta.grid.axis, &Axis::is_graded)) return;
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

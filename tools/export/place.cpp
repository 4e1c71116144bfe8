#include "tools/export/place.hpp"

#include <cmath>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::exports {

std::vector<double> planes_of(const Export& e, int axis) {
  std::vector<double> planes;
  for (int64_t i = 0; i <= size_of(e.box)[axis]; ++i) planes.push_back(plane_of(e, axis, i));
  return planes;
}

double plane_of(const Export& e, int axis, int64_t i) {
  const Axis& a = e.reader.meta().grid.axis[static_cast<size_t>(axis)];
  return a.plane(std::min(a.cells(), (e.box.lo[axis] + i) << e.level));
}

EqualCells equal_cells(const Export& e, const char* format) {
  EqualCells out{size_of(e.box), {}, {}};
  for (int d = 0; d < 3; ++d) {
    const Axis& a = e.reader.meta().grid.axis[d];
    if (a.is_graded()) throw UsageError(fmt::format("--format: {} has uniform axes, found a graded axis {}: take vtr", format, axis_name(d)));
    out.origin[d] = plane_of(e, d, 0);
    out.step[d] = std::ldexp(a.step(), e.level);
  }
  return out;
}

std::string one_line(const std::string& name) {
  std::string out;
  for (const char c : name) out += c == '\n' ? std::string("\\n") : c == '\\' ? std::string("\\\\") : std::string(1, c);
  return out;
}

std::string material_lines(const Export& e, const char* line) {
  std::string out;
  const std::vector<MaterialInfo>& materials = e.reader.meta().materials;
  for (size_t id = 0; e.map.empty() && id < materials.size(); ++id) out += fmt::format(fmt::runtime(line), id, one_line(materials[id].name));
  return out;
}

}  // namespace teracell::exports

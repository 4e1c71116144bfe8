// NRRD, the format of teem's programs, which SimpleITK, 3D Slicer and others read: a header as text, and the dense array.
#include <cmath>

#include <fmt/format.h>

#include "store/error.hpp"
#include "tools/export/dense.hpp"

namespace teracell {
namespace {

void write_nrrd(const Export& e) {
  const size_t bytes = bytes_per_cell(e.most());
  std::array<double, 3> step{}, centre{};  // of the first cell
  std::array<int64_t, 3> n{};
  for (size_t d = 0; d < 3; ++d) {
    const Axis& a = e.reader.meta().grid.axis[d];
    if (a.is_graded())
      throw UsageError(fmt::format("--format: nrrd has uniform axes, found a graded axis {}: take vtr", axis_name(static_cast<int>(d))));
    n[d] = e.box.hi[d] - e.box.lo[d];
    step[d] = std::ldexp(a.step(), e.level);
    centre[d] = a.plane(std::min(a.cells(), e.box.lo[d] << e.level)) + step[d] / 2;
  }
  std::string header = fmt::format(
      "NRRD0005\ntype: uint{}\ndimension: 3\nsizes: {} {} {}\nendian: little\nencoding: raw\ncenters: cell cell cell\nspace dimension: 3\n"
      "space directions: ({:.17g},0,0) (0,{:.17g},0) (0,0,{:.17g})\nspace origin: ({:.17g},{:.17g},{:.17g})\nspace units: \"{}\" \"{}\" \"{}\"\n",
      8 * bytes, n[0], n[1], n[2], step[0], step[1], step[2], centre[0], centre[1], centre[2], e.reader.meta().units, e.reader.meta().units,
      e.reader.meta().units);
  if (e.map.empty())
    for (size_t id = 0; id < e.reader.meta().materials.size(); ++id) {
      std::string name;  // a value is one line
      for (const char c : e.reader.meta().materials[id].name)
        name += c == '\n' ? std::string("\\n") : c == '\\' ? std::string("\\\\") : std::string(1, c);
      header += fmt::format("material {}:={}\n", id, name);
    }
  header += '\n';
  OutputFile file(e.output);
  file.append({reinterpret_cast<const uint8_t*>(header.data()), header.size()});
  append_dense_cells(e, file);
  file.commit();
}

}  // namespace

ExportFormat nrrd_format() { return {"nrrd", {".nrrd"}, "a header and the array, for teem, SimpleITK and 3D Slicer", write_nrrd}; }

}  // namespace teracell

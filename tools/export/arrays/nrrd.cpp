// NRRD, the format of teem's programs, which SimpleITK, 3D Slicer and others read: a header as text, and the dense array.
#include <fmt/format.h>

#include "tools/export/arrays/dense.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports {
namespace {

void write_nrrd(const Export& e) {
  const size_t bytes = bytes_per_cell(e.most());
  const EqualCells cells = equal_cells(e, "nrrd");
  const auto& [n, origin, step] = cells;
  const Vec3 centre = cells.centre();
  std::string header = fmt::format(
      "NRRD0005\ntype: uint{}\ndimension: 3\nsizes: {} {} {}\nendian: little\nencoding: raw\ncenters: cell cell cell\nspace dimension: 3\n"
      "space directions: ({:.17g},0,0) (0,{:.17g},0) (0,0,{:.17g})\nspace origin: ({:.17g},{:.17g},{:.17g})\nspace units: \"{}\" \"{}\" \"{}\"\n",
      8 * bytes, n[0], n[1], n[2], step[0], step[1], step[2], centre[0], centre[1], centre[2], e.reader.meta().units, e.reader.meta().units,
      e.reader.meta().units);
  header += material_lines(e, "material {}:={}\n") + "\n";
  OutputFile file(e.output);
  file.append({reinterpret_cast<const uint8_t*>(header.data()), header.size()});
  append_dense_cells(e, file);
  file.commit();
}

}  // namespace

ExportFormat nrrd_format() { return {"nrrd", {".nrrd"}, "a header and the array, for teem, SimpleITK and 3D Slicer", write_nrrd}; }

}  // namespace teracell::exports

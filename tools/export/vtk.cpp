// VTK's XML files with raw appended data, which VTK, ParaView and VisIt read: .vti for uniform axes, .vtr for graded ones. Their order of
// cells is that of the dense array.
#include "store/vtk_header.hpp"
#include "tools/export/dense.hpp"
#include "tools/export/place.hpp"

namespace teracell {
namespace {

void append(OutputFile& file, const std::string& text) { file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()}); }

void write(const Export& e, VtkGrid grid) {
  if (e.map.empty()) grid.materials = e.reader.meta().materials;
  OutputFile file(e.output);
  append(file, vtk_header(grid, bytes_per_cell(e.most())));
  append_dense_cells(e, file);
  append(file, kVtkFooter);
  file.commit();
}

void write_vti(const Export& e) {
  const EqualCells cells = equal_cells(e, "vti");
  write(e, {cells.count, cells.origin, cells.step, {}, {}});
}

void write_vtr(const Export& e) {
  expect_few_planes(size_of(e.box));
  write(e, {size_of(e.box), {}, {}, {planes_of(e, 0), planes_of(e, 1), planes_of(e, 2)}, {}});
}

}  // namespace

ExportFormat vti_format() { return {"vti", {".vti"}, "cells of a uniform grid for VTK, ParaView and VisIt", write_vti}; }
ExportFormat vtr_format() { return {"vtr", {".vtr"}, "cells with their planes for VTK, ParaView and VisIt, also of a graded grid", write_vtr}; }

}  // namespace teracell

// VTK's XML files with raw appended data, which VTK, ParaView and VisIt read: .vti for uniform axes, .vtr for graded ones. Their order of
// cells is that of the dense array.
#include "store/grid/vtk_header.hpp"
#include "tools/export/arrays/dense.hpp"
#include "tools/export/place.hpp"
#include "tools/export/shares.hpp"

namespace teracell::exports {
namespace {

void append(OutputFile& file, const std::string& text) { file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()}); }

void append_shares(OutputFile& file, const Export& e, const FractionReader& shares, uint32_t material) {
  std::vector<float> slab;
  for_each_slab(e, kXFastest, sizeof(float), [&](const Box& part, const Index3& stride, size_t cells) {
    slab.resize(cells);
    shares.read_box(part, material, 0.0F, slab.data(), stride);
    file.append({reinterpret_cast<const uint8_t*>(slab.data()), cells * sizeof(float)});
  });
}

void write(const Export& e, VtkGrid grid) {
  const std::optional<FractionReader> shares = shares_of(e);
  const std::vector<MaterialInfo>& materials = e.reader.meta().materials;
  if (e.map.empty()) grid.materials = materials;
  if (shares)
    for (const MaterialInfo& m : materials) grid.shares.push_back("fraction of " + m.name);
  const size_t arrays = 1 + grid.shares.size();
  const Index3 n = size_of(e.box);
  OutputFile file(e.output);
  append(file, vtk_header(grid, bytes_per_cell(e.most())));
  append_dense_cells(step_of(e, 0, arrays), file);
  for (size_t i = 1; i < arrays; ++i) {
    append(file, vtk_count(sizeof(float) * static_cast<uint64_t>(n[0]) * static_cast<uint64_t>(n[1]) * static_cast<uint64_t>(n[2])));
    append_shares(file, step_of(e, i, arrays), *shares, static_cast<uint32_t>(i - 1));
  }
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

ExportFormat vti_format() {
  return {.name = "vti",
          .extensions = {".vti"},
          .holds = "cells of a uniform grid for VTK, ParaView and VisIt",
          .write = write_vti,
          .options = {shares_option()}};
}
ExportFormat vtr_format() {
  return {.name = "vtr",
          .extensions = {".vtr"},
          .holds = "cells with their planes for VTK, ParaView and VisIt, also of a graded grid",
          .write = write_vtr,
          .options = {shares_option()}};
}

}  // namespace teracell::exports

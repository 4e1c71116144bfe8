// VTK's XML files with raw appended data, which VTK, ParaView and VisIt read: .vti for uniform axes, .vtr for graded ones. Their order of
// cells is that of the dense array.
#include <fmt/format.h>

#include "tools/export/dense.hpp"
#include "tools/export/place.hpp"

namespace teracell {
namespace {

void append(OutputFile& file, const std::string& text) { file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()}); }

void append_count(OutputFile& file, uint64_t count) {
  Bytes bytes;
  put_fixed(bytes, count);
  file.append(bytes);
}

// Names by id. VTK's text arrays are the codes of their characters, each text ended by 0.
std::string names(const Export& e) {
  const std::vector<MaterialInfo>& materials = e.reader.meta().materials;
  std::string out = fmt::format("<FieldData><Array type=\"String\" Name=\"materials\" NumberOfTuples=\"{}\" format=\"ascii\">", materials.size());
  for (const MaterialInfo& m : materials) {
    for (const char c : m.name) out += fmt::format("{} ", static_cast<int>(c));
    out += "0 ";
  }
  return out + "</Array></FieldData>\n";
}

struct Layout {
  const char* kind;        // of the dataset
  std::string attributes;  // of its element
  std::array<std::vector<double>, 3> coordinates;  // empty: none
};

void write(const Export& e, const Layout& layout) {
  const size_t bytes = bytes_per_cell(e.most());
  const Index3 n = size_of(e.box);
  const uint64_t size = static_cast<uint64_t>(n[0]) * static_cast<uint64_t>(n[1]) * static_cast<uint64_t>(n[2]) * bytes;
  std::string header = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<{0} WholeExtent=\"0 {1} 0 {2} 0 {3}\"{4}>\n",
      layout.kind, n[0], n[1], n[2], layout.attributes);
  if (e.map.empty()) header += names(e);
  header += fmt::format("<Piece Extent=\"0 {} 0 {} 0 {}\">\n", n[0], n[1], n[2]);
  uint64_t offset = 0;
  if (!layout.coordinates[0].empty()) {
    header += "<Coordinates>";
    for (int d = 0; d < 3; ++d) {
      header += fmt::format("<DataArray type=\"Float64\" Name=\"{}\" format=\"appended\" offset=\"{}\"/>", axis_name(d), offset);
      offset += 8 + 8 * layout.coordinates[static_cast<size_t>(d)].size();
    }
    header += "</Coordinates>\n";
  }
  header += fmt::format(
      "<CellData Scalars=\"material\"><DataArray type=\"UInt{}\" Name=\"material\" format=\"appended\" offset=\"{}\"/></CellData>\n</Piece>\n</{}>\n"
      "<AppendedData encoding=\"raw\">\n_",
      8 * bytes, offset, layout.kind);
  OutputFile file(e.output);
  append(file, header);
  for (const std::vector<double>& planes : layout.coordinates) {
    if (planes.empty()) continue;
    append_count(file, 8 * planes.size());
    file.append({reinterpret_cast<const uint8_t*>(planes.data()), 8 * planes.size()});
  }
  append_count(file, size);
  append_dense_cells(e, file);
  append(file, "\n</AppendedData>\n</VTKFile>\n");
  file.commit();
}

void write_vti(const Export& e) {
  const EqualCells cells = equal_cells(e, "vti");
  const auto& [n, origin, step] = cells;
  write(e, {"ImageData",
            fmt::format(" Origin=\"{:.17g} {:.17g} {:.17g}\" Spacing=\"{:.17g} {:.17g} {:.17g}\"", origin[0], origin[1], origin[2], step[0], step[1],
                        step[2]),
            {}});
}

void write_vtr(const Export& e) { write(e, {"RectilinearGrid", "", {planes_of(e, 0), planes_of(e, 1), planes_of(e, 2)}}); }

}  // namespace

ExportFormat vti_format() { return {"vti", {".vti"}, "cells of a uniform grid for VTK, ParaView and VisIt", write_vti}; }
ExportFormat vtr_format() { return {"vtr", {".vtr"}, "cells with their planes for VTK, ParaView and VisIt, also of a graded grid", write_vtr}; }

}  // namespace teracell

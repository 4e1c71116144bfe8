#include "store/grid/vtk_header.hpp"

#include <fmt/format.h>

#include "store/base/bytes.hpp"
#include "store/text/xml.hpp"

namespace teracell::inline store {
namespace {

void put_bytes(std::string& out, const void* data, size_t size) { out.append(static_cast<const char*>(data), size); }

}  // namespace

// VTK's text arrays are the codes of their characters, each text ended by 0.
std::string vtk_names(std::span<const MaterialInfo> materials) {
  std::string out = fmt::format("<FieldData><Array type=\"String\" Name=\"materials\" NumberOfTuples=\"{}\" format=\"ascii\">", materials.size());
  for (const MaterialInfo& m : materials) {
    for (const char c : m.name) out += fmt::format("{} ", static_cast<int>(c));
    out += "0 ";
  }
  return out + "</Array></FieldData>\n";
}

std::string vtk_count(uint64_t bytes) {
  Bytes out;
  put_fixed(out, bytes);
  return {out.begin(), out.end()};
}

void expect_few_planes(const Index3& cells) {
  for (int d = 0; d < 3; ++d)
    if (cells[d] >= kMostVtkPlanes)
      throw UsageError(fmt::format("a .vtr file lists the planes of each axis, at most {}: expected fewer cells along {}, found {}", kMostVtkPlanes,
                                   axis_name(d), cells[d]));
}

std::string vtk_header(const VtkGrid& grid, size_t bytes) {
  const Index3& n = grid.cells;
  const bool graded = !grid.planes[0].empty();
  const char* kind = graded ? "RectilinearGrid" : "ImageData";
  std::string header = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<{0} WholeExtent=\"0 {1} 0 {2} 0 {3}\"",
      kind, n[0], n[1], n[2]);
  if (!graded)
    header += fmt::format(" Origin=\"{:.17g} {:.17g} {:.17g}\" Spacing=\"{:.17g} {:.17g} {:.17g}\"", grid.origin[0], grid.origin[1], grid.origin[2],
                          grid.step[0], grid.step[1], grid.step[2]);
  header += ">\n";
  if (!grid.materials.empty()) header += vtk_names(grid.materials);
  header += fmt::format("<Piece Extent=\"0 {} 0 {} 0 {}\">\n", n[0], n[1], n[2]);
  uint64_t offset = 0;
  if (graded) {
    header += "<Coordinates>";
    for (int d = 0; d < 3; ++d) {
      header += fmt::format("<DataArray type=\"Float64\" Name=\"{}\" format=\"appended\" offset=\"{}\"/>", axis_name(d), offset);
      offset += 8 + 8 * grid.planes[static_cast<size_t>(d)].size();
    }
    header += "</Coordinates>\n";
  }
  const uint64_t all = static_cast<uint64_t>(n[0]) * static_cast<uint64_t>(n[1]) * static_cast<uint64_t>(n[2]);
  header += fmt::format("<CellData Scalars=\"material\"><DataArray type=\"UInt{}\" Name=\"material\" format=\"appended\" offset=\"{}\"/>", 8 * bytes,
                        offset);
  offset += 8 + bytes * all;
  for (const std::string& name : grid.shares) {
    header += fmt::format("\n<DataArray type=\"Float32\" Name=\"{}\" format=\"appended\" offset=\"{}\"/>", xml_text(name), offset);
    offset += 8 + sizeof(float) * all;
  }
  header += fmt::format("</CellData>\n</Piece>\n</{}>\n<AppendedData encoding=\"raw\">\n_", kind);
  for (const std::vector<double>& planes : grid.planes) {
    if (planes.empty()) continue;
    header += vtk_count(8 * planes.size());
    put_bytes(header, planes.data(), 8 * planes.size());
  }
  return header + vtk_count(all * bytes);
}

}  // namespace teracell::store

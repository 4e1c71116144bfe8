// MetaImage, which ITK's programs, VTK and ParaView read: a header as text, and the dense array in a file beside it (.mhd) or behind the
// header (.mha).
#include <fmt/format.h>

#include "store/base/error.hpp"
#include "tools/export/arrays/dense.hpp"
#include "tools/export/arrays/two_files.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports {
namespace {

// Its last line says where the array is.
std::string meta_image_header(const Export& e, const std::string& array) {
  const EqualCells cells = equal_cells(e, "mhd");
  const auto& [n, origin, step] = cells;
  const Vec3 centre = cells.centre();
  const size_t bytes = bytes_per_cell(e.most());
  const std::string text = fmt::format(
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
      "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = {:.17g} {:.17g} {:.17g}\nCenterOfRotation = 0 0 0\nElementSpacing = {:.17g} {:.17g} {:.17g}\n"
      "DimSize = {} {} {}\n",
      centre[0], centre[1], centre[2], step[0], step[1], step[2], n[0], n[1], n[2]);
  return text + material_lines(e, "Material{} = {}\n") +
         fmt::format("ElementType = MET_U{}\nElementDataFile = {}\n",
                     bytes == 1   ? "CHAR"
                     : bytes == 2 ? "SHORT"
                                  : "INT",
                     array);
}

void write_mhd(const Export& e) {
  if (e.output.extension() == ".mha") {
    const std::string text = meta_image_header(e, "LOCAL");
    OutputFile file(e.output);
    file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
    append_dense_cells(e, file);
    return file.commit();
  }
  std::filesystem::path array = e.output;
  array.replace_extension(".raw");
  if (array == e.output) throw UsageError(fmt::format("{}: the array gets this name: give the header another one, such as .mhd", array.string()));
  const std::string text = meta_image_header(e, array.filename().string());
  TwoFiles files(e, array, e.output);
  append_dense_cells(e, files.array());
  files.commit(text);
}

}  // namespace

ExportFormat mhd_format() {
  return {
      "mhd", {".mhd", ".mha"}, "MetaImage for ITK, VTK and ParaView: a header and the array, in two files (.mhd and .raw) or one (.mha)", write_mhd};
}

}  // namespace teracell::exports

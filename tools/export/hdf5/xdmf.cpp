// XDMF: an XML file that says what the arrays of an HDF5 file beside it mean, for ParaView and VisIt. All axes are written as planes, so
// graded ones are right, and so are the last cells of a coarse level.
#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/xml.hpp"
#include "tools/export/arrays/dense.hpp"
#include "tools/export/hdf5/profiles.hpp"
#include "tools/export/place.hpp"
#include "tools/export/shares.hpp"

namespace teracell::exports {
namespace {

// The name is absolute: ParaView's reader of XDMF 3 aborts at a relative one when the XML itself is opened without its folder.
std::string description(const Export& e, const std::filesystem::path& cells) {
  const std::string h5 = xml_text(std::filesystem::absolute(cells).lexically_normal().string());
  const Index3 n = size_of(e.box);
  std::string planes;
  for (int d = 0; d < 3; ++d)
    planes += fmt::format("        <DataItem Dimensions=\"{}\" NumberType=\"Float\" Precision=\"8\" Format=\"HDF\">{}:/planes_{}</DataItem>\n",
                          n[d] + 1, h5, axis_name(d));
  std::string shares;
  const std::vector<MaterialInfo>& materials = e.reader.meta().materials;
  for (size_t id = 0; e.has("--fractions") && id < materials.size(); ++id)
    shares += fmt::format(
        "      <Attribute Name=\"fraction of {}\" AttributeType=\"Scalar\" Center=\"Cell\">\n"
        "        <DataItem Dimensions=\"{} {} {}\" NumberType=\"Float\" Precision=\"4\" Format=\"HDF\">{}:/fractions/{}</DataItem>\n"
        "      </Attribute>\n",
        xml_text(materials[id].name), n[2], n[1], n[0], h5, id);
  const size_t bytes = bytes_per_cell(e.most());
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n    <Grid Name=\"cells\" GridType=\"Uniform\">\n"
      "      <Topology TopologyType=\"3DRectMesh\" Dimensions=\"{3} {2} {1}\"/>\n"
      "      <Geometry GeometryType=\"VXVYVZ\">\n{0}      </Geometry>\n"
      "      <Attribute Name=\"material\" AttributeType=\"Scalar\" Center=\"Cell\">\n"
      "        <DataItem Dimensions=\"{6} {5} {4}\" NumberType=\"{7}\" Precision=\"{8}\" Format=\"HDF\">{9}:/material</DataItem>\n"
      "      </Attribute>\n{10}    </Grid>\n  </Domain>\n</Xdmf>\n",
      planes, n[0] + 1, n[1] + 1, n[2] + 1, n[0], n[1], n[2],
      bytes == 1   ? "UChar"
      : bytes == 2 ? "UShort"
                   : "UInt",
      bytes, h5, shares);
}

// Everything is on disk before the first name appears. A run that is killed between the two leaves the HDF5 file alone.
void write_xdmf(const Export& e) {
  const std::filesystem::path cells = beside(e, std::filesystem::path(e.output).replace_extension(".h5"));
  if (cells.string().find(':') != std::string::npos || std::filesystem::absolute(cells).string().find(':') != std::string::npos)
    throw UsageError(fmt::format("--output: XDMF has no names with a colon, found '{}'", std::filesystem::absolute(cells).string()));
  OutputFile xml(e.output);
  const std::string text = description(e, cells);
  xml.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  H5File file(cells);
  put_plain(file, e);
  xml.sync();
  file.finish();
  std::error_code ignored;
  std::filesystem::remove(e.output, ignored);  // an older one describes another file
  file.commit();
  xml.commit();
}

}  // namespace

ExportFormat xdmf_format() {
  return {.name = "xdmf",
          .extensions = {".xdmf", ".xmf"},
          .holds = "a description of an HDF5 file, which is written beside it, for ParaView and VisIt",
          .write = write_xdmf,
          .options = {shares_option()}};
}

}  // namespace teracell::exports

// Recognises files of other formats from their first bytes, so that the error can name the format and say what to do. These
// signatures begin no file that a reader takes. A file of which a reader is sure is not checked against them.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "mesher/surface/reader.hpp"

namespace teracell::mesher {
namespace {

using namespace std::string_view_literals;

constexpr const char* kExport = "export it as one of these";
constexpr const char* kExtract = "export the surface as one of these";
constexpr const char* kPoints = "points alone are not a surface: reconstruct a surface from them first";
constexpr const char* kUnpack = "unpack it first";
constexpr const char* kDecompress = "decompress it first (gzip is the only compression that can be read directly)";
constexpr const char* kNone = "";

struct Signature {
  size_t at;
  std::string_view bytes;
  const char *what, *advice;
};

constexpr Signature kSignatures[] = {
    // surfaces and solids
    {0, "DBRep_DrawableShape", "an Open CASCADE BREP file", kExport},
    {0, "CASCADE Topology V", "an Open CASCADE BREP file", kExport},
    {0, "Open CASCADE Topology V", "an Open CASCADE BREP file", kExport},
    {0, "Kaydara FBX Binary", "an FBX file", kExport},
    {0, "; FBX ", "an FBX file", kExport},
    {0, "#VRML V", "a VRML scene", kExport},
    {0, "#Inventor V", "an Open Inventor scene", kExport},
    {0, "#X3D V", "an X3D scene", kExport},
    {0, "3D Geometry File Format", "a Rhino model (3DM)", kExport},
    {0, "BLENDER-v", "a Blender file", kExport},
    {0, "BLENDER_v", "a Blender file", kExport},
    {0, "BLENDER1", "a Blender file", kExport},
    {0, "PXR-USDC", "a USD scene", kExport},
    {0, "#usda ", "a USD scene", kExport},
    {0, "DRACO\2", "a Draco mesh", kExport},
    {0, "AutoCAD Binary DXF", "a DXF drawing", kExport},
    {0, "**ABCDEFGHIJKLM", "a Parasolid file", kExport},
    {0, "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an OLE file, as SolidWorks, Inventor and older Office programs write", kExport},
    {0, "OFF BINARY", "an OFF file in binary", kExport},
    // meshes and fields
    {0, "# vtk DataFile", "a VTK file", kExtract},
    {0, "$MeshFormat", "a Gmsh mesh", kExtract},
    {0, "$NOD", "a Gmsh mesh", kExtract},
    {0, "MeshVersionFormatted", "a Medit mesh", kExtract},
    {0, "\x89HDF\r\n\x1a\n", "an HDF5 file", kExtract},
    {0, "CDF\x01", "a NetCDF file", kExtract},
    {0, "CDF\x02", "a NetCDF file", kExtract},
    {0, "CDF\x05", "a NetCDF file", kExtract},
    {0, "# .PCD", "a point cloud (PCD)", kPoints},
    {0, "LASF", "a point cloud (LAS)", kPoints},
    {0, "\x93NUMPY", "a NumPy array", kNone},
    {8, "teracell", "a grid that teracell made", "see what is in it with `teracell info`"},
    // archives and compressed files
    {0, "\x1f\x8b\x08", "a gzip file", "decompress it first"},
    {0, "\x28\xb5\x2f\xfd", "a file compressed by zstd", kDecompress},
    {4, "1AY&SY", "a file compressed by bzip2", kDecompress},
    {0, "\3757zXZ\0"sv, "a file compressed by xz", kDecompress},
    {0, "\x04\x22\x4d\x18", "a file compressed by lz4", kDecompress},
    {0, "7z\xbc\xaf\x27\x1c", "a 7z archive", kUnpack},
    {0, "Rar!\x1a\x07", "a RAR archive", kUnpack},
    {257, "ustar", "a tar archive", kUnpack},
    {0, "version https://git-lfs.github.com/", "a pointer that Git LFS left in place of the file", "fetch the file itself with `git lfs pull`"},
    // given by mistake
    {0, "\x89PNG\r\n", "a PNG picture", kNone},
    {0, "\xff\xd8\xff", "a JPEG picture", kNone},
    {0, "GIF87a", "a GIF picture", kNone},
    {0, "GIF89a", "a GIF picture", kNone},
    {0, "II*\0"sv, "a TIFF picture", kNone},
    {0, "MM\0*"sv, "a TIFF picture", kNone},
    {0, "%PDF-", "a PDF document", kNone},
    {0, "\177ELF", "a program (ELF)", kNone},
    {0, "\xff\xfe", "text in UTF-16", "save it as plain text (UTF-8)"},
    {0, "\xfe\xff", "text in UTF-16", "save it as plain text (UTF-8)"},
};

struct Root {
  std::string_view name;
  const char *what, *advice;
};
constexpr Root kRoots[] = {
    {"X3D", "an X3D scene", kExport},    {"COLLADA", "a Collada scene", kExport},
    {"amf", "an AMF file", kExport},     {"model", "the model of a 3MF file", kExport},
    {"VTKFile", "a VTK file", kExtract}, {"Xdmf", "an XDMF file", kExtract},
    {"svg", "an SVG picture", kNone},
};
constexpr const char *kWebPage = "a web page", *kDownload = "did a download return a page in place of the file?";

bool begins(std::string_view text, std::string_view word) {  // `word` in lower case
  return text.size() >= word.size() && is_keyword(text.substr(0, word.size()), word);
}

// The name of the outermost element; empty when there is none.
std::string_view xml_root(std::string_view text) {
  for (;;) {
    text = trimmed(text);
    if (!text.starts_with('<')) return {};
    const std::string_view end = text.starts_with("<!--") ? "-->" : ">";
    if (!text.starts_with("<!") && !text.starts_with("<?")) return text.substr(1, text.find_first_of(" \t\r\n/>", 1) - 1);
    const size_t stop = text.find(end);
    if (stop == std::string_view::npos) return {};
    text.remove_prefix(stop + end.size());
  }
}

std::optional<OtherKind> xml_kind(const Head& head, std::string_view start) {
  if (begins(start, "<!doctype html") || begins(start, "<html")) return OtherKind{kWebPage, kDownload};
  if (!start.starts_with("<?xml") && !(start.starts_with('<') && (head.text || start.starts_with("<VTKFile")))) return {};
  const std::string_view name = xml_root(start);
  if (is_keyword(name, "html")) return OtherKind{kWebPage, kDownload};
  for (const Root& root : kRoots)
    if (root.name == name) return OtherKind{root.what, root.advice};
  return OtherKind{name.empty() ? "an XML file" : fmt::format("an XML file with the root {}", shown(name)), kExport};
}

std::optional<OtherKind> json_kind(std::string_view text) {
  if (!text.starts_with('{') && !text.starts_with('[')) return {};
  const auto has = [&](std::string_view key) { return text.find(key) != std::string_view::npos; };
  if (has("\"bodies\"")) return OtherKind{"a scene", "give it to `teracell mesh` alone, under a name that ends in .json"};
  return OtherKind{"a JSON file", kNone};
}

// Text formats whose first words are too short to be a signature by themselves.
std::optional<OtherKind> text_kind(const Head& head, std::string_view start) {
  if (auto json = json_kind(start)) return json;
  std::string_view rest = start;
  const std::string_view first = next_word(rest), second = next_word(rest);
  if ((first == "0" && second == "SECTION") || (first == "999" && start.find("SECTION") != std::string_view::npos))
    return OtherKind{"a DXF drawing", kExport};
  // IGES: lines of 80 columns; the first line has S in column 73 and the number 1 at its end.
  const std::string_view line = head.bytes.substr(0, head.bytes.find_first_of("\r\n"));
  if (line.size() == 80 && line[72] == 'S' && (line.ends_with("      1") || line.ends_with("0000001"))) return OtherKind{"an IGES file", kExport};
  return {};
}

std::optional<OtherKind> zip_kind(std::string_view bytes) {
  if (!bytes.starts_with("PK\x03\x04") && !bytes.starts_with("PK\x05\x06")) return {};
  const auto has = [&](std::string_view name) { return bytes.find(name) != std::string_view::npos; };
  if (has("Document.xml") && has("GuiDocument.xml")) return OtherKind{"a FreeCAD document", kExport};
  return OtherKind{"a ZIP archive (FreeCAD and USDZ files are ZIP archives, too)", "unpack it, or export the surface as one of these"};
}

}  // namespace

std::optional<OtherKind> other_kind(const Head& head) {
  if (auto zip = zip_kind(head.bytes)) return zip;
  const std::string_view start = head.bytes.substr(std::min(head.bytes.find_first_not_of(" \t\r\n"), head.bytes.size()));
  for (const Signature& s : kSignatures)
    if ((s.at == 0 ? start : head.bytes.substr(std::min(s.at, head.bytes.size()))).starts_with(s.bytes)) return OtherKind{s.what, s.advice};
  if (start.starts_with("AC10") && start.size() > 6 && start[6] == '\0') return OtherKind{"an AutoCAD drawing (DWG)", kExport};
  if (auto xml = xml_kind(head, start)) return xml;
  return head.text ? text_kind(head, start) : std::optional<OtherKind>();
}

}  // namespace teracell::mesher

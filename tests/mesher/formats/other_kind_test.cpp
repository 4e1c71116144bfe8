// Files of other kinds are named as what they are.
#include "tests/support/surfaces.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

namespace {

std::string zip_of(const std::string& name) {  // the first local header of an archive
  return "PK\3\4" + std::string(22, '\0') + bytes_of(static_cast<uint16_t>(name.size())) + std::string(2, '\0') + name + std::string(300, '\7');
}
const std::string kZeros(300, '\0');  // what follows is no text

}  // namespace

TEST_CASE("A file of another kind is named as what it is, with what to do") {
  const auto [what, bytes] = GENERATE(table<std::string, std::string>({
      {"a ZIP archive", zip_of("hull.stl")},
      {"a FreeCAD document", zip_of("Document.xml") + zip_of("GuiDocument.xml")},
      {"an IGES file", "made by a test" + std::string(58, ' ') + "S      1\n"},
      {"a VTK file", "# vtk DataFile Version 3.0\nv 1 2 3\nBINARY\n" + kZeros},
      {"a VTK file", "<VTKFile type=\"PolyData\">\n" + kZeros},
      {"a VRML scene", "#VRML V2.0 utf8\ng\n"},
      {"an X3D scene", "<?xml version=\"1.0\"?>\n<!DOCTYPE X3D PUBLIC \"a\" \"b\">\n<X3D profile='x'>"},
      {"a Collada scene", "<?xml version=\"1.0\"?><!-- a <b> -->\n<COLLADA>"},
      {"an AMF file", "<amf unit=\"millimeter\">"},
      {"an XML file with the root 'mesh'", "<?xml version=\"1.0\"?><mesh/>"},
      {"an XML file", "<?xml version=\"1.0\"?><!-- "},
      {"an FBX file", "Kaydara FBX Binary  " + kZeros},
      {"an Open CASCADE BREP file", "\nCASCADE Topology V1, (c) Matra-Datavision\n"},
      {"a Gmsh mesh", "$MeshFormat\n4.1 1 8\n" + kZeros},
      {"an HDF5 file", "\x89HDF\r\n\x1a\n" + kZeros},
      {"a PNG picture", "\x89PNG\r\n\x1a\n" + kZeros},
      {"a JPEG picture", "\xff\xd8\xff\xe0" + kZeros},
      {"a PDF document", "%PDF-1.7\n"},
      {"a program (ELF)",
       "\x7f"
       "ELF\2" +
           kZeros},
      {"a grid that teracell made", "\x5e\x2a\x4d\x18" + std::string(4, '\0') + "teracell" + kZeros},
      {"a scene", "{\n \"bodies\": []}"},
      {"a JSON file", "[1, 2]"},
      {"a file compressed by zstd", "\x28\xb5\x2f\xfd" + kZeros},
      {"a file compressed by bzip2", "BZh91AY&SY" + kZeros},
      {"a file compressed by xz",
       "\xfd"
       "7zXZ" +
           kZeros},
      {"a tar archive", "hull.stl" + std::string(249, '\0') + "ustar" + kZeros},
      {"a DXF drawing", "  0\r\nSECTION\r\n  2\r\nHEADER\r\n"},
      {"an AutoCAD drawing (DWG)", "AC1032" + kZeros},
      {"a pointer that Git LFS left in place of the file", "version https://git-lfs.github.com/spec/v1\n"},
      {"a web page", "<!DOCTYPE html>\n<html></html>\n"},
      {"a web page", "\n<HTML>"},
      {"text in UTF-16", std::string("\xff\xfev\0 \0", 6)},
  }));
  CAPTURE(what);
  CHECK_THAT(refusal(bytes), Contains("mesh: this is " + what) && Contains(": expected STL, OBJ, PLY, OFF, 3MF, glTF or STEP"));
  CHECK_THAT(refusal(gzipped(bytes)),
             Contains("mesh: this is " + what) && Contains(", compressed by gzip: expected STL, OBJ, PLY, OFF, 3MF, glTF or STEP"));
}

TEST_CASE("A surface is read whatever its header or comments look like") {
  for (const std::string header : {"glTF\2", "%PDF-1.7", "ISO-10303-21;", "{\"asset\": \"version\"}", "<?xml version=\"1.0\"?>", "PK\3\4", "OFF"})
    CHECK(read(binary_stl(tetrahedron(), header)).facets == tetrahedron());
  for (const std::string header : {"OFF", "{}", "<made by a test>", "0 SECTION", "AC1000 bracket", "BLENDER"})  // the size doesn't tell here
    CHECK(read(binary_stl(tetrahedron(), header) + "xyz").facets == tetrahedron());
  for (const std::string remark : {"# OFF\n", "#VRML\n", "# glTF\n# <?xml\n", "# vtk\n"}) {
    CHECK(read(remark + kObj).facets == tetrahedron());
    CHECK(read(remark + ascii_stl(tetrahedron(), "OFF")).facets == tetrahedron());
  }
}

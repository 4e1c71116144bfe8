// Small assemblies as files: a package of stored files, a 3MF model, a GLB.
#pragma once
#include <zlib.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/surfaces.hpp"

namespace teracell::surfaces {

// A ZIP package of files that are not compressed.
inline std::string package_of(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string out, list;
  for (const auto& [name, text] : files) {
    const auto u16 = [](size_t v) { return bytes_of(static_cast<uint16_t>(v)); };
    const auto u32 = [](size_t v) { return bytes_of(static_cast<uint32_t>(v)); };
    const size_t checksum = crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
    const std::string facts =
        u16(20) + u16(0) + u16(0) + u16(0) + u16(33) + u32(checksum) + u32(text.size()) + u32(text.size()) + u16(name.size()) + u16(0);
    list += "PK\1\2" + u16(20) + facts + u16(0) + u16(0) + u16(0) + u32(0) + u32(out.size()) + name;
    out += "PK\3\4" + facts + name + text;
  }
  const std::string count = bytes_of(static_cast<uint16_t>(files.size()));
  return out + list + "PK\5\6" + std::string(4, '\0') + count + count + bytes_of(static_cast<uint32_t>(list.size())) +
         bytes_of(static_cast<uint32_t>(out.size())) + std::string(2, '\0');
}

inline const std::string kRelationships =
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship Target=\"/3D/3dmodel.model\" Id=\"r\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

inline std::string threemf_package(const std::string& model) { return package_of({{"_rels/.rels", kRelationships}, {"3D/3dmodel.model", model}}); }

// `inside` are the resources and the build.
inline std::string threemf(const std::string& inside, const std::string& attributes = "") {
  return threemf_package("<?xml version=\"1.0\"?>\n<model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" " + attributes + ">\n" +
                         inside + "</model>");
}

// An object that is the tetrahedron of the other formats.
inline std::string tetrahedron_object(int id, const std::string& attributes = "") {
  std::string out = "<object id=\"" + std::to_string(id) + "\" " + attributes + "><mesh><vertices>";
  for (const char* v : {"x=\"0\" y=\"0\" z=\"0\"", "x=\"1\" y=\"0\" z=\"0\"", "x=\"0\" y=\"1\" z=\"0\"", "x=\"0\" y=\"0\" z=\"0.5\""})
    out += "<vertex " + std::string(v) + "/>";
  out += "</vertices>\n<triangles>";
  for (const char* t : {"v1=\"0\" v2=\"2\" v3=\"1\"", "v1=\"0\" v2=\"1\" v3=\"3\"", "v1=\"0\" v2=\"3\" v3=\"2\"", "v1=\"1\" v2=\"2\" v3=\"3\""})
    out += "<triangle " + std::string(t) + "/>";
  return out + "</triangles></mesh></object>\n";
}

inline std::string glb(std::string json, std::string binary) {
  json.append((4 - json.size() % 4) % 4, ' ');
  binary.append((4 - binary.size() % 4) % 4, '\0');
  const auto u32 = [](size_t v) { return bytes_of(static_cast<uint32_t>(v)); };
  return "glTF" + u32(2) + u32(28 + json.size() + binary.size()) + u32(json.size()) + "JSON" + json + u32(binary.size()) + std::string("BIN\0", 4) +
         binary;
}

// The vertices of the tetrahedron as float32, then its triangles as 16-bit numbers.
inline std::string tetrahedron_buffer() {
  std::string out;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.5f}) out += bytes_of(x);
  for (const uint16_t v : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) out += bytes_of(v);
  return out;
}
inline const std::string kTetrahedronAccessors =
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],"asset":{"version":"2.0"},"buffers":[{"byteLength":72}])";
inline const std::string kTetrahedronMesh = R"("meshes":[{"name":"tet","primitives":[{"attributes":{"POSITION":0},"indices":1}]}])";
// `nodes` is the list of nodes, and what else is to stand there.
inline std::string gltf_json(const std::string& nodes) { return "{" + kTetrahedronAccessors + "," + kTetrahedronMesh + "," + nodes + "}"; }
inline std::string gltf(const std::string& nodes) { return glb(gltf_json(nodes), tetrahedron_buffer()); }

}  // namespace teracell::surfaces

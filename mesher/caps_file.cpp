#include "mesher/caps_file.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "store/bytes.hpp"
#include "store/error.hpp"

namespace teracell {
namespace {

void put_text(Bytes& out, std::string_view text) { out.insert(out.end(), text.begin(), text.end()); }

// The first 80 bytes are a comment. Normals are left zero: readers take them from the vertices.
void put_stl(Bytes& out, const std::vector<Facet>& facets) {
  put_text(out, fmt::format("{:<80}", "caps by teracell"));
  put_fixed(out, static_cast<uint32_t>(facets.size()));
  for (const Facet& f : facets) {
    for (int i = 0; i < 3; ++i) put_fixed(out, uint32_t{0});
    for (const Vec3& p : f.vertex)
      for (const double x : p) put_fixed(out, std::bit_cast<uint32_t>(static_cast<float>(x)));
    put_fixed(out, uint16_t{0});
  }
}

void put_ply(Bytes& out, const std::vector<Facet>& facets) {
  put_text(out, fmt::format("ply\nformat binary_little_endian 1.0\ncomment caps by teracell\nelement vertex {}\nproperty double x\nproperty double y\n"
                            "property double z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                            3 * facets.size(), facets.size()));
  for (const Facet& f : facets)
    for (const Vec3& p : f.vertex)
      for (const double x : p) put_fixed(out, std::bit_cast<uint64_t>(x));
  for (uint32_t i = 0; i < facets.size(); ++i) {
    put_fixed(out, uint8_t{3});
    for (uint32_t k = 0; k < 3; ++k) put_fixed(out, 3 * i + k);
  }
}

}  // namespace

std::vector<std::filesystem::path> caps_names(const Scene& scene, const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending != ".stl" && ending != ".ply") throw UsageError(fmt::format("--write-caps: expected a name that ends in .stl or .ply, found '{}'", path.string()));
  if (scene.bodies.size() == 1) return {path};
  std::vector<std::filesystem::path> names;
  for (const SceneBody& body : scene.bodies) {
    std::string stem = path.stem().string() + '-' + body.name;
    std::ranges::replace(stem, '/', '_');
    std::filesystem::path name = path.parent_path() / (stem + ending);
    for (int n = 2; std::ranges::find(names, name) != names.end(); ++n) name = path.parent_path() / fmt::format("{}-{}{}", stem, n, ending);
    names.push_back(name);
  }
  return names;
}

std::vector<std::unique_ptr<OutputFile>> write_caps(const Scene& scene, const Bodies& bodies, const std::filesystem::path& path) {
  const bool ply = path.extension() == ".ply";
  const std::vector<std::filesystem::path> names = caps_names(scene, path);
  std::vector<std::unique_ptr<OutputFile>> files;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyFacets& found = bodies.bodies[b];
    std::vector<Facet> facets;
    for (const Rule& rule : found.rules) facets.insert(facets.end(), rule.caps.facets.begin(), rule.caps.facets.end());
    if (facets.empty()) continue;
    if (!ply && !found.file.float32)
      throw UsageError(fmt::format("--write-caps: the vertices of body '{}' are doubles, which STL can't hold: expected a name that ends in .ply, found '{}'",
                                   scene.bodies[b].name, path.string()));
    files.push_back(std::make_unique<OutputFile>(names[b]));
    Bytes bytes;
    if (ply) put_ply(bytes, facets);
    else put_stl(bytes, facets);
    files.back()->append(bytes);
  }
  return files;
}

}  // namespace teracell

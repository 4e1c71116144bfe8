#include "mesher/bodies/caps_file.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "mesher/scene/placement.hpp"
#include "store/base/bytes.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

void put_text(Bytes& out, std::string_view text) { out.insert(out.end(), text.begin(), text.end()); }

// The first 80 bytes are a comment. Normals are left zero: readers take them from the vertices.
void put_stl(Bytes& out, const std::array<std::vector<Facet>, 2>& facets, uint64_t count) {
  put_text(out, fmt::format("{:<80}", "teracell caps"));
  put_fixed(out, static_cast<uint32_t>(count));
  for (const auto& list : facets)
    for (const Facet& f : list) {
      for (int i = 0; i < 3; ++i) put_fixed(out, uint32_t{0});
      for (const Vec3& p : f.vertex)
        for (const double x : p) put_fixed(out, std::bit_cast<uint32_t>(static_cast<float>(x)));
      put_fixed(out, uint16_t{0});
    }
}

// Every facet has vertices of its own. `pass` is called once, with `count` facets.
void write_ply(OutputFile& out, uint64_t count, const FacetPass& pass, const std::filesystem::path& path) {
  if (3 * count > std::numeric_limits<uint32_t>::max())
    throw InputError(fmt::format("{}: {} facets are too many for a PLY file", path.string(), count));
  constexpr size_t kBlock = size_t{1} << 20;
  Bytes block;
  const auto flush = [&](size_t at_least) {
    if (block.size() < at_least) return;
    out.append(block);
    block.clear();
  };
  put_text(block, fmt::format("ply\nformat binary_little_endian 1.0\ncomment teracell caps\nelement vertex {}\nproperty double x\nproperty double y\n"
                              "property double z\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                              3 * count, count));
  pass([&](const Facet& f) {
    for (const Vec3& p : f.vertex)
      for (const double x : p) put_fixed(block, std::bit_cast<uint64_t>(x));
    flush(kBlock);
  });
  for (uint32_t i = 0; i < count; ++i) {
    put_fixed(block, uint8_t{3});
    for (uint32_t k = 0; k < 3; ++k) put_fixed(block, 3 * i + k);
    flush(kBlock);
  }
  flush(1);
}

}  // namespace

std::vector<std::filesystem::path> caps_names(const Scene& scene, const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending != ".stl" && ending != ".ply")
    throw OptionError(fmt::format("write_caps: expected a name that ends in .stl or .ply, found '{}'", path.string()));
  if (scene.bodies.size() == 1) return {path};
  std::vector<std::filesystem::path> names;
  std::set<std::filesystem::path> taken;
  for (const SceneBody& body : scene.bodies) {
    std::string stem = path.stem().string() + '-' + body.name;
    std::ranges::replace(stem, '/', '_');
    std::filesystem::path name = path.parent_path() / (stem + ending);
    for (int n = 2; !taken.insert(name).second; ++n) name = path.parent_path() / fmt::format("{}-{}{}", stem, n, ending);
    names.push_back(name);
  }
  return names;
}

std::vector<std::unique_ptr<OutputFile>> write_caps(const Scene& scene, const Bodies& bodies, const std::filesystem::path& path,
                                                    const Budget& budget) {
  const bool ply = path.extension() == ".ply";
  const std::vector<std::filesystem::path> names = caps_names(scene, path);
  std::vector<std::unique_ptr<OutputFile>> files;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const BodyFacets& found = bodies.bodies[b];
    const ClosedBody& closed = found.closed;
    if (!closed.adds_facets()) continue;
    const bool whole = body.closing.way == Closing::Way::kExtrude;
    if (!ply && (whole || !found.file.float32))
      throw OptionError(fmt::format("write_caps: {} of body '{}' are doubles, which STL can't hold: expected a name that ends in .ply, found '{}'",
                                    whole ? "the walls of extruded loops" : "the vertices", body.name, path.string()));
    files.push_back(std::make_unique<OutputFile>(names[b]));
    const uint64_t count = closed.added[0].size() + closed.added[1].size();
    if (!ply) {
      Bytes bytes;
      put_stl(bytes, closed.added, count);
      files.back()->append(bytes);
    } else if (whole) {
      write_ply(
          *files.back(), found.file.facets + count + closed.walls[0].size() + closed.walls[1].size(),
          [&](const auto& f) {
            for_each_facet(body, found, bodies, budget, [&](const Facet& facet) { f(moved(facet, body)); });
            for (const auto& list : closed.added)
              for (const Facet& facet : list) f(moved(facet, body));
            for (const auto& list : closed.walls)
              for (const Facet& facet : list) f(facet);
          },
          names[b]);
    } else {
      write_ply(
          *files.back(), count,
          [&](const auto& f) {
            for (const auto& list : closed.added)
              for (const Facet& facet : list) f(facet);
          },
          names[b]);
    }
  }
  return files;
}

}  // namespace teracell::mesher

// Binary PLY: vertices that facets share, in double precision, and facets with the number of the cell's material. Each edge has exactly two
// facets. Vertices come first in the file, so the surface is gone through three times: to count, for the vertices, for the facets.
#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "tools/export/faces/surface.hpp"

namespace teracell::exports {
namespace faces {
namespace {

std::string header_of(const Export& e, const Surface& surface) {
  constexpr size_t kMostText = size_t{1} << 16;  // readers hold a header in memory
  std::string materials;
  if (e.map.empty())
    for (size_t id = 0; id < e.reader.meta().materials.size() && materials.size() < kMostText; ++id) {
      std::string name = e.reader.meta().materials[id].name;  // a comment is one line
      std::ranges::replace_if(
          name, [](char c) { return c == '\n' || c == '\r'; }, ' ');
      materials += fmt::format("comment material {} {}\n", id, name);
    }
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment teracell: boundary of cells, lengths in {}\n{}"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "element face {}\nproperty list uchar {} vertex_indices\nproperty uint material\nend_header\n",
      e.reader.meta().units, materials, surface.vertices(), surface.facets(), surface.vertices() <= INT32_MAX ? "int" : "uint");
}

void write_ply(const Export& e) {
  OutputFile file(e.output);
  Surface surface(e, {0, 0.3}, {"ply", UINT32_MAX, UINT64_MAX, "a coarser --level or a --region"});
  const std::string header = header_of(e, surface);
  Bytes bytes(header.begin(), header.end());
  const auto append = [&](size_t at_least) {
    if (bytes.size() < at_least) return;
    file.append(bytes);
    bytes.clear();
  };
  surface.for_each_placed({0.3, 0.65}, [&](const Surface::Part& part) {
    for (const uint32_t vertex : part.own) {
      put_raw(bytes, part.places[vertex]);
      append(1 << 16);
    }
  });
  surface.for_each_numbered({0.65, 1}, [&](const Surface::Part& part) {
    part.piece.for_each_facet(part.box, [&](size_t cell, const std::array<uint32_t, 3>& vertex) {
      bytes.push_back(3);
      for (const uint32_t v : vertex) put_raw(bytes, static_cast<uint32_t>(part.numbers[v]));
      const uint16_t material = part.cells.material[cell];
      put_raw(bytes, e.map.empty() ? uint32_t{material} : e.map[material]);
      append(1 << 16);
    });
  });
  append(1);
  file.commit();
}

}  // namespace
}  // namespace faces

ExportFormat ply_format() {
  return {.name = "ply",
          .extensions = {".ply"},
          .holds = "the boundary of cells as a closed surface, with the materials",
          .write = faces::write_ply,
          .options = faces::surface_options()};
}

}  // namespace teracell::exports

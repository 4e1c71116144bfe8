// Neuroglancer precomputed: a segmentation whose ids are materials. A level is offered in three sizes of flat blocks, one for each
// cross-section. So a view needs few blocks, and since blocks are made when they are asked for, offering three sizes costs nothing.
// Blocks at the edge are smaller. The background is 0, which the viewer hides.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/protocols/blocks.hpp"
#include "server/protocols/protocols.hpp"
#include "store/grid/space.hpp"
#include "store/read/stats.hpp"

namespace teracell::server {
namespace {

using nlohmann::ordered_json;

constexpr std::array<Index3, 3> kBlocks = {{{256, 256, 1}, {256, 1, 256}, {1, 256, 256}}};
// Volumes are given only where the index yields them in a fraction of a second, since a viewer waits for them. Uncached, it takes
// 0.35 us per chunk (a surface at 10,000^3).
constexpr uint64_t kMostChunks = uint64_t{1} << 17;

ordered_json info(const ServedGrid& grid) {
  const Metadata& meta = grid.meta();
  const Space space(meta);
  ordered_json scales = ordered_json::array();
  for (int level = 0; level < grid.reader().levels(); ++level) {
    ordered_json resolution = ordered_json::array();
    for (int axis = 0; axis < 3; ++axis) resolution.push_back(space.step(axis, level) * space.nanometres);
    scales.push_back({{"key", fmt::format("s{}", level)},
                      {"size", meta.grid.cells(level)},
                      {"voxel_offset", {0, 0, 0}},
                      {"resolution", resolution},
                      {"encoding", "raw"},
                      {"chunk_sizes", kBlocks}});
  }
  return {{"@type", "neuroglancer_multiscale_volume"},
          {"type", "segmentation"},
          {"data_type", wide_labels(meta) ? "uint16" : "uint8"},
          {"num_channels", 1},
          {"segment_properties", "segprops"},
          {"scales", scales},
          {"teracell", space_json(meta)}};
}

bool has_quick_volumes(const ServedGrid& grid) {
  const LevelShape shape = grid.reader().shape(0);
  return !Space(grid.meta()).index && uint64_t{shape.chunks_u} * shape.chunks_v * shape.segments <= kMostChunks;
}

ordered_json segment_properties(const ServedGrid& grid) {
  const Metadata& meta = grid.meta();
  ordered_json ids = ordered_json::array(), names = ordered_json::array(), volumes = ordered_json::array();
  for (size_t id = 1; id < meta.materials.size(); ++id) {
    ids.push_back(std::to_string(id));
    names.push_back(meta.materials[id].name);
  }
  ordered_json properties = ordered_json::array({{{"id", "label"}, {"type", "label"}, {"values", names}}});
  if (has_quick_volumes(grid)) {
    const auto stats = read_stats(grid.reader(), meta.grid.box(0));
    for (size_t id = 1; id < stats.size(); ++id) volumes.push_back(stats[id].volume);
    properties.push_back({{"id", fmt::format("volume_{}3", meta.units)}, {"type", "number"}, {"data_type", "float32"}, {"values", volumes}});
  }
  return {{"@type", "neuroglancer_segment_properties"}, {"inline", {{"ids", ids}, {"properties", properties}}}};
}

// The block "x0-x1_y0-y1_z0-z1", if one of the three sizes divides the level that way.
std::optional<Box> block_of(const Metadata& meta, int level, std::string_view name) {
  const auto ranges = split(name, '_');
  if (ranges.size() != 3) return std::nullopt;
  Box box;
  for (size_t d = 0; d < 3; ++d) {
    const auto ends = split(ranges[d], '-');
    const auto lo = plain_integer(ends[0]), hi = ends.size() == 2 ? plain_integer(ends[1]) : std::nullopt;
    if (!lo || !hi) return std::nullopt;
    box.lo[d] = *lo, box.hi[d] = *hi;
  }
  const Index3 n = meta.grid.cells(level);
  for (const Index3& size : kBlocks) {
    bool fits = true;
    for (size_t d = 0; d < 3; ++d) fits &= box.lo[d] < n[d] && box.lo[d] % size[d] == 0 && box.hi[d] == std::min(box.lo[d] + size[d], n[d]);
    if (fits) return box;
  }
  return std::nullopt;
}

std::optional<Service::Recipe> find_in_precomputed(const ServedGrid& grid, std::span<const std::string> path) {
  const std::string name = joined(path);
  if (name == "info") return json_recipe([&grid] { return info(grid); });
  if (name == "segprops/info") return json_recipe([&grid] { return segment_properties(grid); });
  if (path.size() != 2 || !path[0].starts_with('s')) return std::nullopt;
  const auto level = find_level(grid.meta(), std::string_view(path[0]).substr(1));
  const auto box = level ? block_of(grid.meta(), *level, path[1]) : std::nullopt;
  if (!box) return std::nullopt;
  return Service::Recipe{.content_type = "application/octet-stream", .compress = true, .make = [&grid, level = *level, box = *box] {
                           return labels_in(grid.reader(), level, box);
                         }};
}

}  // namespace

Protocol precomputed() {
  return {.prefix = "precomputed", .route = "precomputed", .title = "Neuroglancer", .document = "/info", .serve = serve_by_id(find_in_precomputed)};
}

}  // namespace teracell::server

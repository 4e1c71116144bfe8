// Zarr v2 for xarray, with one group per level that also has the coordinates of the cells.
//
// xarray turns an array with a fill value into floats, so these arrays have none. For a chunk that is missing, readers of such an
// array leave memory as it is; so every chunk in range must exist.
#include <algorithm>
#include <bit>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/protocols/protocols.hpp"
#include "server/protocols/zarr2_nodes.hpp"
#include "server/service/deflate.hpp"
#include "store/grid/space.hpp"

namespace teracell::server {
namespace {

using nlohmann::ordered_json;

constexpr int64_t kCoordinates = 65536;  // per chunk

Documents documents_of(const ServedGrid& grid, int level) {
  Documents out;
  out.emplace_back(".zgroup", zarr2_group);
  out.emplace_back(".zattrs", [&grid, level] { return ordered_json{{"units", grid.meta().units}, {"level", level}}; });
  out.emplace_back("label/.zarray", [&grid, level] { return zarr2_labels(grid.meta(), level, nullptr); });
  out.emplace_back("label/.zattrs", [&grid] { return zarr2_label_attributes(grid.meta(), true); });
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t n = grid.meta().grid.cells(level)[axis];
    out.emplace_back(axis_name(axis) + "/.zarray", [n] { return zarr2_array({n}, {std::min(n, kCoordinates)}, "<f8", nullptr); });
    out.emplace_back(axis_name(axis) + "/.zattrs", [&grid, axis] {
      return ordered_json{{"_ARRAY_DIMENSIONS", {axis_name(axis)}}, {"units", grid.meta().units}};
    });
  }
  return out;
}

// The coordinates of `chunk` along an axis of the level, padded with zeros.
std::string coordinates(const Axis& axis, int level, int64_t cells, int64_t chunk) {
  const int64_t size = std::min(cells, kCoordinates), first = chunk * size;
  std::string out(static_cast<size_t>(8 * size), '\0');
  for (int64_t i = 0; i < std::min(size, cells - first); ++i) {
    const auto bits = std::bit_cast<uint64_t>(coordinate(axis, level, first + i));
    for (int64_t b = 0; b < 8; ++b) out[static_cast<size_t>(8 * i + b)] = static_cast<char>(bits >> (8 * b) & 0xFF);
  }
  return out;
}

std::optional<Service::Recipe> find_coordinates(const ServedGrid& grid, int level, const std::string& name, const std::string& key) {
  const auto chunk = plain_integer(key);
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t n = grid.meta().grid.cells(level)[axis];
    if (name != axis_name(axis) || !chunk || *chunk > (n - 1) / kCoordinates) continue;
    return Service::Recipe{.content_type = "application/octet-stream", .make = [&grid, level, axis, n, k = *chunk] {
                             return deflated(coordinates(grid.meta().grid.axis[axis], level, n, k), Wrapping::kZlib);
                           }};
  }
  return std::nullopt;
}

std::optional<Service::Recipe> find_in_xarray(const ServedGrid& grid, std::span<const std::string> path) {
  const auto level = path.empty() ? std::nullopt : find_level(grid.meta(), path[0]);
  if (!level) return std::nullopt;
  path = path.subspan(1);
  if (path.size() == 4 && path[0] == "label") return find_zarr2_cube(grid, *level, path.subspan(1));
  if (path.size() == 2)
    if (auto found = find_coordinates(grid, *level, path[0], path[1])) return found;
  return find_zarr2_document(documents_of(grid, *level), path);
}

}  // namespace

Protocol xarray() {
  return {.prefix = "xarray",
          .route = "xarray",
          .title = "xarray",
          .address = [](const ServedGrid& g) { return fmt::format("/{}/0", percent_encoded(g.id)); },
          .document = "/.zmetadata",
          .serve = serve_by_id(find_in_xarray)};
}

}  // namespace teracell::server

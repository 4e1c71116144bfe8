// Zarr v2 in two forms: as OME-Zarr 0.4, with one array per level, and for xarray, with one group per level that also has the
// coordinates of the cells.
//
// xarray turns an array with a fill value into floats, so the arrays for xarray have none. For a chunk that is missing, readers of
// such an array leave memory as it is; so every chunk in range must exist.
#include <algorithm>
#include <bit>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/protocols/blocks.hpp"
#include "server/protocols/protocols.hpp"
#include "server/protocols/space.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

constexpr int64_t kCoordinates = 65536;  // per chunk
constexpr const char* kConsolidated = ".zmetadata";

ordered_json group() { return {{"zarr_format", 2}}; }

ordered_json array(const ordered_json& shape, const ordered_json& chunks, const char* type, const ordered_json& fill) {
  return {{"zarr_format", 2},
          {"shape", shape},
          {"chunks", chunks},
          {"dtype", type},
          {"compressor", {{"id", "zlib"}, {"level", 1}}},
          {"fill_value", fill},
          {"order", "C"},
          {"filters", nullptr},
          {"dimension_separator", "/"}};
}

ordered_json labels(const Metadata& meta, int level, const ordered_json& fill) {
  const Index3 n = meta.grid.cells(level);
  return array({n[2], n[1], n[0]}, {kZarrCells, kZarrCells, kZarrCells}, wide_labels(meta) ? "<u2" : "|u1", fill);
}

// xarray reads the names of the dimensions.
ordered_json label_attributes(const Metadata& meta) {
  ordered_json names = ordered_json::array();
  for (const MaterialInfo& m : meta.materials) names.push_back(m.name);
  return {{"_ARRAY_DIMENSIONS", {"z", "y", "x"}}, {"materials", names}};
}

Documents ome_documents(const ServedGrid& grid) {
  Documents out;
  out.emplace_back(".zgroup", group);
  out.emplace_back(".zattrs", [&grid] {
    ordered_json scales = multiscale_json(grid.meta(), grid.id);
    scales["version"] = "0.4";
    return ordered_json{{"multiscales", ordered_json::array({scales})}, {"teracell", space_json(grid.meta())}};
  });
  for (int level = 0; level < grid.reader().levels(); ++level) {
    out.emplace_back(std::to_string(level) + "/.zarray", [&grid, level] { return labels(grid.meta(), level, 0); });
    out.emplace_back(std::to_string(level) + "/.zattrs", [&grid] { return label_attributes(grid.meta()); });
  }
  return out;
}

Documents xarray_documents(const ServedGrid& grid, int level) {
  Documents out;
  out.emplace_back(".zgroup", group);
  out.emplace_back(".zattrs", [&grid, level] { return ordered_json{{"units", grid.meta().units}, {"level", level}}; });
  out.emplace_back("label/.zarray", [&grid, level] { return labels(grid.meta(), level, nullptr); });
  out.emplace_back("label/.zattrs", [&grid] { return label_attributes(grid.meta()); });
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t n = grid.meta().grid.cells(level)[axis];
    out.emplace_back(axis_name(axis) + "/.zarray", [n] { return array({n}, {std::min(n, kCoordinates)}, "<f8", nullptr); });
    out.emplace_back(axis_name(axis) + "/.zattrs", [&grid, axis] {
      return ordered_json{{"_ARRAY_DIMENSIONS", {axis_name(axis)}}, {"units", grid.meta().units}};
    });
  }
  return out;
}

std::optional<Service::Recipe> find_in(const Documents& documents, std::span<const std::string> path) {
  if (path.size() != 1 || path[0] != kConsolidated) return find_document(documents, joined(path));
  return json_recipe([documents] {
    ordered_json all = ordered_json::object();
    for (const auto& [name, make] : documents) all[name] = make();
    return ordered_json{{"zarr_consolidated_format", 1}, {"metadata", all}};
  });
}

std::optional<Service::Recipe> find_cube(const ServedGrid& grid, int level, std::span<const std::string> key) {
  const auto cube = zarr_cube(grid.meta(), level, key);
  if (!cube) return std::nullopt;
  return cube_recipe(grid, level, *cube, Wrapping::kZlib);
}

std::optional<Service::Recipe> find_ome(const ServedGrid& grid, std::span<const std::string> path) {
  if (path.size() != 4) return find_in(ome_documents(grid), path);
  const auto level = find_level(grid.meta(), path[0]);
  return level ? find_cube(grid, *level, path.subspan(1)) : std::nullopt;
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

std::optional<Service::Recipe> find_xarray(const ServedGrid& grid, std::span<const std::string> path) {
  const auto level = path.empty() ? std::nullopt : find_level(grid.meta(), path[0]);
  if (!level) return std::nullopt;
  path = path.subspan(1);
  if (path.size() == 4 && path[0] == "label") return find_cube(grid, *level, path.subspan(1));
  if (path.size() == 2)
    if (auto found = find_coordinates(grid, *level, path[0], path[1])) return found;
  return find_in(xarray_documents(grid, *level), path);
}

}  // namespace

Protocol zarr2() {
  return {.prefix = "zarr2",
          .route = "zarr2",
          .title = "Zarr 2",
          .example = [](const ServedGrid& g) { return fmt::format("/{}/.zattrs", percent_encoded(g.id)); },
          .serve = serve_by_id(find_ome)};
}

Protocol xarray() {
  return {.prefix = "xarray",
          .route = "xarray",
          .title = "xarray",
          .example = [](const ServedGrid& g) { return fmt::format("/{}/0/{}", percent_encoded(g.id), kConsolidated); },
          .serve = serve_by_id(find_xarray)};
}

}  // namespace teracell

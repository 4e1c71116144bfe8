#include "server/protocols/zarr2_nodes.hpp"

#include <nlohmann/json.hpp>

#include "server/protocols/blocks.hpp"

namespace teracell::server {

using nlohmann::ordered_json;

ordered_json zarr2_group() { return {{"zarr_format", 2}}; }

ordered_json zarr2_array(const ordered_json& shape, const ordered_json& chunks, const char* type, const ordered_json& fill) {
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

ordered_json zarr2_labels(const Metadata& meta, int level, const ordered_json& fill) {
  const Index3 n = meta.grid.cells(level);
  return zarr2_array({n[2], n[1], n[0]}, {kZarrCells, kZarrCells, kZarrCells}, wide_labels(meta) ? "<u2" : "|u1", fill);
}

ordered_json zarr2_label_attributes(const Metadata& meta, bool with_names) {
  ordered_json attributes = {{"_ARRAY_DIMENSIONS", {"z", "y", "x"}}};
  if (!with_names) return attributes;
  ordered_json names = ordered_json::array();
  for (const MaterialInfo& m : meta.materials) names.push_back(m.name);
  attributes["materials"] = std::move(names);
  return attributes;
}

std::optional<Service::Recipe> find_zarr2_document(const Documents& documents, std::span<const std::string> path) {
  if (path.size() != 1 || path[0] != kZarr2Consolidated) return find_document(documents, joined(path));
  return json_recipe([documents] {
    ordered_json all = ordered_json::object();
    for (const auto& [name, make] : documents) all[name] = make();
    return ordered_json{{"zarr_consolidated_format", 1}, {"metadata", all}};
  });
}

std::optional<Service::Recipe> find_zarr2_cube(const ServedGrid& grid, int level, std::span<const std::string> key) {
  const auto cube = zarr_cube(grid.meta(), level, key);
  if (!cube) return std::nullopt;
  return cube_recipe(grid, level, *cube, Wrapping::kZlib);
}

}  // namespace teracell::server

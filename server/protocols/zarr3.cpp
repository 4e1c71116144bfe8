// Zarr v3 with OME-Zarr 0.5. The group of a grid has one array per level, "0" being the finest. The same arrays are there once more
// as labels ("labels/material"), with names and colours, for clients that distinguish images and labels. A grid with fractions has the
// share of each material in its finest cells ("fraction/steel").
//
// The metadata is consolidated, since nothing can be listed over HTTP.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/protocols/blocks.hpp"
#include "server/protocols/protocols.hpp"
#include "store/grid/ome.hpp"
#include "store/grid/space.hpp"

namespace teracell::server {
namespace {

using nlohmann::ordered_json;

constexpr const char *kZarrDocument = "zarr.json", *kLabels = "labels", *kMaterial = "labels/material", *kFraction = "fraction";

ordered_json group(const ordered_json& ome) { return {{"zarr_format", 3}, {"node_type", "group"}, {"attributes", {{"ome", ome}}}}; }

ordered_json array(const Metadata& meta, int level, const char* type) {
  const Index3 n = meta.grid.cells(level);
  ordered_json bytes = {{"name", "bytes"}};
  if (type != std::string_view("uint8")) bytes["configuration"] = {{"endian", "little"}};
  return {{"zarr_format", 3},
          {"node_type", "array"},
          {"shape", {n[2], n[1], n[0]}},
          {"data_type", type},
          {"dimension_names", {"z", "y", "x"}},
          {"chunk_grid", {{"name", "regular"}, {"configuration", {{"chunk_shape", {kZarrCells, kZarrCells, kZarrCells}}}}}},
          {"chunk_key_encoding", {{"name", "default"}, {"configuration", {{"separator", "/"}}}}},
          {"fill_value", 0},
          {"codecs", {bytes, {{"name", "gzip"}, {"configuration", {{"level", 1}}}}}},
          {"attributes", ordered_json::object()}};
}

ordered_json array(const Metadata& meta, int level) { return array(meta, level, wide_labels(meta) ? "uint16" : "uint8"); }

// The segments of the paths to the shares of materials, by id: a material's name; or "id-3" where that can't be a segment, or could be taken
// for one of these.
std::vector<std::string> segments_of(const Metadata& meta) {
  std::vector<std::string> out;
  for (uint32_t material = 0; material < meta.materials.size(); ++material) {
    const std::string& name = meta.materials[material].name;
    const bool plain = !name.empty() && name.find('/') == std::string::npos && name != "." && name != ".." && !name.starts_with("__");
    out.push_back(plain && name != kZarrDocument && !name.starts_with("id-") ? name : fmt::format("id-{}", material));
  }
  return out;
}

std::optional<uint32_t> material_at(const Metadata& meta, std::string_view segment) {
  const std::vector<std::string> segments = segments_of(meta);
  const auto found = std::ranges::find(segments, segment);
  return found == segments.end() ? std::nullopt : std::optional(static_cast<uint32_t>(found - segments.begin()));
}

ordered_json fraction_array(const Metadata& meta, uint32_t material) {
  ordered_json j = array(meta, 0, "float32");
  j["attributes"]["teracell"] = {{"material", material}, {"name", meta.materials[material].name}};
  return j;
}

// So many materials are listed at the root. Shares of others have metadata of their own.
constexpr uint32_t kMostListed = 256;

// The shares in a cube as float32, little endian, like every machine this runs on.
Service::Recipe fraction_recipe(const ServedGrid& grid, uint32_t material, const Box& cube) {
  return {.content_type = "application/octet-stream", .make = [&grid, material, cube] {
            std::vector<float> shares(static_cast<size_t>(kZarrCells * kZarrCells * kZarrCells));
            grid.fractions->read_box<float>(cube, material, 0, shares.data(), {1, kZarrCells, kZarrCells * kZarrCells});
            return deflated(std::string(reinterpret_cast<const char*>(shares.data()), shares.size() * sizeof(float)), Wrapping::kGzip);
          }};
}

ordered_json grid_group(const ServedGrid& grid) {
  ordered_json j = group({{"version", "0.5"}, {"multiscales", ordered_json::array({multiscale_json(grid.meta(), grid.id)})}});
  j["attributes"]["teracell"] = space_json(grid.meta());
  return j;
}

ordered_json label_group(const ServedGrid& grid) {
  ordered_json image_label = image_label_json(grid.meta());
  image_label["source"] = {{"image", "../../"}};
  ordered_json j =
      group({{"version", "0.5"}, {"multiscales", ordered_json::array({multiscale_json(grid.meta(), "material")})}, {"image-label", image_label}});
  j["attributes"]["teracell"] = space_json(grid.meta());
  return j;
}

// All nodes except the root, by their paths, with the shares of so many materials.
Documents nodes(const ServedGrid& grid, size_t most_fractions) {
  Documents out;
  const auto add_levels = [&](const std::string& prefix) {
    for (int level = 0; level < grid.reader().levels(); ++level)
      out.emplace_back(prefix + std::to_string(level), [&grid, level] { return array(grid.meta(), level); });
  };
  add_levels("");
  out.emplace_back(kLabels, [] { return group({{"version", "0.5"}, {"labels", {"material"}}}); });
  out.emplace_back(kMaterial, [&grid] { return label_group(grid); });
  add_levels(fmt::format("{}/", kMaterial));
  if (!grid.fractions) return out;
  out.emplace_back(kFraction, [&grid] {
    ordered_json j = {{"zarr_format", 3}, {"node_type", "group"}};
    j["attributes"]["teracell"] = space_json(grid.meta());
    return j;
  });
  const std::vector<std::string> segments = segments_of(grid.meta());
  for (uint32_t material = 0; material < std::min(segments.size(), most_fractions); ++material)
    out.emplace_back(fmt::format("{}/{}", kFraction, segments[material]), [&grid, material] { return fraction_array(grid.meta(), material); });
  return out;
}

ordered_json root(const ServedGrid& grid) {
  ordered_json j = grid_group(grid), metadata = ordered_json::object();
  for (const auto& [path, make] : nodes(grid, kMostListed)) metadata[path] = make();
  j["consolidated_metadata"] = {{"kind", "inline"}, {"must_understand", false}, {"metadata", metadata}};
  return j;
}

std::optional<Service::Recipe> find_in_zarr3(const ServedGrid& grid, std::span<const std::string> path) {
  if (path.empty()) return std::nullopt;
  if (path.back() == kZarrDocument) {
    if (path.size() == 1) return json_recipe([&grid] { return root(grid); });
    return find_document(nodes(grid, ~size_t{0}), joined(path.first(path.size() - 1)));
  }
  if (path.size() == 6 && path[0] == kFraction && path[2] == "c" && grid.fractions) {
    const auto material = material_at(grid.meta(), path[1]);
    const auto cube = material ? zarr_cube(grid.meta(), 0, path.subspan(3)) : std::nullopt;
    if (!cube) return std::nullopt;
    return fraction_recipe(grid, *material, *cube);
  }
  if (path.size() > 2 && joined(path.first(2)) == kMaterial) path = path.subspan(2);
  if (path.size() != 5 || path[1] != "c") return std::nullopt;
  const auto level = find_level(grid.meta(), path[0]);
  const auto cube = level ? zarr_cube(grid.meta(), *level, path.subspan(2)) : std::nullopt;
  if (!cube) return std::nullopt;
  return cube_recipe(grid, *level, *cube, Wrapping::kGzip);
}

}  // namespace

Protocol zarr3() {
  return {.prefix = "zarr", .route = "zarr3", .title = "Zarr 3, OME-Zarr", .document = "/zarr.json", .serve = serve_by_id(find_in_zarr3)};
}

}  // namespace teracell::server

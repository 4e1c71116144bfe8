#include "tools/export/zarr/documents.hpp"

#include <nlohmann/json.hpp>

#include "store/grid/ome.hpp"
#include "store/grid/space.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports::zarr {
namespace {

using nlohmann::ordered_json;

ordered_json dimensions() { return {"z", "y", "x"}; }

ordered_json slowest_first(const Index3& n) { return {n[2], n[1], n[0]}; }

ordered_json multiscales(const Hierarchy& h) {
  const std::filesystem::path named = h.e.output.has_filename() ? h.e.output : h.e.output.parent_path();
  return multiscale_json(h.e.reader.meta(), named.stem().string(), h.e.level, h.e.box);
}

// The group is an image of labels: the numbers have names and colours, unless a map made them others.
ordered_json image_label(const Hierarchy& h) { return h.e.map.empty() ? image_label_json(h.e.reader.meta()) : ordered_json::object(); }

// What OME-Zarr has no words for.
ordered_json more(const Hierarchy& h) {
  const auto& [lo, hi] = h.e.box;
  ordered_json out = space_json(h.e.reader.meta());
  out["level"] = h.e.level;
  out["region"] = {lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]};
  for (int axis = 0; axis < 3; ++axis)
    if (h.e.reader.meta().grid.axis[static_cast<size_t>(axis)].is_graded()) out["planes"][axis_name(axis)] = planes_of(h.e, axis);
  return out;
}

ordered_json array3(const Hierarchy& h, const Layout& a) {
  const ordered_json little = {{"name", "bytes"}, {"configuration", {{"endian", "little"}}}};
  const ordered_json bytes = h.bytes_per_cell == 1 ? ordered_json{{"name", "bytes"}} : little;
  const ordered_json zstd = {{"name", "zstd"}, {"configuration", {{"level", kZstdLevel}, {"checksum", false}}}};
  const ordered_json sharding = {{"name", "sharding_indexed"},
                                 {"configuration",
                                  {{"chunk_shape", slowest_first(a.chunk_cells)},
                                   {"codecs", {bytes, zstd}},
                                   {"index_codecs", {little, {{"name", "crc32c"}}}},
                                   {"index_location", "end"}}}};
  return {{"zarr_format", 3},
          {"node_type", "array"},
          {"shape", slowest_first(a.cells)},
          {"data_type", h.bytes_per_cell == 1   ? "uint8"
                        : h.bytes_per_cell == 2 ? "uint16"
                                                : "uint32"},
          {"dimension_names", dimensions()},
          {"chunk_grid", {{"name", "regular"}, {"configuration", {{"chunk_shape", slowest_first(a.shard_cells())}}}}},
          {"chunk_key_encoding", {{"name", "default"}, {"configuration", {{"separator", "/"}}}}},
          {"fill_value", h.fill},
          {"codecs", ordered_json::array({sharding})},
          {"attributes", ordered_json::object()}};
}

ordered_json array2(const Hierarchy& h, const Layout& a) {
  return {{"zarr_format", 2},
          {"shape", slowest_first(a.cells)},
          {"chunks", slowest_first(a.chunk_cells)},
          {"dtype", h.bytes_per_cell == 1   ? "|u1"
                    : h.bytes_per_cell == 2 ? "<u2"
                                            : "<u4"},
          {"compressor", {{"id", "zstd"}, {"level", kZstdLevel}}},
          {"fill_value", h.fill},
          {"order", "C"},
          {"filters", nullptr},
          {"dimension_separator", "/"}};
}

}  // namespace

Documents documents3(const Hierarchy& h) {
  ordered_json root = {{"zarr_format", 3}, {"node_type", "group"}};
  root["attributes"] = {{"ome", {{"version", "0.5"}, {"multiscales", ordered_json::array({multiscales(h)})}, {"image-label", image_label(h)}}},
                        {"teracell", more(h)}};
  Documents out(1);
  ordered_json nodes = ordered_json::object();
  for (const Layout& a : h.arrays) {
    out.emplace_back(std::to_string(a.level) + "/zarr.json", array3(h, a));
    nodes[std::to_string(a.level)] = out.back().second;
  }
  root["consolidated_metadata"] = {{"kind", "inline"}, {"must_understand", false}, {"metadata", nodes}};
  out[0] = {"zarr.json", root};
  return out;
}

Documents documents2(const Hierarchy& h) {
  ordered_json scales = multiscales(h), label = {{"version", "0.4"}}, nodes = ordered_json::object();
  scales["version"] = "0.4";
  label.update(image_label(h));
  Documents out;
  out.emplace_back(".zgroup", ordered_json{{"zarr_format", 2}});
  out.emplace_back(".zattrs", ordered_json{{"multiscales", ordered_json::array({scales})}, {"image-label", label}, {"teracell", more(h)}});
  for (const Layout& a : h.arrays) {
    out.emplace_back(std::to_string(a.level) + "/.zarray", array2(h, a));
    out.emplace_back(std::to_string(a.level) + "/.zattrs", ordered_json{{"_ARRAY_DIMENSIONS", dimensions()}});
  }
  for (const auto& [name, document] : out) nodes[name] = document;
  out.emplace_back(".zmetadata", ordered_json{{"zarr_consolidated_format", 1}, {"metadata", nodes}});
  return out;
}

}  // namespace teracell::exports::zarr

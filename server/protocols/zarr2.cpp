// Zarr v2 as OME-Zarr 0.4, with one array per level.
#include <nlohmann/json.hpp>

#include "server/protocols/protocols.hpp"
#include "server/protocols/zarr2_nodes.hpp"
#include "store/grid/ome.hpp"
#include "store/grid/space.hpp"

namespace teracell::server {
namespace {

using nlohmann::ordered_json;

Documents documents_of(const ServedGrid& grid) {
  Documents out;
  out.emplace_back(".zgroup", zarr2_group);
  out.emplace_back(".zattrs", [&grid] {
    ordered_json scales = multiscale_json(grid.meta(), grid.id);
    scales["version"] = "0.4";
    return ordered_json{{"multiscales", ordered_json::array({scales})}, {"teracell", space_json(grid.meta())}};
  });
  for (int level = 0; level < grid.reader().levels(); ++level) {
    out.emplace_back(std::to_string(level) + "/.zarray", [&grid, level] { return zarr2_labels(grid.meta(), level, 0); });
    out.emplace_back(std::to_string(level) + "/.zattrs", [&grid, level] { return zarr2_label_attributes(grid.meta(), level == 0); });
  }
  return out;
}

std::optional<Service::Recipe> find_in_zarr2(const ServedGrid& grid, std::span<const std::string> path) {
  if (path.size() != 4) return find_zarr2_document(documents_of(grid), path);
  const auto level = find_level(grid.meta(), path[0]);
  return level ? find_zarr2_cube(grid, *level, path.subspan(1)) : std::nullopt;
}

}  // namespace

Protocol zarr2() { return {.prefix = "zarr2", .route = "zarr2", .title = "Zarr 2", .document = "/.zattrs", .serve = serve_by_id(find_in_zarr2)}; }

}  // namespace teracell::server

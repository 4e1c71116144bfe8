// A service over one grid of random cells, asked without a socket.
#pragma once
#include "server/api/routes.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {

using namespace testing;

using nlohmann::json;

inline const Index3 kCells = {37, 530, 21};
inline constexpr uint32_t kMaterials = 5;

inline Grid grid() {
  return {{Axis::uniform(-1, 0.5, 0, kCells[0], 0.5), Axis::uniform(2, 0.25, 0, kCells[1], 0.5), Axis::uniform(0, 1, 0, kCells[2], 0.5)}};
}

// A service over one grid "g" of random cells.
struct Served {
  TempFolder folder;
  std::vector<Label> cells;
  std::filesystem::path path = folder / "g.tcell";
  std::unique_ptr<server::Service> service;

  explicit Served(int ray_axis = 2, ServiceOptions options = {}) {
    std::mt19937_64 random(7);
    cells = random_cells(random, kCells, kMaterials);
    store_cells(path, metadata_of(grid(), ray_axis, kMaterials), cells);
    options.named = {folder.path()};
    service = std::make_unique<server::Service>(options);
  }
  Label at(int64_t x, int64_t y, int64_t z) const { return cells[static_cast<size_t>((z * kCells[1] + y) * kCells[0] + x)]; }
  Response get(const std::string& target) { return handle(*service, {.target = target}); }
  json parsed(const std::string& target) {
    const Response r = get(target);
    INFO(target << ": " << (r.body ? *r.body : ""));
    REQUIRE(r.status == 200);
    REQUIRE(r.content_type == "application/json");
    return json::parse(*r.body);
  }
  std::string error(const std::string& target) { return json::parse(*get(target).body)["error"]["message"]; }
  std::string hash() { return service->grids().find("g")->hash; }
  void rename(const std::string& file) {
    std::filesystem::rename(path, folder / file);
    service->grids().look();
  }
};

}  // namespace teracell::server

// The routes with any target, for one small grid: every answer has one of the expected statuses and a body, and no damage is ever
// found. The first byte selects header fields; the rest is the target as it was sent.
#include <cstdlib>
#include <filesystem>

#include <unistd.h>

#include "server/api/routes.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

Service& service() {
  static Service* const served = [] {
    const auto folder = std::filesystem::temp_directory_path() / ("routes_fuzz." + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    const Grid grid{{Axis::uniform(0, 1, 0, 19, 0.5), Axis::graded({0, 1, 3, 4, 8, 9, 12}, 0.5), Axis::uniform(-1, 0.5, 2, 9, 0)}};
    std::mt19937_64 random(1);
    store_cells(folder / "g.tcell", with_tiny_chunks(metadata_of(grid, 1, 4)), random_cells(random, grid.cells(), 4));
    auto* made = new Service({.named = {folder / "g.tcell"}, .cache_bytes = 1 << 20, .max_pixels = 1000});
    made->grids().find("g");
    std::atexit([] { std::filesystem::remove_all(std::filesystem::temp_directory_path() / ("routes_fuzz." + std::to_string(getpid()))); });
    return made;
  }();
  return *served;
}

}  // namespace
}  // namespace teracell::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace teracell::server;
  if (size == 0) return 0;
  Request request;
  request.target.assign(reinterpret_cast<const char*>(data + 1), size - 1);
  request.accepts_gzip = data[0] & 1;
  if (data[0] & 2) request.if_none_match = "*";
  request.origin = "http://localhost";
  const Response r = handle(service(), request);
  const bool known = r.status == 200 || r.status == 303 || r.status == 304 || r.status == 400 || r.status == 404;
  if (!known || (!r.body && r.status != 304) || service().counters().damaged != 0) std::abort();
  return 0;
}

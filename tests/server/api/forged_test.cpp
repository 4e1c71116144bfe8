// Small forged files whose chunks, names or pages become large: what an answer takes beside the cache. (tests/siege serves thousands of
// files, and measures time, too.)
#include "server/api/routes.hpp"
#include "tests/siege/forged_files.hpp"
#include "tests/siege/targets.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/peak.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

TEST_CASE("Whatever is asked of a forged file of 64 kB, the answer takes at most 256 MB beside the cache, or is an error", "[forged]") {
  if (kSanitized) return;  // their own memory counts, too
  const TempFolder folder;
  for (size_t number = 0; number < hand_made_files(); ++number) {
    const std::string name = hand_made_name(number);
    if (name != "65,536 rays of as many changes as there may be, beyond bounds" && name != "64 rays of as many changes, side by side, large" &&
        name != "unions of labels that are all different, on a level that is derived, large")
      continue;
    const auto file = hand_made_file(number);
    REQUIRE(file);
    write_bytes(folder / "g.tcell", file->bytes);
    Service service({.named = {folder / "g.tcell"}, .cache_bytes = size_t{16} << 20});
    const auto grid = service.grids().find("g");
    const std::vector<std::string> targets = targets_of(grid->meta(), grid->reader().levels());
    for (size_t i = 0; i < targets.size(); i += 11) {
      const std::string& target = targets[i];
      if (target.find("slice") != std::string::npos && grid->meta().grid.cells()[2] > 1 << 24) continue;  // a second each
      int status = 0;
      const int64_t peak = peak_memory_of([&] { status = handle(service, {.target = target}).status; });
      if (peak > (int64_t{256 + 16} << 20)) FAIL(name << ": " << target << " takes " << peak << " bytes");
      if (status >= 500 && status != 500) FAIL(name << ": " << target << " is answered with " << status);
    }
  }
}

}  // namespace
}  // namespace teracell::server

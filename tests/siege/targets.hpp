// What the server's routes can be asked for: every one of them, with the least and the most that it may be asked for at once.
#pragma once
#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "store/grid/metadata.hpp"

namespace teracell::testing {

inline std::vector<std::string> targets_of(const Metadata& meta, int levels) {
  std::vector<std::string> out;
  const std::string api = "/api/v1/grids/g";
  for (const char* document : {"", "/stats"}) out.push_back(api + document);
  for (const char* document : {"/zarr/g/zarr.json", "/zarr2/g/.zmetadata", "/xarray/g/0/.zmetadata", "/precomputed/g/info",
                               "/precomputed/g/segprops/info", "/zarr/g/labels/material/zarr.json"})
    out.emplace_back(document);
  const Index3 n0 = meta.grid.cells();
  const Box part{{n0[0] / 3, n0[1] / 3, n0[2] / 3}, {n0[0] - n0[0] / 3, n0[1] - n0[1] / 3, n0[2] - n0[2] / 3}};
  out.push_back(fmt::format("{}/stats?region={},{},{},{},{},{}", api, part.lo[0], part.lo[1], part.lo[2], part.hi[0], part.hi[1], part.hi[2]));
  std::vector<int> some = {0, 1, 2, 3, levels / 2, levels - 1};
  std::erase_if(some, [&](int l) { return l >= levels; });
  std::ranges::sort(some);
  some.erase(std::unique(some.begin(), some.end()), some.end());
  for (int axis = 0; axis < 3; ++axis) {
    const RayFrame f = RayFrame::along(axis);
    const std::string name = axis_name(axis);
    out.push_back(fmt::format("{}/column/{}/{}_{}", api, name, n0[f.u] / 2, n0[f.v] / 2));
    out.push_back(fmt::format("{}/column/{}/0_0?from={}", api, name, n0[axis] / 2));
    out.push_back(fmt::format("/xarray/g/0/{}/0", name));
    out.push_back(fmt::format("/dzi/g/{}/{}.dzi", name, n0[axis] / 2));
    out.push_back(fmt::format("/iiif/g-{}-{}/full/max/0/default.png", name, n0[axis] / 2));
    for (const int scale : {0, 6, 12, 20, 31}) out.push_back(fmt::format("/dzi/g/{}/{}_files/{}/0_0.png", name, n0[axis] / 2, scale));
    for (const int level : some) {
      const Index3 n = meta.grid.cells(level);
      const int64_t i = n[axis] / 2, w = n[f.u], h = n[f.v];
      for (const int64_t width : {int64_t{1} << 26, int64_t{1} << 16, int64_t{1} << 13, int64_t{1} << 11, int64_t{1}}) {
        const int64_t c = std::min(w, width), r = std::min(h, (int64_t{1} << 26) / c);
        out.push_back(fmt::format("{}/slice/{}/{}.png?level={}&region=0,0,{},{}", api, name, i, level, c, r));
        out.push_back(fmt::format("{}/slice/{}/{}.png?level={}&region={},{},{},{}", api, name, i, level, (w - c) / 2, (h - r) / 2, (w - c) / 2 + c,
                                  (h - r) / 2 + r));
      }
      out.push_back(fmt::format("{}/slice/{}/{}.png?level={}&region=0,0,{},{}&outline=1", api, name, i, level, std::min<int64_t>(w, 2048),
                                std::min<int64_t>(h, 2048)));
      const auto tile = fmt::format("{}/tile/{}/{}/{}/", api, name, i, level);
      for (const char* end : {"0_0.png", "0_0.bin", "0_0.bin?sets=1", "0_0.bin?sets=1&bodies=1", "0_0.png?outline=1"}) out.push_back(tile + end);
      out.push_back(fmt::format("{}{}_{}.bin?sets=1", tile, (w - 1) / 1024, (h - 1) / 1024));
    }
  }
  const auto corner = [&](int64_t x, int64_t y, int64_t z) {
    return fmt::format("{},{},{}", meta.grid.axis[0].plane(x), meta.grid.axis[1].plane(y), meta.grid.axis[2].plane(z));
  };
  for (const int level : some)
    for (const char* ending : {"png", "bin", "bin?bodies=1"})
      out.push_back(fmt::format("{}/slice/plane.{}{}plane=30,40,{}&level={}", api, ending, std::strchr(ending, '?') ? "&" : "?",
                                corner(n0[0] / 2, n0[1] / 2, n0[2] / 2), level));
  const std::string first = corner(0, 0, 0);
  for (const std::string& last : {corner(n0[0], n0[1], n0[2]), corner(n0[0], 0, 0), corner(0, n0[1], 0), corner(0, 0, n0[2])})
    out.push_back(fmt::format("{}/line?from={}&to={}", api, first, last));
  out.push_back(fmt::format("{}/nearest?labels=1&cell=0,0,0", api));
  out.push_back(fmt::format("{}/view.bin?size=64,48&against=g", api));
  for (const char* ending : {"npy", "vti", "vtr"}) {
    out.push_back(fmt::format("{}/box.{}", api, ending));
    out.push_back(fmt::format("{}/box.{}?region=0,0,0,{},{},{}", api, ending, std::min<int64_t>(n0[0], 2048), std::min<int64_t>(n0[1], 2048),
                              std::min<int64_t>(n0[2], 1024)));
  }
  out.push_back(fmt::format("{}/stats?bodies=1", api));
  for (const int level : some) {
    const Index3 n = meta.grid.cells(level);
    out.push_back(fmt::format("{}/cell?i={}&j={}&k={}&level={}", api, n[0] / 2, n[1] / 2, n[2] / 2, level));
    for (const char* protocol : {"/zarr/g/{}/c/", "/zarr2/g/{}/", "/xarray/g/{}/label/"})
      for (const int64_t part_of : {1, 2})
        out.push_back(fmt::format("{}{}/{}/{}", fmt::format(fmt::runtime(protocol), level), (n[2] - 1) / 64 / part_of, (n[1] - 1) / 64 / part_of,
                                  (n[0] - 1) / 64 / part_of));
    for (const Index3& size : {Index3{256, 256, 1}, {256, 1, 256}, {1, 256, 256}})
      out.push_back(
          fmt::format("/precomputed/g/s{}/0-{}_0-{}_0-{}", level, std::min(size[0], n[0]), std::min(size[1], n[1]), std::min(size[2], n[2])));
  }
  return out;
}

}  // namespace teracell::testing

// A picture in three dimensions of what is not the background: the first visible cell on the line of sight of each pixel, shaded. Exact for the
// level that is drawn. Memory: that of the picture and of the cache of chunks, whatever the grid.
#pragma once
#include <atomic>
#include <functional>

#include "render/camera.hpp"
#include "store/color.hpp"
#include "store/reader.hpp"

namespace teracell {

struct RenderOptions {
  Camera camera;
  std::optional<int> level;         // without it, cells that take at most a quarter of a pixel
  std::array<std::optional<double>, 3> cut;  // what lies at or above this coordinate is cut away
  std::vector<bool> materials;      // shown; empty: all but the background
  Rgba ground{255, 255, 255, 255};  // where nothing is seen
  bool flat = false;                // the materials' colours alone, and one line of sight per pixel
};

// The most pixels of a picture, and along a side.
inline constexpr uint64_t kMostPicturePixels = uint64_t{1} << 26, kLongestPictureSide = 16384;

struct Picture3D {
  PictureSize size;
  std::vector<uint8_t> rgba;  // rows from the top; straight alpha
};

// Throws UsageError for a level that is not there. `progress` is called with the share of the rows that are made; what it throws ends the
// work.
Picture3D render(const GridReader& reader, const RenderOptions& options, int threads, const std::atomic<bool>& stop,
                 const std::function<void(double share)>& progress);

}  // namespace teracell

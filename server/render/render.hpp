// A picture in three dimensions of what is not the background: the first visible cell on the line of sight of each pixel, shaded. Exact for the
// level that is drawn. Memory: that of the picture and of the cache of chunks, whatever the grid.
#pragma once
#include "server/render/caster.hpp"

namespace teracell::server {

struct RenderOptions {
  Aim aim;
  std::vector<bool> shown;          // of each label; empty: all but those of the background
  Rgba ground{255, 255, 255, 255};  // where nothing is seen
  bool flat = false;                // the materials' colours alone, and one line of sight per pixel
  int64_t held = int64_t{1} << 18;  // pixels whose samples are in memory; at least 32 rows are
};

// The most pixels of a picture, and along a side.
inline constexpr uint64_t kMostPicturePixels = uint64_t{1} << 26, kLongestPictureSide = 16384;

struct Picture3D {
  PictureSize size;
  std::vector<uint8_t> rgba;  // rows from the top; straight alpha
};

std::vector<bool> shown_labels(const Metadata& meta, const RenderOptions& options);
// Throws UsageError for a level that is not there. `progress` is called with the share of the rows that are made; what it throws ends the
// work. `prepared` is that of shown_labels() and of the level, or 0.
Picture3D render(const GridReader& reader, const Prepared& prepared, const RenderOptions& options, int threads, const Caster::Progress& progress);
Picture3D render(const GridReader& reader, const RenderOptions& options, int threads, const Caster::Progress& progress);

}  // namespace teracell::server

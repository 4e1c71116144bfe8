// Pictures of slices, made from the store's rows: what the dashboard shows and other viewers' tiles are made of.
#pragma once
#include "server/service.hpp"
#include "store/slice.hpp"

namespace teracell {

inline constexpr int64_t kTilePixels = 512;                   // a side of a tile
inline constexpr uint64_t kMostOutlined = uint64_t{1} << 22;  // pixels of a picture with outlines: it is in memory as numbers

// How a picture shows materials.
struct Look {
  std::vector<bool> shown;  // by material; empty: all. A coarse cell blends the materials of its set that are shown
  bool outline = false;     // boundaries between different sets are dark
};

// The view as PNG, its highest v on top. Throws UsageError for outlines in more than kMostOutlined pixels.
std::string picture_png(const GridReader& reader, const SliceView& view, const Look& look = {});

// The cells of the view as labels, row v0 first: the ids of the strongest materials, as put_labels has them.
std::string raw_labels(const GridReader& reader, const SliceView& view);
// The same with the sets of coarse cells: u32 number of sets; of each, u16 number of materials and their u16 ids; then for
// each cell the number of its set, a byte each when there are at most 256 sets, else two. All little endian.
std::string raw_sets(const GridReader& reader, const SliceView& view);

}  // namespace teracell

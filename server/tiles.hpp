// Pictures of slices, made from the store's rows: what the dashboard shows and other viewers' tiles are made of.
#pragma once
#include "server/service.hpp"
#include "store/slice.hpp"

namespace teracell {

// How a picture shows materials.
struct Look {
  std::vector<bool> shown;  // by material; empty: all. A coarse cell blends the materials of its set that are shown
  bool outline = false;     // boundaries between different sets are dark
};

// The view as PNG, its highest v on top.
std::string picture_png(const GridReader& reader, const SliceView& view, const Look& look = {});

// The cells of the view as labels, row v0 first: the ids of the strongest materials, a byte each, or two (little endian)
// past 256 materials.
std::string raw_labels(const GridReader& reader, const SliceView& view);
// The same with the sets of coarse cells: u32 number of sets; of each, u16 number of materials and their u16 ids; then for
// each cell the number of its set, a byte each when there are at most 256 sets, else two. All little endian.
std::string raw_sets(const GridReader& reader, const SliceView& view);

}  // namespace teracell

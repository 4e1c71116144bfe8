// Slices as pictures and as labels, made from the store's rows. The dashboard and the tiles of other viewers show these.
#pragma once
#include "server/service/service.hpp"
#include "store/read/plane.hpp"

namespace teracell::server {

inline constexpr int64_t kTilePixels = 512;                   // a side of a tile
inline constexpr uint64_t kMostOutlined = uint64_t{1} << 22;  // pixels of a picture with outlines, which is in memory as numbers

// How a picture shows materials.
struct PictureStyle {
  std::vector<bool> shown;  // by material; empty: all. A coarse cell blends the shown materials of its set
  bool outline = false;     // draws boundaries between different sets, dark
  const FractionReader* shares = nullptr;  // if not null, a mixed cell of level 0 blends what it is made of
};

// The view as PNG, the row with the highest v on top. REQUIRES: it has at most kMostOutlined pixels; picture_parts.hpp makes larger ones.
std::string picture_png(const GridReader& reader, const SliceView& view, const PictureStyle& style = {});
// The same of a plane; what lies outside the grid is transparent. REQUIRES: the style has neither outlines nor shares.
std::string picture_png(const GridReader& reader, const PlaneView& view, const PictureStyle& style = {});

// The cells of the view as the ids of their strongest materials, row v0 first, written by put_labels().
std::string raw_labels(const GridReader& reader, const SliceView& view);
// The same with the sets of coarse cells: the number of sets (u32); for each set its number of materials and their ids (u16
// each); then for each cell the number of its set, one byte, or two when there are more than 256 sets. All little endian.
// With `shares`, a mixed cell of level 0 has a list of 16 materials in place of its set: each as often as its share of the cell says, its own
// one first. Where a sheet owns the cell, whose shares don't have it, the cell keeps its set.
// With `damage`, the first set has no members: it stands for what can't be read, which is an error otherwise.
std::string raw_sets(const GridReader& reader, const SliceView& view, const FractionReader* shares = nullptr, bool damage = false);
// The same with labels in place of materials, for grids that keep bodies apart: the number of sets (u16); flags (u16); the sets, whose
// labels have four bytes when there are more than 65536 labels (flag 1), otherwise two; the cells. Where a view has more different sets
// than can be numbered, each label is replaced by the first one of its material (flag 2).
std::string raw_label_sets(const GridReader& reader, const SliceView& view, const FractionReader* shares = nullptr, bool damage = false);
// Both of a plane. The first set has no members: it stands for what lies outside the grid.
std::string raw_sets(const GridReader& reader, const PlaneView& view);
std::string raw_label_sets(const GridReader& reader, const PlaneView& view);

}  // namespace teracell::server

// The rays of a column of chunks, whole, and some rays around it. Bodies of background material are background here.
#pragma once
#include "store/read/reader.hpp"

namespace teracell::inline store {

// A rectangle of rays, half open.
struct RayWindow {
  uint32_t u0, v0, u1, v1;
};

struct Field {
  static constexpr uint32_t kMargin = 12;  // rays around the column; fewer at the sides of the domain
  RayBlock rays;     // whole ones: the sets are labels
  uint32_t u, v;     // of its first ray in the grid
  RayWindow column;  // the rays of the column itself, counted in `rays`
};

// What each label of a file is here: 0 for bodies of background material.
std::vector<Label> labels_here(const Metadata& meta);

// Reads through the reader's keeper. `scratch` is for the reader alone.
void read_field(const GridReader& reader, std::span<const Label> here, uint32_t cu, uint32_t cv, std::shared_ptr<Chunk>& scratch, Field& out);

}  // namespace teracell::store

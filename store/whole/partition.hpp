// Boxes of equal work for the ranks of a parallel program, from exact counts of cells.
#pragma once
#include <functional>
#include <string>

#include "store/read/reader.hpp"

namespace teracell::inline store {

// How the grid is cut. kBlocks: by recursive bisection (M. Berger, S. Bokhari 1987) into boxes that are as compact as can be.
// kSlabs: along the longest axis alone.
enum class PartitionMethod { kBlocks, kSlabs };
const char* name_of(PartitionMethod method);

struct PartitionOptions {
  int64_t ranks = 1;
  PartitionMethod method = PartitionMethod::kBlocks;
  std::vector<double> weights;  // the work of a cell of each material
  int64_t align = 1;            // cuts lie at multiples of so many cells
  int64_t halo = 0;             // cells
};

struct Part {
  Box box;
  double weight = 0;  // the work in it
  Box halo_box;       // the box and the halo around it, clipped to the grid
  std::vector<int64_t> neighbours;  // ranks, ascending: those whose boxes the halo reaches; without a halo, those that share a face
};

struct Partition {
  PartitionOptions options;
  std::vector<std::string> materials;  // of the weights
  Index3 cells{0, 0, 0};               // of the grid
  std::string grid_hash;               // of its content
  double total = 0;                    // work
  std::vector<Part> parts;             // by rank; they cover each cell once
};

// Progress is called with the share that is done, and may throw. Chunks are decoded, cells are never expanded. Throws UsageError when
// there are more ranks than the grid has cells to cut at, and when no cell has any work.
Partition make_partition(const GridReader& reader, const PartitionOptions& options, const std::function<void(double)>& progress);

// A box and the halo around it, clipped to the grid.
Box with_halo(const Box& box, int64_t halo, const Index3& cells);

// {"schema": 1, "ranks", "method", "align", "halo", "weights", "cells", "grid_hash", "total",
//  "parts": [{"rank", "box", "weight", "halo_box", "neighbours"}]}
std::string partition_json(const Partition& partition);
// Throws InputError, with what was expected and found, for any other text, for parts that don't cover the grid once, and for boxes that
// don't fit the halo or the places to cut at.
Partition parse_partition(const std::string& json);

}  // namespace teracell::store

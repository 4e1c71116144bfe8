// Goes through two grids and counts what differs: the part of difference.hpp that writes nothing.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "store/compare/chunk_comparison.hpp"

namespace teracell::inline store {

// The cells that have one material in the first grid and another one in the second.
struct Change {
  std::string from, to;  // names
  unsigned __int128 cells = 0;
  Box box;
};

struct Difference {
  unsigned __int128 cells = 0, same = 0;  // all, and those whose materials have the same name
  std::vector<Change> changes;            // the most cells first; among equals by their names
};

struct DifferenceOptions {
  int threads = 1;
  size_t memory = size_t{256} << 20;  // for runs of the second grid
  size_t most_changes = size_t{1} << 20;  // pairs of materials; a file holds fewer
  std::filesystem::path output;       // a .tcell file with the changes as labels; empty: none
  std::filesystem::path folder;       // for temporary files; empty: that of the output
};

// As find_difference() without an output.
Difference count_difference(const GridReader& a, const GridReader& b, const DifferenceOptions& options, const std::function<void(double)>& progress);

struct CountedChanges {
  Difference difference;
  std::vector<Label> label_of;  // for each number in the frames of FoundChanges: the place of its change in `difference`, and 1; 0 for 0
};
// Calls found() with the changes of blocks of rays, in any order; `with_cells`: their frames, too.
CountedChanges count_changes(const GridReader& a, const GridReader& b, const DifferenceOptions& options, bool with_cells,
                             const std::function<void(const FoundChanges&)>& found, const std::function<void(double)>& progress);

}  // namespace teracell::store

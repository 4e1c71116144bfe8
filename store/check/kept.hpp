// The file that findings are kept in, beside the grid.
#pragma once
#include <filesystem>
#include <string>

#include "store/read/reader.hpp"

namespace teracell::inline store {

// "g.check.json" for "g.tcell".
std::filesystem::path kept_findings(const std::filesystem::path& grid);
// Whether there is a document for the cells of this grid, and it can be read. Reads only its ends, and the index of level 0 of a grid with
// another hash than it was made for.
bool has_kept_findings(const std::filesystem::path& grid, const GridReader& reader);
// The document that is kept for the cells of this grid; empty when there is none, or it is another
// grid's, was changed, or is too large to be one.
std::string read_kept_findings(const std::filesystem::path& grid, const GridReader& reader);

}  // namespace teracell::store

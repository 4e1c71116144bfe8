// The file that findings are kept in, beside the grid.
#pragma once
#include <filesystem>
#include <string>

namespace teracell::inline store {

// "g.check.json" for "g.tcell".
std::filesystem::path kept_findings(const std::filesystem::path& grid);
// Whether there is a document for a grid with this hash. Reads only its ends.
bool has_kept_findings(const std::filesystem::path& grid, const std::string& hash);
// The document that is kept for a grid with this hash; empty when there is none, or it is another
// grid's, was changed, or is too large to be one.
std::string read_kept_findings(const std::filesystem::path& grid, const std::string& hash);

}  // namespace teracell::store

// Findings as the document that is kept beside a grid, and as text for people.
#pragma once
#include <string_view>

#include "store/check/finding.hpp"

namespace teracell::inline store {

// {"schema":1,"grid_hash":..,"cells_hash":..,"findings":[..],"totals":{..},"walls":[..],"not_looked_at":[..],"checksum":".."}, ASCII, on one line.
std::string findings_json(const Findings& findings);
// The hashes of the grid that a document was made for; empty when it is no such document.
struct GridHashes {
  std::string grid, cells;
};
GridHashes hashes_in(std::string_view json);
// The document for a grid with the same cells. REQUIRES: it is whole.
std::string with_grid_hash(const std::string& json, const std::string& hash);
// Whether all of a document is as it was written, by its checksum; and whether its end looks as if it were.
bool is_whole(std::string_view json);
bool ends_as_whole(std::string_view json);
// Lines, without the last line break. At most `most` findings of a kind.
std::string findings_text(const Findings& findings, size_t most);

}  // namespace teracell::store

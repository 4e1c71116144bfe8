// The runs of a column as JSON, made as they are taken.
#pragma once
#include <memory>

#include "server/service/message.hpp"
#include "store/read/query.hpp"

namespace teracell::server {

// What column_json() says of the runs from cell `from` to `to` (half open), in parts. REQUIRES: the part lies in the grid and is not
// empty; `reader` outlives it.
std::unique_ptr<Parts> column_parts(const GridReader& reader, int axis, int64_t a, int64_t b, int64_t from, int64_t to);

}  // namespace teracell::server

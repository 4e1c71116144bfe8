// What a file holds, and what questions about it give, as JSON: the same text for the command line and for the server.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "store/query.hpp"
#include "store/stats.hpp"

namespace teracell {

nlohmann::ordered_json info_json(const GridReader& reader);
nlohmann::ordered_json stats_json(const Metadata& meta, const Box& region, const std::vector<MaterialStats>& stats);
nlohmann::ordered_json column_json(const Metadata& meta, int axis, int64_t a, int64_t b, const std::vector<ColumnRun>& runs);
double bits_per_crossing(const Metadata& meta);  // of level 0; 0 without crossings

}  // namespace teracell

// What a file holds, and what questions about it give, as JSON: the same text for the command line and for the server.
#pragma once
#include <string>
#include <string_view>

#include "store/query.hpp"
#include "store/stats.hpp"

namespace teracell {

// Takes little more memory than the text: the file's report is decoded behind what comes before it. With the key `id` unless
// it is empty.
std::string info_json(const GridReader& reader, std::string_view id = {});
std::string stats_json(const Metadata& meta, const Box& region, const std::vector<MaterialStats>& stats);
std::string column_json(const Metadata& meta, int axis, int64_t a, int64_t b, const std::vector<ColumnRun>& runs);
// How many runs surely fit into a column_json() of so many bytes, apart from what stands around them.
size_t column_runs_in(const Metadata& meta, size_t bytes);
double bits_per_crossing(const Metadata& meta);  // of level 0; 0 without crossings

}  // namespace teracell

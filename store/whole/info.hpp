// What a file holds, and what questions about it give, as JSON: the same text for the command line and for the server.
#pragma once
#include <string>
#include <string_view>

#include "store/compare/difference.hpp"
#include "store/read/line.hpp"
#include "store/read/query.hpp"
#include "store/read/stats.hpp"

namespace teracell::inline store {

// Takes little more memory than the text: the file's report is decoded behind what comes before it. With the key `id` unless
// it is empty.
std::string info_json(const GridReader& reader, std::string_view id = {});
// What read_stats() gives; or, with the list "bodies" beside it, what read_label_stats() gives.
std::string stats_json(const Metadata& meta, const Box& region, const std::vector<CellStats>& stats);
std::string body_stats_json(const Metadata& meta, const Box& region, const std::vector<CellStats>& of_labels);
// {"schema": 1, "cells", "same", "changes": [{"from", "to", "cells", "box"}]}
std::string difference_json(const Difference& difference);
// {"schema": 1, "from", "to", "length", "runs": [{"from", "to", "length", "cells", "material", "name"}]}: lengths from the first point.
std::string line_json(const Metadata& meta, const Vec3& a, const Vec3& b, const std::vector<LineRun>& runs);
std::string column_json(const Metadata& meta, int axis, int64_t a, int64_t b, const std::vector<ColumnRun>& runs);
// The same piece by piece, each appended to a text: begin(), run() for each run, end().
class ColumnJson {
 public:
  // Keeps a reference to `meta`.
  ColumnJson(const Metadata& meta, int axis, int64_t a, int64_t b) : meta_(meta), axis_(axis), a_(a), b_(b) {}
  void begin(std::string& text) const;
  void run(std::string& text, const ColumnRun& run);
  static void end(std::string& text);

 private:
  const Metadata& meta_;
  const int axis_;
  const int64_t a_, b_;
  bool several_ = false;  // a run was written
};
double bits_per_crossing(const Metadata& meta);  // of level 0; 0 without crossings

}  // namespace teracell::store

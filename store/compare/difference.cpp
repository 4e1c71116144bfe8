#include "store/compare/difference.hpp"

#include <set>

#include <fmt/format.h>

#include "store/base/output_file.hpp"
#include "store/compare/difference_file.hpp"
#include "store/compare/equal_cells.hpp"
#include "store/text/color.hpp"
#include "store/text/json_writer.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

// A name is cut where both together would be too long, and then may be that of another change.
std::string name_of(const Change& change, size_t number, std::set<std::string>& names) {
  const std::string arrow = " → ";
  const size_t most = (kMostName - arrow.size()) / 2;
  std::string name = fmt::format("{}{}{}", first_bytes(change.from, most), arrow, first_bytes(change.to, most));
  if (!names.insert(name).second) names.insert(name = fmt::format("change {}", number));
  return name;
}

// The grid of the changes: one material each, of which the one of fewest cells is the strongest, so that it shows.
Metadata metadata_of(const Metadata& a, const std::vector<Change>& changes) {
  Metadata meta;
  meta.units = a.units;
  meta.grid = a.grid;
  meta.ray_axis = a.ray_axis;
  meta.chunk_rays = a.chunk_rays;
  meta.chunk_cells = a.chunk_cells;
  meta.page_chunks = a.page_chunks;
  const auto count = static_cast<uint32_t>(changes.size());
  meta.materials.push_back({"same", "#00000000", count});
  meta.labels.push_back({0, ""});
  std::set<std::string> names;
  for (uint32_t i = 1; i <= count; ++i) {
    meta.materials.push_back({name_of(changes[i - 1], i, names), palette_color(i), count - i});
    meta.labels.push_back({i, ""});
  }
  if (const std::string what = beyond_bounds(meta); !what.empty()) throw InputError("the differences don't fit into a file: " + what);
  return meta;
}

// Laid out as the report of a grid that was meshed: no bodies, and the grids as inputs.
std::string report_of(const GridReader& a, const GridReader& b) {
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).key("bodies").begin_array().end_array().key("warnings").begin_array().end_array();
  out.key("inputs").begin_array();
  for (const GridReader* grid : {&a, &b})
    out.begin_object()
        .field("path", std::filesystem::path(grid->name()).filename().string())  // others need not know the folders of this machine
        .field("format", "tcell")
        .field("bytes", grid->file_bytes())
        .field("hash", grid->hash())
        .end_object();
  out.end_array().end_object();
  return text;
}

}  // namespace

Difference find_difference(const GridReader& a, const GridReader& b, const DifferenceOptions& options,
                           const std::function<void(const char*, double)>& progress) {
  const auto compared = [&](double share) { progress("compare", share); };
  if (options.output.empty()) return count_difference(a, b, options, compared);
  expect_equal_cells(a, b);
  {
    const OutputFile could_be_written(options.output);  // which is better found out now than at the end
  }
  const std::filesystem::path beside = options.output.has_parent_path() ? options.output.parent_path() : ".";
  SpilledChanges spilled(options.folder.empty() ? beside : options.folder, a.meta());
  const auto put = [&](const FoundChanges& found) { spilled.put(found.key.cu, found.key.cv, found.first, found.length, found.frame); };
  CountedChanges counted = count_changes(a, b, options, true, put, compared);
  write_changes(options.output, metadata_of(a.meta(), counted.difference.changes), spilled, counted.label_of, report_of(a, b), options.threads,
                [&](double share) { progress("write", share); });
  return std::move(counted.difference);
}

}  // namespace teracell::store

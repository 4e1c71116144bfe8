#include "store/difference.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "store/chunk_comparison.hpp"
#include "store/color.hpp"
#include "store/difference_file.hpp"
#include "store/equal_cells.hpp"
#include "store/json_writer.hpp"
#include "store/text.hpp"

namespace teracell {
namespace {

// The cells of the changes, by their numbers less 1.
class ChangeSums {
 public:
  explicit ChangeSums(const GridReader& a) : shape_(a.shape(0)), frame_(a.meta().frame()) {}
  void add(const FoundChanges& found) {
    for (const LabelStats& l : found.stats) {
      if (l.label == 0) continue;
      if (sums_.size() < l.label) sums_.resize(l.label);
      Sum& sum = sums_[l.label - 1];
      const std::array<int64_t, 3> first = {int64_t{found.key.cu} * shape_.chunk_rays, int64_t{found.key.cv} * shape_.chunk_rays, found.first};
      const std::array<int, 3> axes = {frame_.u, frame_.v, frame_.w};
      for (size_t i = 0; i < 3; ++i) {
        int64_t &lo = sum.box.lo[axes[i]], &hi = sum.box.hi[axes[i]];
        lo = sum.cells == 0 ? first[i] + l.lo[i] : std::min(lo, first[i] + l.lo[i]);
        hi = std::max(hi, first[i] + l.hi[i]);
      }
      sum.cells += l.cells;
    }
  }
  Change change(size_t i, const MaterialNames& names, const ChangeNumbers::Pair& pair) const {
    return {names[pair.from], names[pair.to], sums_[i].cells, sums_[i].box};
  }

 private:
  struct Sum {
    unsigned __int128 cells = 0;
    Box box;
  };
  const LevelShape shape_;
  const RayFrame frame_;
  std::vector<Sum> sums_;
};

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
        .field("path", grid->name())
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
  expect_equal_cells(a, b);
  const bool with_cells = !options.output.empty();
  std::optional<SpilledChanges> spilled;
  if (with_cells) {
    const OutputFile could_be_written(options.output);  // which is better found out now than at the end
    const std::filesystem::path beside = options.output.has_parent_path() ? options.output.parent_path() : ".";
    spilled.emplace(options.folder.empty() ? beside : options.folder, a.meta());
  }
  const MaterialNames names(a.meta(), b.meta());
  ChangeNumbers numbers(with_cells ? std::min<size_t>(kMostChangeLabels, options.most_changes) : options.most_changes);
  ChangeSums sums(a);
  const GridComparison comparison{a,
                                  b,
                                  names,
                                  numbers,
                                  with_cells,
                                  options.threads,
                                  options.memory,
                                  [&](double share) { progress("compare", share); },
                                  [&](const FoundChanges& found) {
                                    sums.add(found);
                                    if (spilled) spilled->put(found.key.cu, found.key.cv, found.first, found.length, found.frame);
                                  }};
  if (a.meta().ray_axis == b.meta().ray_axis) compare_along(comparison);
  else compare_across(comparison);

  Difference out;
  const Index3 n = a.meta().grid.cells();
  out.cells = static_cast<unsigned __int128>(n[0]) * static_cast<unsigned __int128>(n[1]) * static_cast<unsigned __int128>(n[2]);
  out.same = out.cells;
  std::vector<Change> changes;
  for (size_t i = 0; i < numbers.pairs().size(); ++i) changes.push_back(sums.change(i, names, numbers.pairs()[i]));
  std::vector<uint32_t> order(changes.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](uint32_t i, uint32_t j) {
    const Change &x = changes[i], &y = changes[j];
    return std::tie(y.cells, x.from, x.to) < std::tie(x.cells, y.from, y.to);
  });
  std::vector<Label> label_of(changes.size() + 1);
  for (const uint32_t i : order) {
    out.same -= changes[i].cells;
    out.changes.push_back(std::move(changes[i]));
    label_of[i + 1] = static_cast<Label>(out.changes.size());
  }
  if (with_cells)
    write_changes(options.output, metadata_of(a.meta(), out.changes), *spilled, label_of, report_of(a, b), options.threads,
                  [&](double share) { progress("write", share); });
  return out;
}

}  // namespace teracell

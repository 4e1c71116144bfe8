#include "store/refine/leaf_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/text/json_writer.hpp"

namespace teracell::inline store {

LeafTable::LeafTable(const Metadata& meta, const Refinement& refinement, const LeafCounts& counts)
    : meta_(meta), coarsest_(refinement.coarsest), layers_(refinement.layers) {
  for (const auto& [what, number] : counts) {
    by_material_[{what.first, meta.labels[what.second].material}] += number;
    total_ += number;
  }
}

std::vector<std::string> LeafTable::rows() const {
  size_t width = 8;
  for (const auto& [what, number] : by_material_) width = std::max(width, meta_.materials[what.second].name.size());
  std::vector<std::string> out = {fmt::format("level  {:<{}} {:>20}", "material", width, "leaves")};
  for (const auto& [what, number] : by_material_)
    out.push_back(
        fmt::format("{:>5}  {:<{}} {:>20}", what.first, meta_.materials[what.second].name, width, fmt::format("{}", fmt::group_digits(number))));
  out.push_back(fmt::format("{:>5}  {:<{}} {:>20}", "all", "", width, fmt::format("{}", fmt::group_digits(total_))));
  return out;
}

std::string LeafTable::json() const {
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).field("coarsest", coarsest_).field("layers", layers_).field("total", total_);
  out.key("leaves").begin_array();
  for (const auto& [what, number] : by_material_)
    out.begin_object().field("level", what.first).field("material", meta_.materials[what.second].name).field("leaves", number).end_object();
  out.end_array().end_object();
  return text;
}

}  // namespace teracell::store

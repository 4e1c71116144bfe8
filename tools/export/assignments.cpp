#include "tools/export/assignments.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/read/stats.hpp"
#include "store/text/name_list.hpp"
#include "store/text/words.hpp"

namespace teracell::exports {

double parse_number(const std::string& text, const std::string& option) {
  if (const auto value = number_in<double>(text)) return *value;
  throw UsageError(fmt::format("{}: expected a number, found '{}'", option, text));
}

size_t material_named(const std::vector<MaterialInfo>& materials, const std::string& name, const std::string& option) {
  const auto it = std::ranges::find(materials, name, &MaterialInfo::name);
  if (it != materials.end()) return static_cast<size_t>(it - materials.begin());
  std::vector<std::string> names;
  for (const MaterialInfo& m : materials) names.push_back(m.name);
  throw UsageError(fmt::format("{}: the grid has no material '{}': it has {}", option, name, listed(names)));
}

std::vector<bool> for_each_assignment(const std::vector<MaterialInfo>& materials, const std::string& text, const std::string& option,
                                      const std::function<void(size_t, const std::string&, const std::string&)>& take) {
  std::vector<bool> named(materials.size(), false);
  for (const auto& [name, value] : assignments_in(text, option)) {
    const size_t id = material_named(materials, name, option);
    if (named[id]) throw UsageError(fmt::format("{}: '{}' occurs twice", option, name));
    named[id] = true;
    take(id, name, value);
  }
  return named;
}

void expect_named(const GridReader& reader, int level, const Box& box, const std::vector<bool>& named, const std::string& option) {
  if (std::ranges::count(named, false) == 0) return;  // nothing has to be counted
  Box below = reader.meta().grid.box(0);  // the cells of level 0 that the box covers
  for (int d = 0; d < 3; ++d) below.lo[d] = box.lo[d] << level, below.hi[d] = std::min(below.hi[d], box.hi[d] << level);
  const std::vector<CellStats> stats = read_stats(reader, below);
  for (size_t id = 0; id < named.size(); ++id)
    if (!named[id] && stats[id].cells > 0)
      throw UsageError(fmt::format("{}: expected a number for each material, found none for '{}'", option, reader.meta().materials[id].name));
}

}  // namespace teracell::exports

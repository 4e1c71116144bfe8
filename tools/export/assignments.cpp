#include "tools/export/assignments.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/read/stats.hpp"
#include "store/text/words.hpp"

namespace teracell::exports {

double parse_number(const std::string& text, const std::string& option) {
  if (const auto value = number_in<double>(text)) return *value;
  throw UsageError(fmt::format("{}: expected a number, found '{}'", option, text));
}

size_t material_named(const std::vector<MaterialInfo>& materials, const std::string& name, const std::string& option) {
  const auto it = std::ranges::find(materials, name, &MaterialInfo::name);
  if (it == materials.end()) throw UsageError(fmt::format("{}: the grid has no material '{}'", option, name));
  return static_cast<size_t>(it - materials.begin());
}

std::vector<bool> for_each_assignment(const std::vector<MaterialInfo>& materials, const std::string& text, const std::string& option,
                                      const std::function<void(size_t, const std::string&, const std::string&)>& take) {
  std::vector<std::pair<std::string, std::string>> values;
  for (const std::string_view part : split(text, ',')) {
    const size_t equal = part.rfind('=');
    if (equal == part.npos || equal == 0 || equal + 1 == part.size())
      throw UsageError(fmt::format("{}: expected NAME=VALUE, NAME=VALUE ..., separated by commas, found '{}'", option, part));
    const std::string name(part.substr(0, equal));
    if (std::ranges::count(values, name, &std::pair<std::string, std::string>::first) > 0)
      throw UsageError(fmt::format("{}: '{}' occurs twice", option, name));
    values.emplace_back(name, part.substr(equal + 1));
  }
  std::vector<bool> named(materials.size(), false);
  for (const auto& [name, value] : values) {
    const size_t id = material_named(materials, name, option);
    take(id, name, value);
    named[id] = true;
  }
  return named;
}

void expect_named(const GridReader& reader, int level, const Box& box, const std::vector<bool>& named, const std::string& option) {
  Box below = reader.meta().grid.box(0);  // the cells of level 0 that the box covers
  for (int d = 0; d < 3; ++d) below.lo[d] = box.lo[d] << level, below.hi[d] = std::min(below.hi[d], box.hi[d] << level);
  const std::vector<CellStats> stats = read_stats(reader, below);
  for (size_t id = 0; id < named.size(); ++id)
    if (!named[id] && stats[id].cells > 0)
      throw UsageError(fmt::format("{}: expected a number for each material, found none for '{}'", option, reader.meta().materials[id].name));
}

}  // namespace teracell::exports

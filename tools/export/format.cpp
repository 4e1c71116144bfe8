#include "tools/export/format.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/name_list.hpp"
#include "store/text/words.hpp"
#include "tools/export/assignments.hpp"

namespace teracell::exports {

SetValue Export::number() const {
  if (map.empty()) return strongest_material(reader.meta());
  return [material = strongest_material(reader.meta()), numbers = map](const std::vector<Label>& set) { return numbers[material(set)]; };
}

uint32_t Export::most() const { return map.empty() ? static_cast<uint32_t>(reader.meta().materials.size()) - 1 : std::ranges::max(map); }

std::vector<bool> Export::materials(const std::string& option) const {
  const std::vector<MaterialInfo>& all = reader.meta().materials;
  std::vector<bool> out(all.size(), false);
  for (const std::string& name : names_in(options.at(option), option)) out[material_named(all, name, option)] = true;
  return out;
}

int64_t Export::integer(const std::string& option, int64_t least, int64_t most, int64_t otherwise) const {
  if (!has(option)) return otherwise;
  const std::string& text = options.at(option);
  const auto value = number_in<int64_t>(text);
  if (!value || *value < least || *value > most) throw UsageError(fmt::format("{}: expected {} to {}, found '{}'", option, least, most, text));
  return *value;
}

std::string chosen_names(const std::vector<MaterialInfo>& materials, const std::vector<bool>& chosen) {
  std::vector<std::string> out;
  for (size_t id = 0; id < chosen.size(); ++id)
    if (chosen[id]) out.push_back(materials[id].name);
  return listed(out);
}

}  // namespace teracell::exports

// Values for materials, as people type them: NAME=VALUE,NAME=VALUE ...
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "store/read/reader.hpp"

namespace teracell::exports {

double parse_number(const std::string& text, const std::string& option);  // finite
// The id of a material. Throws UsageError naming `option`.
size_t material_named(const std::vector<MaterialInfo>& materials, const std::string& name, const std::string& option);
// Calls take(material id, name, value) for each of NAME=VALUE,NAME=VALUE ... in this order, and returns which materials were named.
// Throws UsageError naming `option` when a name has no value, occurs twice or is none of a material.
std::vector<bool> for_each_assignment(const std::vector<MaterialInfo>& materials, const std::string& text, const std::string& option,
                                      const std::function<void(size_t, const std::string&, const std::string&)>& take);
// Throws UsageError naming `option` unless all materials with cells in `box` of the level are `named`.
void expect_named(const GridReader& reader, int level, const Box& box, const std::vector<bool>& named, const std::string& option);

}  // namespace teracell::exports

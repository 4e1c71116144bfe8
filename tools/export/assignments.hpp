// Values for materials, as people type them: NAME=VALUE,NAME=VALUE ...
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "store/read/reader.hpp"

namespace teracell::exports {

double parse_number(const std::string& text, const std::string& option);  // finite
// The id of a material. Throws UsageError naming `option`.
size_t material_named(const std::vector<MaterialInfo>& materials, const std::string& name, const std::string& option);
// NAME=VALUE,NAME=VALUE ... in this order. A name may hold equal signs, but no comma.
// Throws UsageError naming `option` when a name has no value or occurs twice.
std::vector<std::pair<std::string, std::string>> parse_assignments(const std::string& text, const std::string& option);
// Throws UsageError naming `option` unless all materials with cells in `box` of the level are `named`.
void expect_named(const GridReader& reader, int level, const Box& box, const std::vector<bool>& named, const std::string& option);

}  // namespace teracell::exports

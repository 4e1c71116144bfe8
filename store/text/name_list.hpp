// Lists of names in options and addresses: NAME,NAME ... and NAME=VALUE,NAME=VALUE ... A name may stand in double quotes, with those inside it
// doubled, and must where it has a comma or a quote, or an equal sign before a value.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace teracell::inline store {

// Throw UsageError that begins with the option, for a name or a value that is missing and for a quote without its end.
std::vector<std::string> names_in(std::string_view list, std::string_view option);
struct Assignment {
  std::string name, value;
};
std::vector<Assignment> assignments_in(std::string_view list, std::string_view option);

// Names as they stand in a list: of many the first ones and "...".
std::string listed(const std::vector<std::string>& names);

}  // namespace teracell::store

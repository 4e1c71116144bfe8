#include "store/remote/sources.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

#include <fmt/format.h>

#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

#define LISTED(name) &name,
constexpr const SourceScheme* kSchemes[] = {TERACELL_SOURCE_SCHEMES(LISTED)};
#undef LISTED

std::string scheme_of(std::string_view address) {
  std::string scheme(address.substr(0, address.find("://")));
  for (char& c : scheme) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return scheme;
}

}  // namespace

bool is_address(std::string_view name) {
  const size_t end = name.find("://");
  if (end == std::string_view::npos || end == 0 || !std::isalpha(static_cast<unsigned char>(name[0]))) return false;
  return std::ranges::all_of(name.substr(0, end), [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '-' || c == '.'; });
}

std::unique_ptr<ByteSource> open_source(const std::string& name, const SourceOptions& options) {
  if (!is_address(name)) return std::make_unique<InputFile>(name);
  const std::string scheme = scheme_of(name);
  const auto found = std::ranges::find(kSchemes, scheme, &SourceScheme::name);
  if (found != std::end(kSchemes)) return (*found)->open(name, options);
  std::vector<std::string_view> known;
  for (const SourceScheme* s : kSchemes) known.push_back(s->name);
  throw UsageError(fmt::format("expected the name of a file, or an address that begins with one of {}, found '{}://'", fmt::join(known, ", "),
                               printable(first_bytes(scheme, 64))));
}

}  // namespace teracell::store

#include "mesher/formats/step_unit.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include <fmt/format.h>

namespace teracell::mesher {
namespace {

constexpr std::string_view kConversion = "CONVERSION_BASED_UNIT('", kContext = "GLOBAL_UNIT_ASSIGNED_CONTEXT((",
                           kInSpace = "GEOMETRIC_REPRESENTATION_CONTEXT(3)";

uint64_t number_at(std::string_view text, size_t at) {
  uint64_t n = 0;
  for (; at < text.size() && text[at] >= '0' && text[at] <= '9' && n < UINT64_MAX / 16; ++at) n = 10 * n + static_cast<uint64_t>(text[at] - '0');
  return n;
}

// Our name for a unit of length; empty for others, such as miles.
std::string unit_of(std::string_view instance) {
  if (const size_t at = instance.find(kConversion); at != std::string_view::npos) {
    std::string name(instance.substr(at + kConversion.size()));
    name = name.substr(0, name.find('\''));
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name == "inch" || name == "in" ? "in" : name == "foot" || name == "ft" || name == "feet" ? "ft" : "";
  }
  for (const auto& [prefix, unit] : {std::pair{"$", "m"}, {".CENTI.", "cm"}, {".MILLI.", "mm"}, {".MICRO.", "um"}, {".NANO.", "nm"}})
    if (instance.find(fmt::format("SI_UNIT({},.METRE.)", prefix)) != std::string_view::npos) return unit;
  return "";
}

}  // namespace

bool StepUnit::feed(std::string_view text) {
  constexpr size_t kMost = 4096;
  for (const char c : text) {
    if (done_) return false;
    const char before = std::exchange(before_, c);
    if (in_ == In::kComment) {
      if (before == '*' && c == '/') in_ = In::kText;
      continue;
    }
    if (in_ == In::kText && before == '/' && c == '*') {
      in_ = In::kComment;
      before_ = 0;  // "/*/" begins one, and does not end it
      if (!instance_.empty()) instance_.pop_back();
      continue;
    }
    if (in_ == In::kText && c == ';') end_instance();
    else if (instance_.size() < kMost && (in_ == In::kQuotes ? c == '\'' || keeps_ : !std::isspace(static_cast<unsigned char>(c)))) instance_ += c;
    if (c != '\'') continue;
    in_ = in_ == In::kQuotes ? In::kText : In::kQuotes;
    keeps_ = instance_.ends_with(kConversion);
  }
  return !done_;
}

void StepUnit::end_instance() {
  constexpr size_t kMostUnits = size_t{1} << 16;
  const std::string i = std::exchange(instance_, {});
  if (!i.starts_with('#')) return;
  if (i.find("LENGTH_UNIT()") != std::string::npos && units_.size() < kMostUnits) units_.emplace(number_at(i, 1), unit_of(i));
  else if (const size_t at = i.find(kContext);
           at != std::string::npos && (context_.empty() || (!in_space_ && i.find(kInSpace) != std::string::npos))) {
    in_space_ = i.find(kInSpace) != std::string::npos;
    context_.clear();
    found_.clear();
    const std::string_view list = std::string_view(i).substr(at, i.find(')', at) - at);
    for (size_t hash = list.find('#'); hash != std::string_view::npos; hash = list.find('#', hash + 1)) context_.push_back(number_at(list, hash + 1));
  } else return;
  for (const uint64_t c : context_)
    if (const auto unit = units_.find(c); unit != units_.end()) found_ = unit->second, done_ = in_space_;
}

}  // namespace teracell::mesher

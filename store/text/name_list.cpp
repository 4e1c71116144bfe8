#include "store/text/name_list.hpp"

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::inline store {
namespace {

// Takes a name off the front of the list, up to the comma, or up to its closing quote.
std::string take_name(std::string_view& list, std::string_view option) {
  std::string name;
  if (!list.starts_with('"')) {
    name = list.substr(0, list.find(','));
    list.remove_prefix(name.size());
    return name;
  }
  const std::string_view whole = list;
  for (;;) {
    list.remove_prefix(1);
    const size_t quote = list.find('"');
    if (quote == list.npos) throw UsageError(fmt::format("{}: expected a closing quote, found {}", option, whole));
    name += list.substr(0, quote);
    list.remove_prefix(quote + 1);
    if (!list.starts_with('"')) return name;
    name += '"';
  }
}

// The front of the list up to the comma that ends its first name; one within double quotes does not.
std::string_view first_word(std::string_view list) {
  const size_t begin = list.find_first_not_of(' ');
  const bool quotes = begin != list.npos && list[begin] == '"';
  bool quoted = false;
  for (size_t i = 0; i < list.size(); ++i) {
    if (list[i] == '"' && quotes) quoted = !quoted;
    if (list[i] == ',' && !quoted) return list.substr(0, i);
  }
  return list;
}

// Calls word(list), which takes one off the front, until nothing is left.
template <class Word>
void for_each_word(std::string_view list, std::string_view option, const char* expected, Word&& word) {
  const std::string_view whole = list;
  for (;;) {
    const std::string_view from_here = list;
    if (!word(list) || (!list.empty() && list.front() != ','))
      throw UsageError(fmt::format("{}: expected {}, separated by commas, a name with a comma in double quotes, found '{}'{}", option, expected,
                                   first_word(from_here), from_here.size() == whole.size() ? "" : fmt::format(" in {}", whole)));
    if (list.empty()) return;
    list.remove_prefix(1);
  }
}

}  // namespace

std::vector<std::string> names_in(std::string_view list, std::string_view option) {
  std::vector<std::string> out;
  for_each_word(list, option, "NAME,NAME ...", [&](std::string_view& rest) { return !out.emplace_back(take_name(rest, option)).empty(); });
  return out;
}

std::vector<Assignment> assignments_in(std::string_view list, std::string_view option) {
  std::vector<Assignment> out;
  for_each_word(list, option, "NAME=VALUE,NAME=VALUE ...", [&](std::string_view& rest) {
    Assignment& one = out.emplace_back();
    const bool quoted = rest.starts_with('"');
    one.name = take_name(rest, option);
    if (quoted) {
      one.value = rest.substr(0, rest.find(','));
      rest.remove_prefix(one.value.size());
      if (!one.value.starts_with('=')) return false;
      one.value.erase(0, 1);
    } else {
      const size_t equal = one.name.rfind('=');
      if (equal == one.name.npos) return false;
      one.value = one.name.substr(equal + 1);
      one.name.resize(equal);
    }
    return !one.name.empty() && !one.value.empty();
  });
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr size_t kEnough = 200;
  std::string out;
  for (const std::string& name : names) {
    if (!out.empty()) out += ", ";
    if (out.size() >= kEnough) return out + "...";
    const bool plain = name.find_first_of(",=\"") == name.npos;
    if (!plain) out += '"';
    for (const char c : name) out.append(c == '"' ? 2 : 1, c);
    if (!plain) out += '"';
  }
  return out;
}

}  // namespace teracell::store

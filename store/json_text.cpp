#include "store/json_text.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/error.hpp"

namespace teracell {
namespace {

constexpr int kDeepest = 64;

// Looked at beforehand: the library's own way, a callback at each value, takes a time that grows with the square of an
// array's length (seconds for 60,000 labels).
int depth_of(const std::string& text) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\') ++i;
    else if (c == '"') quoted = !quoted;
    else if (!quoted && (c == '[' || c == '{')) deepest = std::max(deepest, ++depth);
    else if (!quoted && (c == ']' || c == '}')) --depth;
  }
  return deepest;
}

}  // namespace

nlohmann::ordered_json parse_json(const std::string& text, const std::string& what) {
  if (depth_of(text) > kDeepest) throw FormatError(fmt::format("{}: expected JSON of at most {} levels, found more", what, kDeepest));
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::json::parse_error& e) {
    throw FormatError(fmt::format("{}: expected JSON, found something else at byte {}", what, e.byte));
  }
}

}  // namespace teracell

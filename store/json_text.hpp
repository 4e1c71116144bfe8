// JSON out of a file: a FormatError instead of a library's words, and no nesting that would overflow a stack.
#pragma once
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/error.hpp"

namespace teracell {

// `what` names the text in messages.
inline nlohmann::ordered_json parse_json(const std::string& text, const std::string& what) {
  constexpr int kDeepest = 64;
  using Json = nlohmann::ordered_json;
  try {
    return Json::parse(text, [&](int depth, Json::parse_event_t, Json&) {
      if (depth > kDeepest) throw FormatError(fmt::format("{}: expected JSON of at most {} levels, found more", what, kDeepest));
      return true;
    });
  } catch (const nlohmann::json::parse_error& e) {
    throw FormatError(fmt::format("{}: expected JSON, found something else at byte {}", what, e.byte));
  }
}

}  // namespace teracell

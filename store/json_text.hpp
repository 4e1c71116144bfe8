// JSON out of a file: a FormatError instead of a library's words, and no text that takes more than linear time or stack. And
// JSON for others, whatever bytes are in it.
#pragma once
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace teracell {

// `what` names the text in messages. Of keys that stand twice in an object the first counts.
nlohmann::ordered_json parse_json(const std::string& text, const std::string& what);

// On one line, what is no UTF-8 replaced by U+FFFD: names come from anybody's files. ASCII, as some readers of JSON take
// nothing else (zarr 2.13).
std::string ascii_json(const nlohmann::ordered_json& j);
// The text, what is no UTF-8 in it replaced by U+FFFD.
std::string utf8_of(std::string_view text);

}  // namespace teracell

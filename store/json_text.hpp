// JSON out of a file: a FormatError instead of a library's words, and no text that takes more than linear time or stack.
#pragma once
#include <string>

#include <nlohmann/json.hpp>

namespace teracell {

// `what` names the text in messages. Of keys that stand twice in an object the first counts.
nlohmann::ordered_json parse_json(const std::string& text, const std::string& what);

}  // namespace teracell

// JSON out of a file: a FormatError instead of a library's words, and no nesting that would overflow a stack.
#pragma once
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace teracell {

// `what` names the text in messages.
nlohmann::ordered_json parse_json(const std::string& text, const std::string& what);

}  // namespace teracell

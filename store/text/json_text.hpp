// JSON from files: what is wrong with it is a FormatError, and no text takes more than linear time or much stack. And JSON
// for other programs, whatever bytes its texts hold.
#pragma once
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace teracell::inline store {

// `what` names the text in messages. A document takes some sixty bytes of memory per value, so it has at most
// `most_values`; a report of 100,000 bodies has 4.6 million. No object may have a key twice.
nlohmann::ordered_json parse_json(const std::string& text, const std::string& what, size_t most_values = size_t{1} << 23);

// On one line, with U+FFFD for what is not UTF-8, since names may come from any file. It is ASCII because some readers of
// JSON take nothing else (zarr 2.13).
std::string ascii_json(const nlohmann::ordered_json& j);
// The text, with U+FFFD for what is not UTF-8.
std::string utf8_of(std::string_view text);

}  // namespace teracell::store

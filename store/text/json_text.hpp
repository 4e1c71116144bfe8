// JSON from files: what is wrong with it is a FormatError, and no text takes more than linear time or much stack. And JSON
// for other programs, whatever bytes its texts hold. json_node.hpp reads values from a document.
#pragma once
#include <functional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace teracell::inline store {

using Json = nlohmann::ordered_json;

// A document that is read part by part: the lists that the outermost object has, element by element.
struct JsonParts {
  std::function<void(const std::string& list, size_t i, const Json& element)> take;  // each element is then dropped
  std::string_view within;  // an object in the outermost one of which only the lists are read, element by element, too: "within.list"
};

// `what` names the text in messages, if it is not empty. A document takes some sixty bytes of memory per value, so it has at most
// `most_values` at a time; a report of 100,000 bodies has 4.6 million. No object may have a key twice.
Json parse_json(std::string_view text, const std::string& what, size_t most_values = size_t{1} << 23, const JsonParts& parts = {});

// The place of a member: "bodies[2].scale", "materials[\"odd name\"].color".
std::string json_path(const std::string& parent, std::string_view key);

// On one line, with U+FFFD for what is not UTF-8, since names may come from any file. It is ASCII because some readers of
// JSON take nothing else (zarr 2.13).
std::string ascii_json(const Json& j);

}  // namespace teracell::store

// JSON that is passed on as it is: checked in one pass over the text, in memory that doesn't depend on what it holds.
#pragma once
#include <string>
#include <string_view>

namespace teracell::inline store {

inline constexpr size_t kDeepestJson = 64;
inline constexpr size_t kMostJsonKeys = 65536;  // of one object: as many as there may be materials

// Throws FormatError, naming `what` and the byte, unless the text is one JSON value of ASCII characters alone, at most kDeepestJson
// levels deep, in which no object has a key twice or more than kMostJsonKeys keys, and every number is a finite double.
void check_json(std::string_view text, const std::string& what);

}  // namespace teracell::store

// Texts as messages show them.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace teracell {

// The text with control characters as '?' and what is not UTF-8 as U+FFFD: file names and files from elsewhere may hold
// anything, but a terminal obeys the one and JSON can't carry the other.
std::string printable(std::string_view text);

// "1 chunk", "2 chunks".
std::string plural(uint64_t n, std::string_view thing);

}  // namespace teracell

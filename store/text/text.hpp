// Parts of messages.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace teracell::inline store {

// The text, with U+FFFD for what is not UTF-8.
std::string utf8_of(std::string_view text);

// The text with '?' for control characters and U+FFFD for what is not UTF-8. Names of files, and files from elsewhere, may
// hold anything, but terminals obey control characters and JSON can't hold what is not UTF-8.
std::string printable(std::string_view text);

// The text, of at most kLongestMessage bytes: the middle of a longer one is left out. A damaged file may bring any text into a message.
inline constexpr size_t kLongestMessage = 1024;
std::string shortened(std::string_view text);

// As many characters of a UTF-8 text as fit into `most` bytes.
std::string_view first_bytes(std::string_view utf8, size_t most);

// All digits of it.
std::string whole_text(unsigned __int128 number);

// "1 chunk", "2 chunks".
std::string plural(uint64_t n, std::string_view thing);
// The same with grouped digits: "1,234 chunks". `many`: the plural, where it is more than an "s".
std::string counted(unsigned __int128 n, std::string_view one, std::string_view many = {});

// The candidate with the smallest edit distance to `word` (V. Levenshtein, 1966); empty when there are no candidates.
std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);
// Whether `word` may be a misspelling of `other`: their edit distance is at most half of the longer length.
bool resembles(std::string_view word, std::string_view other);

}  // namespace teracell::store

// JSON lists as text, an item at a time: as a tree 100,000 bodies would take hundreds of megabytes.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace teracell {

// Appends the list of the `count` items that `item(i)` gives, as far as `most` bytes hold them; returns how many they don't.
template <class F>
size_t append_list(std::string& text, size_t count, size_t most, F&& item) {
  const size_t begin = text.size();
  text += '[';
  size_t i = 0;
  for (; i < count; ++i) {
    const std::string one = item(i).dump();
    if (text.size() - begin + one.size() + 2 > most) break;
    if (i > 0) text += ',';
    text += one;
  }
  text += ']';
  return count - i;
}

}  // namespace teracell

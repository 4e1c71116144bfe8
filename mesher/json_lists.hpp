// JSON lists as text, an item at a time: as a tree 100,000 bodies would take hundreds of megabytes.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace teracell {

// Appends the list of the `count` items that `item(i)` gives.
template <class F>
void append_list(std::string& text, size_t count, F&& item) {
  text += '[';
  for (size_t i = 0; i < count; ++i) {
    if (i > 0) text += ',';
    text += item(i).dump();
  }
  text += ']';
}

}  // namespace teracell

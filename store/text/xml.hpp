// Texts in XML.
#pragma once
#include <string>

#include "store/text/text.hpp"

namespace teracell::inline store {

inline std::string xml_text(const std::string& text) {
  std::string out;
  for (const char c : printable(text)) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  return out;
}

}  // namespace teracell::store

#include "store/check/finding.hpp"

#include <fmt/format.h>

namespace teracell::inline store {

std::string grouped(CellCount count) {
  std::string text = fmt::format("{}", count);
  for (auto place = static_cast<ptrdiff_t>(text.size()) - 3; place > 0; place -= 3) text.insert(static_cast<size_t>(place), ",");
  return text;
}

}  // namespace teracell::store

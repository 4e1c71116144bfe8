// Parts that lie under right checksums: a part taken apart and put together again, changed on the way.
#pragma once
#include <string>

#include "store/base/bytes.hpp"

namespace teracell::testing {

struct PartSections {
  std::string head, metadata;  // as texts
  Bytes grid, records, found;
};

PartSections take_apart(const Bytes& part);
Bytes put_together(const PartSections& sections);

}  // namespace teracell::testing

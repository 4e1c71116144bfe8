// What a cache counts.
#pragma once
#include <cstddef>
#include <cstdint>

namespace teracell::inline store {

struct CacheCounts {
  uint64_t hits, misses;  // requests for values that were there, and for values that were not
  size_t bytes, entries, limit;
};

}  // namespace teracell::store

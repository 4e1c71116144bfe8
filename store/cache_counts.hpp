// How a cache fares.
#pragma once
#include <cstddef>
#include <cstdint>

namespace teracell {

struct CacheCounts {
  uint64_t hits, misses;  // of what was asked for: was it there?
  size_t bytes, entries, limit;
};

}  // namespace teracell

// How much memory something takes while it works.
#pragma once
#include <malloc.h>

#include "tests/support/test.hpp"

namespace teracell::testing {

// A line of /proc/self/status, in bytes.
inline int64_t memory_now(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key + ":")) return std::stoll(line.substr(key.size() + 1)) * 1024;
  return 0;
}

// The resident memory at its peak while f() runs, above what there was before.
template <class F>
int64_t peak_memory_of(F&& f) {
  ::malloc_trim(0);  // what earlier work has left would be used first
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins anew
  const int64_t before = memory_now("VmRSS");
  f();
  return memory_now("VmHWM") - before;
}

}  // namespace teracell::testing

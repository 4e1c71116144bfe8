// What one run was like, which only --report has: times, memory, numbers of threads.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "mesher/closing/trust.hpp"

namespace teracell::mesher {

struct RunReport {
  struct Phase {
    const char* name;
    double seconds;
  };
  struct BodyTrust {
    std::string body;
    Trust trust;
  };
  std::vector<BodyTrust> trust;  // of the bodies that were open
  std::vector<Phase> phases;
  uint64_t peak_memory_bytes = 0;
  int threads = 0;
  std::string engine;
  uint64_t exact_decisions = 0, spilled_bytes = 0, resumed_chunks = 0, file_bytes = 0;
  double seconds() const {
    double sum = 0;
    for (const Phase& phase : phases) sum += phase.seconds;
    return sum;
  }
};

}  // namespace teracell::mesher

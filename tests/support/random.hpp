// Numbers drawn for tests. A seed gives the same ones on every run.
#pragma once
#include <random>

namespace teracell::testing {

// Both ends included.
inline int random_int(std::mt19937_64& random, int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(random); }
// In [lo, hi).
inline double random_in(std::mt19937_64& random, double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); }

}  // namespace teracell::testing

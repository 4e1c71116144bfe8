// Tests that try everything try a part of it under a sanitizer, which makes them five to ten times slower: the same code
// runs, and the plain build has tried all.
#pragma once
#include <cstddef>

namespace teracell {

// Tests may have been compiled without one and be linked with libraries that have one.
extern "C" __attribute__((weak)) void __asan_init();
extern "C" __attribute__((weak)) void __tsan_init();
inline const bool kSanitized = __asan_init != nullptr || __tsan_init != nullptr;

// For loops over bits and bytes: odd, so that every bit of a byte has its turn.
inline const size_t kStride = kSanitized ? 11 : 1;
// Of `n` random rounds.
inline size_t rounds(size_t n) { return kSanitized ? (n + 4) / 5 : n; }

}  // namespace teracell

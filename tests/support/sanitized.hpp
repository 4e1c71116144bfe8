// Tests that try everything try a part of it under a sanitizer, which makes them five to ten times slower: the same code
// runs, and the plain build has tried all.
#pragma once
#include <cstddef>

namespace teracell {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
inline constexpr bool kSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool kSanitized = false;
#endif

// For loops over bits and bytes: odd, so that every bit of a byte has its turn.
inline constexpr size_t kStride = kSanitized ? 11 : 1;
// Of `n` random rounds.
constexpr size_t rounds(size_t n) { return kSanitized ? (n + 4) / 5 : n; }

}  // namespace teracell

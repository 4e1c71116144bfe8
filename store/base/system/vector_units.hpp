// Loops over numbers, compiled for each vector unit that a processor may have. Which one runs is found out where the program runs. What a loop
// computes is the same on each: operations round one by one, and none are fused, since the build asks for -ffp-contract=off. Processors other
// than x86 have one unit, which the compiler uses by itself. (Rejected: target_clones, whose choice a test can't force and sanitizers don't bear.)
#pragma once

namespace teracell::inline store {

enum class VectorUnit { kPlain, kAvx2, kAvx512 };

#ifdef __x86_64__
inline VectorUnit best_vector_unit() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return VectorUnit::kAvx512;
  return __builtin_cpu_supports("avx2") ? VectorUnit::kAvx2 : VectorUnit::kPlain;
}

template <class Loop>
[[gnu::target("avx2"), gnu::flatten, gnu::noinline]] void run_on_avx2(const Loop& loop) {
  loop();
}
template <class Loop>
[[gnu::target("avx512f,avx512bw,avx512dq,avx512vl"), gnu::flatten, gnu::noinline]] void run_on_avx512(const Loop& loop) {
  loop();
}
#else
inline VectorUnit best_vector_unit() { return VectorUnit::kPlain; }
#endif

// Tests set it.
inline VectorUnit vector_unit = best_vector_unit();

// Calls loop(), a lambda that is compiled anew for each unit. It and the lambdas that it calls must be marked TERACELL_IN_LINE. Where it writes
// bytes, which may be anything, it should first copy what it has captured, or that is read again for each.
#define TERACELL_IN_LINE __attribute__((always_inline))
template <class Loop>
void on_vector_unit(const Loop& loop) {
#ifdef __x86_64__
  if (vector_unit == VectorUnit::kAvx512) return run_on_avx512(loop);
  if (vector_unit == VectorUnit::kAvx2) return run_on_avx2(loop);
#endif
  loop();
}

}  // namespace teracell::store

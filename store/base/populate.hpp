// Memory for large tables that are about to be filled. Asking the kernel for all pages at once takes two thirds of the time of
// faulting them in one by one, and page faults are a tenth of the time of meshing a small grid.
#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace teracell::inline store {

// A hint: before Linux 5.14 the kernel can't do this, and pages come one by one.
inline void populate(void* memory, size_t bytes) {
#ifdef MADV_POPULATE_WRITE
  constexpr uintptr_t kPage = 4096;
  const uintptr_t first = (reinterpret_cast<uintptr_t>(memory) + kPage - 1) / kPage * kPage,
                  last = (reinterpret_cast<uintptr_t>(memory) + bytes) / kPage * kPage;
  if (last > first) ::madvise(reinterpret_cast<void*>(first), last - first, MADV_POPULATE_WRITE);  // NOLINT(performance-no-int-to-ptr)
#else
  static_cast<void>(memory), static_cast<void>(bytes);
#endif
}

// An allocator for a std::vector that fills all the memory it asks for.
template <class T>
struct Populated : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Populated<U>;
  };
  T* allocate(size_t n) {
    T* const memory = std::allocator<T>::allocate(n);
    if (n * sizeof(T) >= (size_t{1} << 17)) populate(memory, n * sizeof(T));
    return memory;
  }
};

}  // namespace teracell::inline store

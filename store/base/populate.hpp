// Memory for large tables that are about to be filled. Asking the kernel for all pages at once takes two thirds of the time of
// faulting them in one by one, and page faults are a tenth of the time of meshing a small grid.
#pragma once
#include <cstddef>
#include <memory>

#include "store/base/system/system.hpp"

namespace teracell::inline store {

// An allocator for a std::vector that fills all the memory it asks for.
template <class T>
struct Populated : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Populated<U>;
  };
  T* allocate(size_t n) {
    T* const memory = std::allocator<T>::allocate(n);
    if (n * sizeof(T) >= (size_t{1} << 17)) system::populate(memory, n * sizeof(T));
    return memory;
  }
};

}  // namespace teracell::inline store

// Memory for large tables that are about to be filled. Asking the kernel for all pages at once takes two thirds of the time of
// faulting them in one by one, and huge pages take half of that. Page faults were a tenth of the time of meshing a small grid.
#pragma once
#include <cstddef>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "store/base/system/system.hpp"

namespace teracell::inline store {

// Memory from a multiple of a huge page on, rounded up to whole ones. Only what is touched is taken from the system.
struct HugeMemory {
  static void* allocate(size_t bytes) {
    bytes = (bytes + system::kHugePage - 1) / system::kHugePage * system::kHugePage;
    void* const memory = ::operator new(bytes, std::align_val_t(system::kHugePage));
    system::prefer_huge_pages(memory, bytes);
    return memory;
  }
  void operator()(void* memory) const { ::operator delete(memory, std::align_val_t(system::kHugePage)); }  // frees it
};

// An allocator for a std::vector that fills all the memory it asks for.
template <class T>
struct Populated : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Populated<U>;
  };
  T* allocate(size_t n) {
    T* const memory = is_huge(n) ? static_cast<T*>(HugeMemory::allocate(n * sizeof(T))) : std::allocator<T>::allocate(n);
    if (n * sizeof(T) >= kWorthAsking) system::populate(memory, n * sizeof(T));
    return memory;
  }
  void deallocate(T* memory, size_t n) { is_huge(n) ? HugeMemory()(memory) : std::allocator<T>::deallocate(memory, n); }

 private:
  static constexpr size_t kWorthAsking = size_t{1} << 17;
  static bool is_huge(size_t n) { return n * sizeof(T) >= system::kHugePage / 4 * 3; }
};

// An allocator for a std::vector whose new elements are left as they are, because all of them are about to be written.
template <class T>
struct Unfilled : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Unfilled<U>;
  };
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    ::new (static_cast<void*>(at)) U(std::forward<Values>(values)...);
  }
};
template <class T>
using UnfilledVector = std::vector<T, Unfilled<T>>;

}  // namespace teracell::store

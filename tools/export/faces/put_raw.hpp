// Numbers as bytes, in the order of memory: little endian, like every machine this runs on.
#pragma once
#include <type_traits>

#include "store/base/bytes.hpp"

namespace teracell::exports::faces {

template <class T>
void put_raw(Bytes& out, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* const bytes = reinterpret_cast<const uint8_t*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}

}  // namespace teracell::exports::faces

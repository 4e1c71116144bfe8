// The header of a NumPy .npy file, version 1.0, of an array in C order.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "store/base/bytes.hpp"

namespace teracell::inline store {

// `dtype` is as NumPy writes it: "|u1" for bytes, "<u2" for little-endian numbers of two bytes, or a list of named fields in brackets.
// It has at least so many bytes, so that one may take the place of another whose numbers are longer.
inline Bytes npy_header(const std::string& dtype, const std::vector<int64_t>& shape, size_t at_least = 0) {
  std::string dict = "{'descr': " + (dtype.starts_with('[') ? dtype : "'" + dtype + "'") + ", 'fortran_order': False, 'shape': (";
  for (const int64_t n : shape) dict += std::to_string(n) + ", ";
  dict += "), }";
  const size_t unpadded = std::max(at_least, 10 + dict.size() + 1);
  dict.resize(unpadded - 11, ' ');
  dict.append((64 - unpadded % 64) % 64, ' ');
  dict += '\n';
  Bytes out = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
  put_fixed(out, static_cast<uint16_t>(dict.size()));
  out.insert(out.end(), dict.begin(), dict.end());
  return out;
}

}  // namespace teracell::store

// The surface formats. A new one is a file that defines its SurfaceReader, and a line here. A reader that is sure takes the file,
// wherever it stands in the list: no file is of two formats. Of several that may read a file, the first one does. Messages name
// the formats in this order.
#pragma once
#include "mesher/surface/reader.hpp"

// clang-format off
#define TERACELL_SURFACE_READERS(reader) \
  reader(kBinaryStlReader) \
  reader(kAsciiStlReader) \
  reader(kObjReader) \
  reader(kPlyReader) \
  reader(kOffReader) \
  reader(kThreeMfReader) \
  reader(kGltfReader) \
  reader(kStepReader)
// clang-format on

namespace teracell::mesher {

#define DECLARED(name) extern const SurfaceReader name;
#define LISTED(name) &name,

TERACELL_SURFACE_READERS(DECLARED)
inline constexpr const SurfaceReader* kReaders[] = {TERACELL_SURFACE_READERS(LISTED)};

#undef DECLARED
#undef LISTED

}  // namespace teracell::mesher

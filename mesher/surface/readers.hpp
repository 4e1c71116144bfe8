// The surface formats. A new format is a file that defines its reader, a declaration here, and a line in the table.
#pragma once
#include "mesher/surface/reader.hpp"

namespace teracell {

extern const SurfaceReader kPlyReader;
extern const SurfaceReader kBinaryStlReader;
extern const SurfaceReader kAsciiStlReader;
extern const SurfaceReader kObjReader;

// A reader that is sure takes the file, wherever it stands in the table: no file is of two formats. Of several that may read a
// file, the first one does.
inline constexpr const SurfaceReader* kReaders[] = {
    &kPlyReader,
    &kBinaryStlReader,
    &kAsciiStlReader,
    &kObjReader,
};

}  // namespace teracell

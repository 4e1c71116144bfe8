// The surface formats. A new one is a file that defines its reader, and a line in this list and in this table.
#pragma once
#include "mesher/surface/reader.hpp"

namespace teracell {

extern const SurfaceReader kPlyReader;
extern const SurfaceReader kBinaryStlReader;
extern const SurfaceReader kAsciiStlReader;
extern const SurfaceReader kObjReader;

// Those that are sure need no order: no file is of two formats.
inline constexpr const SurfaceReader* kReaders[] = {
    &kPlyReader,
    &kBinaryStlReader,
    &kAsciiStlReader,
    &kObjReader,
};

}  // namespace teracell

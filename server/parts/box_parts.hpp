// The cells of a box as a file for other programs, made as it is taken: the bytes that `teracell export --region` writes.
#pragma once
#include <memory>

#include "server/service/message.hpp"
#include "store/read/reader.hpp"

namespace teracell::server {

// A NumPy array, or a file of VTK: .vti for uniform axes, .vtr for any.
enum class BoxFormat { kNpy, kVti, kVtr };
// REQUIRES: the box lies in the grid and is not empty; for kVti no axis is graded; `reader` outlives it.
std::unique_ptr<Parts> box_parts(const GridReader& reader, const Box& box, BoxFormat format);

}  // namespace teracell::server

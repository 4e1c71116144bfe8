// Compresses a whole text with zlib: answers with gzip, and the chunks of Zarr.
#pragma once
#include <string>
#include <string_view>

namespace teracell {

enum class Wrapping { kZlib, kGzip };
// Of any size, at level 1: labels come in long runs, and higher levels take several times as long to save a few per cent.
std::string deflated(std::string_view bytes, Wrapping wrapping);

}  // namespace teracell

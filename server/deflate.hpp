// zlib's compression of a whole text at once: answers with gzip, the chunks of Zarr.
#pragma once
#include <string>
#include <string_view>

namespace teracell {

enum class Wrapping { kZlib, kGzip };
// At level 1: labels come in long runs, higher levels cost a multiple for a few per cent. Any size.
std::string deflated(std::string_view bytes, Wrapping wrapping);

}  // namespace teracell

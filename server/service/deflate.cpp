#include "server/service/deflate.hpp"

#include <algorithm>
#include <memory>
#include <new>

#include <fmt/format.h>
#include <zlib.h>

#include "store/error.hpp"

namespace teracell {

std::string deflated(std::string_view bytes, Wrapping wrapping) {
  z_stream z{};
  if (deflateInit2(&z, 1, Z_DEFLATED, MAX_WBITS + (wrapping == Wrapping::kGzip ? 16 : 0), 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&z, deflateEnd);
  std::string out(deflateBound(&z, bytes.size()), '\0');
  constexpr size_t kPiece = size_t{1} << 30;  // zlib counts its input and output in 32 bits
  size_t taken = 0, given = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    const size_t in = std::min(kPiece, bytes.size() - taken), room = std::min(kPiece, out.size() - given);
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
    z.avail_in = static_cast<uInt>(in);
    z.next_out = reinterpret_cast<Bytef*>(out.data() + given);
    z.avail_out = static_cast<uInt>(room);
    status = deflate(&z, taken + in == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    taken += in - z.avail_in;
    given += room - z.avail_out;
  }
  if (status != Z_STREAM_END) throw Error(fmt::format("zlib could not compress {} bytes: status {}", bytes.size(), status));
  out.resize(given);
  out.shrink_to_fit();  // caches count the capacity
  return out;
}

}  // namespace teracell

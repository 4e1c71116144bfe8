// libdeflate at level 1 over a file of label bytes, in zlib format, on one core: a PNG of these labels takes at least as long.
// Usage: deflate_peer labels.raw
#include <libdeflate.h>

#include <cstdio>

#include "tools/bench/peers/peer.hpp"

namespace teracell::bench {
namespace {

void run(const Arguments& arguments) {
  const std::string labels = bytes_of(arguments[0]);
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(1);
  std::vector<char> packed(libdeflate_zlib_compress_bound(compressor, labels.size()));  // touched before the clock runs
  const Stopwatch packing;
  const size_t size = libdeflate_zlib_compress(compressor, labels.data(), labels.size(), packed.data(), packed.size());
  const double seconds = packing.seconds();
  libdeflate_free_compressor(compressor);
  std::printf("{\"peer\": \"libdeflate-1\", \"bytes_in\": %zu, \"bytes_out\": %zu, \"seconds\": %.4f}\n", labels.size(), size, seconds);
}

}  // namespace
}  // namespace teracell::bench

int main(int argc, char** argv) { return teracell::bench::peer_main(argc, argv, "deflate_peer labels.raw", 1, 1, teracell::bench::run); }

// libdeflate at level 1 over a file of label bytes, zlib format, one core: what a PNG of those labels costs at least.
// Usage: deflate_peer labels.raw
#include <libdeflate.h>

#include <cstdio>
#include <exception>

#include "tools/peers/mesh_domain.hpp"

namespace teracell::bench {
namespace {

void run(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("can't read " + path);
  const std::vector<char> labels{std::istreambuf_iterator<char>(file), {}};
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(1);
  std::vector<char> packed(libdeflate_zlib_compress_bound(compressor, labels.size()));  // touched before the clock runs
  const Stopwatch packing;
  const size_t size = libdeflate_zlib_compress(compressor, labels.data(), labels.size(), packed.data(), packed.size());
  const double seconds = packing.seconds();
  libdeflate_free_compressor(compressor);
  std::printf("{\"peer\": \"libdeflate-1\", \"bytes_in\": %zu, \"bytes_out\": %zu, \"seconds\": %.4f}\n", labels.size(),
              size, seconds);
}

}  // namespace
}  // namespace teracell::bench

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: deflate_peer labels.raw\n");
    return 2;
  }
  try {
    teracell::bench::run(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "deflate_peer: %s\n", e.what());
    return 1;
  }
}

// What a tile of labels costs as PNG on one core, with the server's encoder and with those that others would take. Prints one line
// of JSON per file and encoder: milliseconds (the median) and bytes.
// Usage: png_peer TILE.npy... (bytes, C order, below 256 materials), as `teracell slice` writes them.
#include <libdeflate.h>
#include <spng.h>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>

#include "server/picture/tile_png.hpp"
#include "tools/bench/peers/peer.hpp"

namespace {
libdeflate_compressor* stb_compressor = libdeflate_alloc_compressor(1);
unsigned char* stb_deflate(unsigned char* data, int size, int* out_size, int) {
  const size_t most = libdeflate_zlib_compress_bound(stb_compressor, static_cast<size_t>(size));
  auto* out = static_cast<unsigned char*>(std::malloc(most));
  *out_size = static_cast<int>(libdeflate_zlib_compress(stb_compressor, data, static_cast<size_t>(size), out, most));
  return out;
}
}  // namespace
#define STBIW_ZLIB_COMPRESS stb_deflate
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>

namespace teracell::bench {
namespace {

struct Tile {
  uint32_t width = 0, height = 0;
  std::vector<uint16_t> numbers;
  std::vector<Rgba> colors;
  uint32_t bits = 8;  // per number, as few as PNG allows
};

Tile load(const std::string& path) {
  const std::string bytes = bytes_of(path);
  if (bytes.size() < 12) throw std::runtime_error(path + ": expected a .npy file, found " + std::to_string(bytes.size()) + " bytes");
  const size_t head = 10 + static_cast<uint8_t>(bytes[8]) + 256u * static_cast<uint8_t>(bytes[9]);
  const std::string dict = bytes.substr(10, head - 10);
  Tile tile;
  const size_t shape = dict.find("'shape': (");
  if (dict.find("|u1") == std::string::npos || shape == std::string::npos ||
      std::sscanf(dict.c_str() + shape, "'shape': (%u, %u", &tile.height, &tile.width) != 2 ||
      bytes.size() != head + size_t{tile.width} * tile.height)
    throw std::runtime_error(path + ": expected an array of u1 with two axes, found something else");
  for (size_t i = head; i < bytes.size(); ++i) tile.numbers.push_back(static_cast<uint8_t>(bytes[i]));
  const uint32_t most = *std::max_element(tile.numbers.begin(), tile.numbers.end()) + 1u;
  for (uint32_t n = 0; n < most; ++n)
    tile.colors.push_back({static_cast<uint8_t>(40 * n), static_cast<uint8_t>(90 * n), 200, static_cast<uint8_t>(n ? 255 : 0)});
  tile.bits = most <= 2 ? 1 : most <= 4 ? 2 : most <= 16 ? 4 : 8;
  return tile;
}

// The bytes of a PNG's data before compression.
void filtered(const Tile& t, uint32_t bits, bool up, std::vector<uint8_t>& out) {
  const size_t length = (size_t{t.width} * bits + 7) / 8;
  out.resize((length + 1) * t.height);
  std::vector<uint8_t> above(length, 0), row(length);
  std::vector<uint16_t> padded(t.width + 8, 0);
  // Four numbers at a time: in x they are 16 bits apart, and the product brings them together above bit 48.
  const uint64_t gather = uint64_t{1} << (48 + 3 * bits) | uint64_t{1} << (32 + 2 * bits) | uint64_t{1} << (16 + bits) | 1;
  for (uint32_t r = 0; r < t.height; ++r) {
    const uint16_t* n = &t.numbers[size_t{r} * t.width];
    if (bits == 8) std::copy_n(n, t.width, row.begin());
    else {
      std::copy_n(n, t.width, padded.begin());
      const auto four = [&](size_t i) {
        uint64_t x;
        std::memcpy(&x, &padded[i], 8);
        return static_cast<uint32_t>(x * gather >> 48);
      };
      for (size_t i = 0, at = 0; at < length; i += 8) {
        const uint32_t word = four(i) << 4 * bits | four(i + 4);
        for (uint32_t b = bits; b-- > 0 && at < length;) row[at++] = static_cast<uint8_t>(word >> 8 * b);
      }
    }
    uint8_t* o = &out[(length + 1) * r];
    *o++ = up ? 2 : 0;
    if (up)
      for (size_t i = 0; i < length; ++i) o[i] = static_cast<uint8_t>(row[i] - above[i]);
    else std::copy(row.begin(), row.end(), o);
    above.swap(row);
  }
}

volatile uint32_t checksum;  // of the data; a PNG needs it

// The bytes of a PNG with so many bytes of compressed data.
size_t png_bytes(const Tile& t, size_t data) { return 8 + 25 + 12 + 3 * t.colors.size() + 12 + 1 + 12 + data + 12; }

size_t with_libdeflate(const Tile& t, uint32_t bits, int level, bool up) {
  static libdeflate_compressor* compressors[3] = {libdeflate_alloc_compressor(0), libdeflate_alloc_compressor(1), libdeflate_alloc_compressor(2)};
  static std::vector<uint8_t> raw;
  filtered(t, bits, up, raw);
  std::string out(libdeflate_zlib_compress_bound(compressors[level], raw.size()), '\0');
  const size_t size = libdeflate_zlib_compress(compressors[level], raw.data(), raw.size(), out.data(), out.size());
  checksum = libdeflate_crc32(0, out.data(), size);
  return png_bytes(t, size);
}

size_t with_zlib_runs(const Tile& t) {
  static std::vector<uint8_t> raw;
  filtered(t, t.bits, true, raw);
  z_stream z{};
  if (deflateInit2(&z, 1, Z_DEFLATED, 15, 9, Z_RLE) != Z_OK) throw std::bad_alloc();
  std::vector<uint8_t> out(deflateBound(&z, raw.size()));
  z.next_in = raw.data(), z.avail_in = static_cast<uInt>(raw.size());
  z.next_out = out.data(), z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  const size_t size = z.total_out;
  deflateEnd(&z);
  checksum = static_cast<uint32_t>(crc32(0, out.data(), static_cast<uInt>(size)));
  return png_bytes(t, size);
}

size_t with_stb(const Tile& t, int channels) {
  static std::vector<uint8_t> pixels;
  pixels.resize(t.numbers.size() * static_cast<size_t>(channels));
  for (size_t i = 0; i < t.numbers.size(); ++i)
    for (int c = 0; c < channels; ++c)
      pixels[i * static_cast<size_t>(channels) + static_cast<size_t>(c)] = t.colors[t.numbers[i]][static_cast<size_t>(c)];
  stbi_write_force_png_filter = 0;
  size_t size = 0;
  stbi_write_png_to_func([](void* sum, void*, int n) { *static_cast<size_t*>(sum) += static_cast<size_t>(n); }, &size, static_cast<int>(t.width),
                         static_cast<int>(t.height), channels, pixels.data(), static_cast<int>(t.width) * channels);
  return size;
}

size_t with_spng(const Tile& t, int level) {
  static std::vector<uint8_t> pixels;
  pixels.assign(t.numbers.begin(), t.numbers.end());
  spng_ctx* context = spng_ctx_new(SPNG_CTX_ENCODER);
  spng_set_option(context, SPNG_ENCODE_TO_BUFFER, 1);
  spng_set_option(context, SPNG_FILTER_CHOICE, SPNG_DISABLE_FILTERING);
  spng_set_option(context, SPNG_IMG_COMPRESSION_LEVEL, level);
  spng_ihdr head{t.width, t.height, 8, SPNG_COLOR_TYPE_INDEXED, 0, 0, 0};
  spng_plte palette{};
  palette.n_entries = static_cast<uint32_t>(t.colors.size());
  for (size_t i = 0; i < t.colors.size(); ++i) palette.entries[i] = {t.colors[i][0], t.colors[i][1], t.colors[i][2], 255};
  spng_set_ihdr(context, &head);
  spng_set_plte(context, &palette);
  if (const int error = spng_encode_image(context, pixels.data(), pixels.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE))
    throw std::runtime_error(spng_strerror(error));
  size_t size = 0;
  int error = 0;
  std::free(spng_get_png_buffer(context, &size, &error));
  spng_ctx_free(context);
  return size;
}

void time(const std::string& file, const std::string& encoder, const std::function<size_t()>& encode) {
  std::vector<double> seconds;
  size_t bytes = encode();
  for (const Stopwatch all; seconds.size() < 15 || all.seconds() < 0.05;) {
    const Stopwatch one;
    bytes = encode();
    seconds.push_back(one.seconds());
  }
  std::nth_element(seconds.begin(), seconds.begin() + static_cast<ptrdiff_t>(seconds.size() / 2), seconds.end());
  std::printf("{\"file\": \"%s\", \"encoder\": \"%s\", \"ms\": %.4f, \"bytes\": %zu}\n", file.c_str(), encoder.c_str(),
              1e3 * seconds[seconds.size() / 2], bytes);
}

void run(const std::string& path) {
  const Tile t = load(path);
  time(path, "teracell", [&] { return server::encode_png(t.width, t.height, t.numbers, t.colors).size(); });
  for (const uint32_t bits : {t.bits, 8u})
    for (const int level : {0, 1, 2})
      for (const bool up : {false, true})
        time(path, "libdeflate-" + std::to_string(level) + (up ? " up" : " none") + (bits == 8 ? " 8 bits" : " fewest bits"),
             [&, b = bits] { return with_libdeflate(t, b, level, up); });
  time(path, "zlib runs, up, fewest bits", [&] { return with_zlib_runs(t); });
  time(path, "stb grey, libdeflate-1", [&] { return with_stb(t, 1); });
  time(path, "stb RGB, libdeflate-1", [&] { return with_stb(t, 3); });
  time(path, "libspng-1 8 bits", [&] { return with_spng(t, 1); });
  time(path, "libspng-6 8 bits", [&] { return with_spng(t, 6); });
}

}  // namespace
}  // namespace teracell::bench

int main(int argc, char** argv) {
  return teracell::bench::peer_main(argc, argv, "png_peer TILE.npy...", 1, ~size_t{0}, [](const auto& files) {
    for (const std::string& file : files) teracell::bench::run(file);
  });
}

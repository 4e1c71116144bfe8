#include "server/render/encode.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <new>

#include <zlib.h>

namespace {

// stb's own compressor makes files twice as large.
unsigned char* compress_with_zlib(unsigned char* data, int size, int* compressed, int) {
  uLongf room = compressBound(static_cast<uLong>(size));
  auto* const out = static_cast<unsigned char*>(std::malloc(room));
  if (out && compress2(out, &room, data, static_cast<uLong>(size), 6) == Z_OK) {
    *compressed = static_cast<int>(room);
    return out;
  }
  std::free(out);
  return nullptr;
}

}  // namespace

#define STBIW_ZLIB_COMPRESS compress_with_zlib
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace teracell::server {
namespace {

void append(void* out, void* data, int size) { static_cast<std::string*>(out)->append(static_cast<const char*>(data), static_cast<size_t>(size)); }

std::vector<uint8_t> on_white(const std::vector<uint8_t>& rgba) {
  std::vector<uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (size_t i = 0; i < rgba.size(); i += 4)
    for (size_t c = 0; c < 3; ++c) rgb.push_back(static_cast<uint8_t>((rgba[i + c] * rgba[i + 3] + 255 * (255 - rgba[i + 3]) + 127) / 255));
  return rgb;
}

}  // namespace

std::string_view picture_format(std::string_view name) {
  const auto ends_with = [&](std::string_view ending) {  // in upper or lower case
    return name.size() >= ending.size() && std::ranges::equal(name.substr(name.size() - ending.size()), ending,
                                                              [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
  };
  if (ends_with(".png")) return "png";
  return ends_with(".jpg") || ends_with(".jpeg") ? "jpg" : "";
}

std::string encode_picture(const Picture3D& picture, std::string_view format) {
  std::string out;
  const auto width = static_cast<int>(picture.size.width), height = static_cast<int>(picture.size.height);
  const int done = format == "png" ? stbi_write_png_to_func(append, &out, width, height, 4, picture.rgba.data(), 4 * width)
                                   : stbi_write_jpg_to_func(append, &out, width, height, 3, on_white(picture.rgba).data(), 92);
  if (!done) throw std::bad_alloc();
  return out;
}

}  // namespace teracell::server

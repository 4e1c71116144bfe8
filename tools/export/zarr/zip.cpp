#include "tools/export/zarr/zip.hpp"

#include <zlib.h>

namespace teracell::exports::zarr {
namespace {

constexpr uint16_t kVersion = 45, kUnix = 3 << 8;  // 4.5 has 64-bit sizes
constexpr uint32_t kIn64 = 0xffffffff;             // stands for a number that follows with 64 bits
constexpr uint32_t kMode = 0100644u << 16;         // a regular file

// What the header of a file and its entry in the directory share. `extra` is the size of the field with the 64-bit numbers.
void put_file(Bytes& out, uint32_t crc, size_t name, uint16_t extra) {
  put_fixed(out, kVersion);
  put_fixed(out, uint32_t{0});     // no flags; stored
  put_fixed(out, uint32_t{0x21} << 16);  // 00:00 of 1 January 1980
  put_fixed(out, crc);
  put_fixed(out, kIn64);
  put_fixed(out, kIn64);
  put_fixed(out, static_cast<uint16_t>(name));
  put_fixed(out, extra);
}

void put_extra(Bytes& out, std::initializer_list<uint64_t> numbers) {
  put_fixed(out, uint16_t{1});
  put_fixed(out, static_cast<uint16_t>(8 * numbers.size()));
  for (const uint64_t number : numbers) put_fixed(out, number);
}

}  // namespace

void Zip::write(const std::string& name, std::span<const uint8_t> bytes) {
  const uint64_t place = file_.size(), size = bytes.size();
  const auto crc = static_cast<uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
  Bytes header;
  put_fixed(header, uint32_t{0x04034b50});
  put_file(header, crc, name.size(), 20);
  header.insert(header.end(), name.begin(), name.end());
  put_extra(header, {size, size});
  file_.append(header);
  file_.append(bytes);

  put_fixed(directory_, uint32_t{0x02014b50});
  put_fixed(directory_, static_cast<uint16_t>(kVersion | kUnix));
  put_file(directory_, crc, name.size(), 28);
  put_fixed(directory_, uint16_t{0});  // no comment
  put_fixed(directory_, uint32_t{0});  // on the first disk; binary
  put_fixed(directory_, kMode);
  put_fixed(directory_, kIn64);
  directory_.insert(directory_.end(), name.begin(), name.end());
  put_extra(directory_, {size, size, place});
  ++files_;
}

void Zip::commit(const std::string& comment) {
  const uint64_t directory = file_.size(), end = directory + directory_.size();
  file_.append(directory_);
  Bytes out;
  put_fixed(out, uint32_t{0x06064b50});
  put_fixed(out, uint64_t{44});  // bytes of this record from here on
  put_fixed(out, static_cast<uint16_t>(kVersion | kUnix));
  put_fixed(out, kVersion);
  put_fixed(out, uint64_t{0});  // the first and only disk
  for (const uint64_t number : {files_, files_, uint64_t{directory_.size()}, directory}) put_fixed(out, number);
  put_fixed(out, uint32_t{0x07064b50});
  put_fixed(out, uint32_t{0});
  put_fixed(out, end);
  put_fixed(out, uint32_t{1});
  put_fixed(out, uint32_t{0x06054b50});
  put_fixed(out, uint32_t{0});
  for (int i = 0; i < 3; ++i) put_fixed(out, kIn64);  // two counts of 16 bits, then size and place of the directory
  put_fixed(out, static_cast<uint16_t>(comment.size()));
  out.insert(out.end(), comment.begin(), comment.end());
  file_.append(out);
  file_.commit();
}

}  // namespace teracell::exports::zarr

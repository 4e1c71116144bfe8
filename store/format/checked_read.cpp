#include "store/format/checked_read.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace teracell::inline store {

void check_inside(const ByteSource& source, const DirectoryEntry& place, const std::string& what) {
  if (place.size > source.size() || place.offset > source.size() - place.size)
    throw FormatError(
        fmt::format("{}: its {} bytes at {} lie outside the file of {} (FORMAT.md 2.2)", what, place.size, place.offset, source.size()));
}

void check_sum(const DirectoryEntry& place, const std::string& what, uint64_t found) {
  if (found != place.checksum)
    throw FormatError(fmt::format("{} at byte {}: expected checksum {:016x}, found {:016x}: the file is damaged (FORMAT.md 2.3)", what, place.offset,
                                  place.checksum, found));
}

void read_checked(const ByteSource& source, const DirectoryEntry& place, const std::string& what, Bytes& out) {
  check_inside(source, place, what);
  // A host may say that its file has any size. No part that FORMAT.md allows has a frame of so many bytes.
  if (source.is_far() && place.size > uint64_t{1} << 29)
    throw FormatError(fmt::format("{}: {} bytes are more than it can need (FORMAT.md 3.1)", what, place.size));
  out.resize(place.size);
  source.read(place.offset, out);
  check_sum(place, what, checksum(out));
}

void read_in_pieces(const ByteSource& source, uint64_t offset, uint64_t size, const std::function<void(std::span<const uint8_t>)>& f) {
  Bytes bytes;
  for (uint64_t done = 0; done < size; done += bytes.size()) {
    bytes.resize(std::min<uint64_t>(size - done, 1 << 20));
    source.read(offset + done, bytes);
    f(bytes);
  }
}

}  // namespace teracell::store

// The bytes at a place that another part of a file names, held against the checksum that stands beside it.
#pragma once
#include <functional>

#include "store/base/file.hpp"
#include "store/format/format.hpp"

namespace teracell::inline store {

// These throw FormatError; `what` names the part in messages.
void check_inside(const ByteSource& source, const DirectoryEntry& place, const std::string& what);
void check_sum(const DirectoryEntry& place, const std::string& what, uint64_t found);
void read_checked(const ByteSource& source, const DirectoryEntry& place, const std::string& what, Bytes& out);

// Calls f with the bytes from `offset` on, a mebibyte at a time: for parts of any size.
void read_in_pieces(const ByteSource& source, uint64_t offset, uint64_t size, const std::function<void(std::span<const uint8_t>)>& f);

}  // namespace teracell::store

// Forged files of at most 64 kB, all with right checksums: the worst that a hand could think of, and random ones.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "store/base/bytes.hpp"

namespace teracell::testing {

inline constexpr size_t kForgedBytes = 64'000;  // of the largest file

struct ForgedFile {
  std::string name;
  Bytes bytes;
};

size_t hand_made_files();
std::string hand_made_name(size_t number);
// The same for the same number. None when it comes out larger than kForgedBytes.
std::optional<ForgedFile> hand_made_file(size_t number);
std::optional<ForgedFile> random_file(uint64_t seed);

}  // namespace teracell::testing

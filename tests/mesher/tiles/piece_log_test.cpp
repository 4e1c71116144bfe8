// Pieces of bytes come back as they were added, from memory and from a file.
#include "mesher/tiles/piece_log.hpp"

#include <unistd.h>

#include <random>

#include "store/base/error.hpp"
#include "tests/support/disk.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

struct Kept {
  std::vector<uint8_t> bytes;
  PieceLog::Piece piece;
};

// Bytes that no other number gives, and no other stretch of them.
std::vector<uint8_t> pattern(uint32_t number, size_t count) {
  std::mt19937 next(number);
  std::vector<uint8_t> out(count);
  for (uint8_t& byte : out) byte = static_cast<uint8_t>(next() >> 8);
  return out;
}

std::vector<Kept> keep_pieces(PieceLog& log, uint32_t first, const std::vector<size_t>& sizes) {
  std::vector<Kept> out;
  for (const size_t size : sizes) {
    out.push_back({pattern(first++, size), {}});
    out.back().piece = log.add(out.back().bytes);
  }
  return out;
}

void check_pieces(const PieceLog& log, const std::vector<Kept>& pieces) {
  std::vector<uint8_t> room;
  for (const Kept& k : pieces) REQUIRE(std::ranges::equal(log.read(k.piece, room), k.bytes));
}

// Around a block of a file where there is little memory.
const std::vector<size_t> kSizes = {1, 40, 65535, 65536, 65537, 3, PieceLog::kMostOfPiece, 17, PieceLog::kMostOfPiece - 1};

TEST_CASE("Pieces come back as they were added, also those that were added after others were read") {
  const TempFolder folder;
  const auto [budget, in_memory, own_writer] =
      GENERATE(table<uint64_t, bool, bool>({{1, true, true}, {1, false, false}, {1, false, true}, {100'000'000, false, true}}));
  PieceLog log({.bytes = budget, .folder = in_memory ? folder / "none" : folder.path()}, 0, in_memory, own_writer);
  CHECK(log.in_memory() == in_memory);
  std::vector<Kept> all;
  uint64_t bytes = 0;
  for (uint32_t round = 0; round < 3; ++round) {
    for (Kept& k : keep_pieces(log, 100 * round, kSizes)) bytes += k.bytes.size(), all.push_back(std::move(k));
    log.finish();
    check_pieces(log, all);
  }
  for (uint32_t k = 0; k < 17; ++k) {  // more than a block in memory
    all.push_back(keep_pieces(log, 1000 + k, {PieceLog::kMostOfPiece - k}).front());
    bytes += PieceLog::kMostOfPiece - k;
  }
  log.finish();
  check_pieces(log, all);
  CHECK(log.bytes() == bytes);
}

TEST_CASE("A byte of the file that changed is an error, whoever wrote it") {
  const TempFolder folder;
  const bool own_writer = GENERATE(false, true);
  PieceLog log({.bytes = 1, .folder = folder.path()}, 0, false, own_writer);
  const std::vector<Kept> pieces = keep_pieces(log, 1, {100'000, 100'000, 100'000});
  log.finish();
  const int fd = temporary_file(folder);
  for (size_t i = 0; i < pieces.size(); ++i)
    for (const uint64_t at : {pieces[i].piece.offset, pieces[i].piece.offset + 99'999}) {
      const uint8_t changed = static_cast<uint8_t>(pieces[i].bytes[at - pieces[i].piece.offset] ^ 1);
      REQUIRE(::pwrite(fd, &changed, 1, static_cast<off_t>(at)) == 1);
      std::vector<uint8_t> room;
      for (size_t k = 0; k < pieces.size(); ++k)
        if (k == i) REQUIRE_THROWS_AS(log.read(pieces[k].piece, room), IoError);
        else REQUIRE(std::ranges::equal(log.read(pieces[k].piece, room), pieces[k].bytes));
      REQUIRE(::pwrite(fd, &pieces[i].bytes[at - pieces[i].piece.offset], 1, static_cast<off_t>(at)) == 1);
    }
}

TEST_CASE("A disk that is full is an error of a later piece, or of the end") {
  const TempFolder folder;
  const bool own_writer = GENERATE(false, true);
  const auto fill = [&](uint32_t count) {
    PieceLog log({.bytes = 1, .folder = folder.path()}, 0, false, own_writer);
    const FileSizeLimit full(200'000);
    for (uint32_t k = 0; k < count; ++k) keep_pieces(log, k, {50'000});
    log.finish();
  };
  CHECK_NOTHROW(fill(3));
  for (const uint32_t count : {5U, 40U}) CHECK_THROWS_WITH(fill(count), Catch::Contains(folder.path().string()) && Catch::Contains("temporary file"));
}

TEST_CASE("A folder without room is an error before a piece is added, and none is needed for pieces in memory") {
  const TempFolder folder;
  CHECK_THROWS_WITH(PieceLog({.bytes = 1 << 20, .folder = folder.path()}, ~uint64_t{0}, false, true), Catch::Contains(folder.path().string()));
  CHECK_NOTHROW(PieceLog({.bytes = 1 << 20, .folder = folder / "none"}, ~uint64_t{0}, true, true));
}

}  // namespace
}  // namespace teracell::mesher

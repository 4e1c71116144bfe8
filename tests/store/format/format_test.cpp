// Header, footer, directory and page: to bytes and back, damaged, and with numbers that lie.
#include "store/format/format.hpp"

#include <fmt/format.h>

#include "tests/support/stored.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;

Bytes prefix(const Bytes& bytes, size_t n) { return {bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(n)}; }

// Calls f with every proper prefix; each must be refused. A fresh buffer each time, so that ASan sees.
template <class F>
void expect_every_truncation_refused(const Bytes& bytes, F&& f) {
  for (size_t n = 0; n < bytes.size(); ++n) {
    INFO(n << " of " << bytes.size() << " bytes");
    REQUIRE_THROWS_AS(f(prefix(bytes, n)), FormatError);
  }
}

template <class F>
void expect_every_flip_refused(const Bytes& bytes, F&& f) {
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    Bytes damaged = bytes;
    damaged[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    INFO("bit " << bit);
    REQUIRE_THROWS_AS(f(damaged), FormatError);
  }
}

// Puts the right checksum behind the first `covered` bytes.
Bytes signed_again(Bytes bytes, size_t covered) {
  Bytes sum;
  put_fixed(sum, checksum(std::span(bytes).first(covered)));
  std::ranges::copy(sum, bytes.begin() + static_cast<ptrdiff_t>(covered));
  return bytes;
}

// ---- header and footer ----------------------------------------------------------------------------------------------

TEST_CASE("The header is 32 bytes that check_header takes") {
  REQUIRE(encode_header().size() == kHeaderBytes);
  REQUIRE_NOTHROW(check_header(encode_header()));
}

TEST_CASE("A header cut short or with any bit flipped is refused") {
  expect_every_truncation_refused(encode_header(), check_header);
  expect_every_flip_refused(encode_header(), check_header);
}

TEST_CASE("A newer minor version and the major one before are read, other ones are refused and named") {
  Bytes minor = encode_header(), major = encode_header();
  minor[18] = 0xFF, minor[19] = 0xFF;
  REQUIRE(check_header(signed_again(minor, 24)) == std::pair<uint16_t, uint16_t>(3, 0xFFFF));
  major[16] = 2;
  REQUIRE(check_header(signed_again(major, 24)) == std::pair<uint16_t, uint16_t>(2, kFormatMinor));
  major[16] = 4;
  REQUIRE_THROWS_WITH(check_header(signed_again(major, 24)), Catch::Contains(fmt::format("4.{}", kFormatMinor)) && Catch::Contains("newer"));
  major[16] = 1;
  REQUIRE_THROWS_WITH(check_header(signed_again(major, 24)), Catch::Contains(fmt::format("1.{}", kFormatMinor)) && Catch::Contains("older"));
}

TEST_CASE("Reserved bits of the header are refused one by one") {
  for (size_t bit = 0; bit < 32; ++bit) {
    Bytes header = encode_header();
    header[20 + bit / 8] |= static_cast<uint8_t>(1u << bit % 8);
    REQUIRE_THROWS_WITH(check_header(signed_again(header, 24)), Catch::Contains("reserved"));
  }
}

Footer some_footer() {
  Footer footer;
  footer.file_bytes = 0x0123456789ABCDEF;
  footer.metadata = {~uint64_t{0}, 1, 2};
  footer.report = {3, uint64_t{1} << 63, 4};
  for (uint8_t i = 0; i < 16; ++i) footer.hash[i] = static_cast<uint8_t>(0xF0 + i);
  return footer;
}

TEST_CASE("A footer comes back as it was") {
  const Footer footer = some_footer(), back = decode_footer(encode_footer(footer));
  REQUIRE(encode_footer(footer).size() == kFooterBytes);
  REQUIRE(back.file_bytes == footer.file_bytes);
  REQUIRE(back.hash == footer.hash);
  const auto same = [](const DirectoryEntry& a, const DirectoryEntry& b) {
    return a.offset == b.offset && a.size == b.size && a.checksum == b.checksum;
  };
  REQUIRE(same(back.metadata, footer.metadata));
  REQUIRE(same(back.report, footer.report));
}

TEST_CASE("A footer cut short, too long or with any bit flipped is refused") {
  const Bytes footer = encode_footer(some_footer());
  expect_every_truncation_refused(footer, decode_footer);
  expect_every_flip_refused(footer, decode_footer);
  Bytes longer = footer;
  longer.insert(longer.begin(), 0);
  REQUIRE_THROWS_AS(decode_footer(longer), FormatError);
}

TEST_CASE("Reserved bytes of the footer are refused one by one") {
  for (size_t i = 80; i < 112; ++i) {
    Bytes footer = encode_footer(some_footer());
    footer[i] = 1;
    REQUIRE_THROWS_WITH(decode_footer(signed_again(footer, 112)), Catch::Contains("reserved"));
  }
}

// ---- directory ------------------------------------------------------------------------------------------------------

TEST_CASE("Directory entries are found in the block that their number says") {
  for (const uint64_t count : {1, 2, 169, 170, 171, 340, 1000}) {
    std::vector<DirectoryEntry> entries;
    for (uint64_t i = 0; i < count; ++i) entries.push_back({i * 1'000'003, i + 1, ~i});
    const Bytes frame = encode_directory(entries);
    REQUIRE(frame.size() == directory_bytes(count));
    REQUIRE_NOTHROW(check_directory_frame(prefix(frame, 8), count));
    REQUIRE_THROWS_AS(check_directory_frame(prefix(frame, 8), count + 1), FormatError);
    for (uint64_t i = 0; i < count; ++i) {
      const BlockPlace place = directory_block(i / kBlockEntries, count);
      const auto first = frame.begin() + static_cast<ptrdiff_t>(place.offset);
      const auto block = decode_directory_block(Bytes(first, first + static_cast<ptrdiff_t>(place.bytes())));
      REQUIRE(block.size() == place.entries);
      const DirectoryEntry& e = block[i % kBlockEntries];
      REQUIRE((e.offset == i * 1'000'003 && e.size == i + 1 && e.checksum == ~i));
    }
  }
}

TEST_CASE("A directory block cut short or with any bit flipped is refused") {
  const Bytes frame = encode_directory({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}});
  const Bytes block(frame.begin() + 8, frame.end());
  expect_every_truncation_refused(block, decode_directory_block);
  expect_every_flip_refused(block, decode_directory_block);
  expect_every_truncation_refused(prefix(frame, 8), [](const Bytes& b) { check_directory_frame(b, 3); });
  expect_every_flip_refused(prefix(frame, 8), [](const Bytes& b) { check_directory_frame(b, 3); });
}

// ---- page -----------------------------------------------------------------------------------------------------------

std::vector<ChunkEntry> some_entries(bool with_stats) {
  std::vector<ChunkEntry> entries(5);
  entries[0] = {1'000'000, 10, 0xDEADBEEF, {}, {}};
  entries[1].uniform = {3};
  entries[2] = {1'000'010, 0xFFFFFFFF, ~uint64_t{0}, {}, {}};
  entries[3].uniform = {0};
  entries[4] = {32, 1, 0, {}, {}};
  if (!with_stats) entries[1].uniform = {0, 1, 3}, entries[3].uniform = {2, 3};
  if (with_stats) {
    entries[0].stats = {{0, 7, {0, 0, 0}, {1, 1, 7}}, {2, uint64_t{1} << 47, {1, 2, 3}, {64, 64, 0x7FFFFFFE}}};
    entries[2].stats = {{3, 1, {5, 5, 5}, {6, 6, 6}}};
    entries[4].stats = {{1, 1, {0, 0, 0}, {1, 1, 1}}, {3, 2, {0, 0, 0}, {1, 1, 2}}};
  }
  return entries;
}

TEST_CASE("A page comes back as it was, with statistics and without") {
  for (const bool with_stats : {true, false}) {
    const auto entries = some_entries(with_stats);
    REQUIRE(decode_page(encode_page(entries, with_stats), 5, with_stats, 4) == entries);
  }
  const std::vector<ChunkEntry> uniform(4096, {0, 0, 0, {1}, {}});
  REQUIRE(decode_page(encode_page(uniform, true), 4096, true, 2) == uniform);
}

TEST_CASE("A page cut short is refused; with a bit flipped it is refused or keeps its shape") {
  for (const bool with_stats : {true, false}) {
    const Bytes frame = encode_page(some_entries(with_stats), with_stats);
    expect_every_truncation_refused(frame, [&](const Bytes& b) { decode_page(b, 5, with_stats, 4); });
    const std::string body = decode_text(frame, "page");
    for (size_t n = 0; n < body.size(); ++n) REQUIRE_THROWS_AS(decode_page(encode_text(body.substr(0, n)), 5, with_stats, 4), FormatError);
    REQUIRE_THROWS_AS(decode_page(encode_text(body + '\0'), 5, with_stats, 4), FormatError);
    const auto expect_shape = [&](const Bytes& damaged) {
      try {
        for (const ChunkEntry& e : decode_page(damaged, 5, with_stats, 4)) {
          bool sound = e.size != 0 ? e.uniform.empty() && e.stats.empty() != with_stats : !e.uniform.empty();
          for (size_t i = 0; i < e.uniform.size(); ++i) sound &= e.uniform[i] < 4 && (i == 0 || e.uniform[i] > e.uniform[i - 1]);
          for (const LabelStats& s : e.stats) sound &= s.label < 4;
          if (!sound) FAIL("a page without shape");
        }
      } catch (const FormatError&) {
      }
    };
    for (size_t bit = 0; bit < 8 * frame.size(); ++bit) {
      Bytes damaged = frame;
      damaged[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
      expect_shape(damaged);
    }
    for (size_t bit = 0; bit < 8 * body.size(); ++bit) {
      std::string damaged = body;
      damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
      expect_shape(encode_text(damaged));
    }
  }
}

TEST_CASE("A page read with another number of chunks, or of labels, is refused") {
  const auto entries = some_entries(true);
  const Bytes frame = encode_page(entries, true);
  for (const size_t chunks : {1, 4, 6, 4096}) REQUIRE_THROWS_AS(decode_page(frame, chunks, true, 4), FormatError);
  REQUIRE_THROWS_AS(decode_page(frame, 5, false, 4), FormatError);
  REQUIRE_THROWS_AS(decode_page(frame, 5, true, 3), FormatError);  // label 3 is not there
}

}  // namespace
}  // namespace teracell

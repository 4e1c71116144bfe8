// Header, footer, directory, page and metadata: to bytes and back, damaged, and with numbers that lie.
#include "store/format.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/support/sanitized.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;
using nlohmann::ordered_json;

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

TEST_CASE("A newer minor version is read, a newer major one is refused and named") {
  Bytes minor = encode_header(), major = encode_header();
  minor[18] = 0xFF, minor[19] = 0xFF;
  REQUIRE(check_header(signed_again(minor, 24)) == 0xFFFF);
  major[16] = 2;
  REQUIRE_THROWS_WITH(check_header(signed_again(major, 24)), Catch::Contains("2.0") && Catch::Contains("newer"));
  major[16] = 0;
  REQUIRE_THROWS_WITH(check_header(signed_again(major, 24)), Catch::Contains("0.0"));
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
  const auto same = [](const DirectoryEntry& a, const DirectoryEntry& b) { return a.offset == b.offset && a.size == b.size && a.checksum == b.checksum; };
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
    for (size_t n = 0; n < body.size(); ++n)
      REQUIRE_THROWS_AS(decode_page(encode_text(body.substr(0, n)), 5, with_stats, 4), FormatError);
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

// ---- metadata -------------------------------------------------------------------------------------------------------

Metadata some_metadata() {
  Metadata meta;
  meta.units = "µm";
  meta.grid = {{Axis::uniform(-0.1, 0.30000000000000004, int64_t{1} << 40, Axis::kMaxCells, 0.25), Axis::graded({0, 0.1, 0.7, 1e74}, 0.5),
                Axis::uniform(0, 1e-74, 0, 17, 0)}};
  meta.ray_axis = 1;
  meta.materials = {{"air", "#00000000", 2}, {"\"steel\"\n", "#8899aa", 0}, {"", "#ffffff", 1}};
  meta.labels = {{0, ""}, {2, "hull"}, {1, "déck"}, {1, ""}};
  meta.chunk_rays = 256;
  meta.chunk_cells = 1u << 31;
  meta.page_chunks = 1;
  meta.crossings = ~uint64_t{0};
  meta.levels = {{0, ~uint64_t{0}, 1, uint64_t{1} << 63, 3}, {2, 4, 5, 6, 7}};
  for (int level = 4; level <= 30; level += 2) meta.levels.push_back({level, 1, 0, 0, 0});
  meta.others = {{"fractions", ~uint64_t{0}, 1}, {"\"", 0, ~uint64_t{0}}};
  return meta;
}

TEST_CASE("Metadata come back to the last bit") {
  const Metadata meta = some_metadata();
  REQUIRE(decode_metadata(encode_metadata(meta)) == meta);
}

TEST_CASE("Metadata cut short, as a frame or as text, are refused") {
  const Bytes frame = encode_metadata(some_metadata());
  expect_every_truncation_refused(frame, decode_metadata);
  const std::string text = decode_text(frame, "metadata");
  for (size_t n = 0; n < text.size(); ++n) REQUIRE_THROWS_AS(decode_metadata(encode_text(text.substr(0, n))), FormatError);
}

TEST_CASE("Metadata with any bit flipped are refused or are metadata that can be written again") {
  const std::string text = decode_text(encode_metadata(some_metadata()), "metadata");
  for (size_t bit = 0; bit < 8 * text.size(); bit += kStride) {
    std::string damaged = text;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ 1 << bit % 8);
    try {
      const Metadata meta = decode_metadata(encode_text(damaged));
      if (!(decode_metadata(encode_metadata(meta)) == meta)) FAIL("bit " << bit);
    } catch (const FormatError&) {
    }
  }
}

// Metadata whose JSON was edited.
template <class F>
Bytes edited(F&& edit) {
  Metadata meta = some_metadata();
  meta.grid.axis[0] = Axis::uniform(0, 1, 0, Axis::kMaxCells, 0.25);
  ordered_json j = ordered_json::parse(decode_text(encode_metadata(meta), "metadata"));
  edit(j);
  return encode_text(j.dump());
}

TEST_CASE("Unknown keys of the metadata are skipped; of unknown optional channels the cover is kept") {
  Metadata plain = decode_metadata(edited([](ordered_json&) {}));
  plain.others.insert(plain.others.begin(), {"first", 7, 8});
  plain.others.push_back({"last", 9, 10});
  REQUIRE(decode_metadata(edited([](ordered_json& j) {
            j["new"] = {1, 2, 3};
            j["chunk"]["new"] = "x";
            j["channels"].push_back({{"name", "last"}, {"required", false}, {"coding", "bytes"}, {"strange", 7}, {"cover", {{"offset", 9}, {"frames", 10}}}});
            j["channels"].insert(j["channels"].begin(),
                                 ordered_json::object({{"name", "first"}, {"required", false}, {"cover", {{"offset", 7}, {"frames", 8}, {"new", 1}}}}));
          })) == plain);
}

TEST_CASE("Of two successive levels one must be stored: a reader would derive the rest from the whole grid") {
  Metadata meta = some_metadata();
  meta.levels.pop_back();
  REQUIRE_THROWS_WITH(decode_metadata(encode_metadata(meta)), Catch::Contains("successive levels"));
  meta.levels = {meta.levels[0]};
  REQUIRE_THROWS_WITH(decode_metadata(encode_metadata(meta)), Catch::Contains("successive levels"));
}

TEST_CASE("Required channels that are unknown, labels in an unknown coding, twice or not at all are refused by name") {
  REQUIRE_THROWS_WITH(decode_metadata(edited([](ordered_json& j) { j["channels"].push_back({{"name", "fractions"}, {"required", true}, {"coding", "bytes"}}); })),
                      Catch::Contains("fractions"));
  REQUIRE_THROWS_WITH(decode_metadata(edited([](ordered_json& j) { j["channels"][0]["coding"] = "octrees"; })), Catch::Contains("octrees"));
  REQUIRE_THROWS_AS(decode_metadata(edited([](ordered_json& j) { j["channels"].push_back(j["channels"][0]); })), FormatError);
  REQUIRE_THROWS_WITH(decode_metadata(edited([](ordered_json& j) { j["channels"] = ordered_json::array(); })), Catch::Contains("labels"));
}

TEST_CASE("Every key of the metadata is needed and no value of another type is taken for it") {
  const ordered_json wrong[] = {nullptr, "text", -1, 1.5, ordered_json::array(), ordered_json::object(), true};
  for (const char* path : {"/units", "/ray_axis", "/axes", "/axes/0/type", "/axes/0/cells", "/axes/0/first", "/axes/1/planes", "/materials",
                           "/materials/0/name", "/materials/0/color", "/materials/0/rank", "/labels", "/labels/0/material", "/chunk", "/chunk/rays",
                           "/chunk/cells", "/chunk/page", "/crossings", "/channels", "/channels/0/name", "/channels/0/levels",
                           "/channels/0/levels/0/level", "/channels/0/levels/0/directory", "/channels/0/levels/0/bytes", "/channels/1/required",
                           "/channels/1/cover", "/channels/1/cover/offset", "/channels/1/cover/frames"}) {
    INFO(path);
    const ordered_json::json_pointer pointer(path);
    REQUIRE_THROWS_AS(decode_metadata(edited([&](ordered_json& j) { j[pointer.parent_pointer()].erase(pointer.back()); })), FormatError);
    for (const ordered_json& value : wrong) {
      const Bytes frame = edited([&](ordered_json& j) { j[pointer] = value; });
      if (value.is_string() && (path == std::string("/units") || std::string(path).starts_with("/materials/0/"))) continue;  // texts are free
      INFO(value.dump());
      REQUIRE_THROWS_AS(decode_metadata(frame), FormatError);
    }
  }
}

TEST_CASE("Numbers of the metadata that lie are refused") {
  const auto refused = [](const char* path, const ordered_json& value) {
    INFO(path << " = " << value.dump());
    REQUIRE_THROWS_AS(decode_metadata(edited([&](ordered_json& j) { j[ordered_json::json_pointer(path)] = value; })), FormatError);
  };
  for (const uint64_t rays : {0, 2, 3, 6, 66, 260, 1 << 20}) refused("/chunk/rays", rays);
  for (const uint64_t cells : {uint64_t{0}, uint64_t{1}, uint64_t{3}, uint64_t{66}, (uint64_t{1} << 31) + 4, ~uint64_t{0}}) refused("/chunk/cells", cells);
  for (const uint64_t page : {uint64_t{0}, uint64_t{65}, uint64_t{1} << 32}) refused("/chunk/page", page);
  for (const uint64_t cells : {uint64_t{0}, (uint64_t{1} << 31) - 1, ~uint64_t{0}}) refused("/axes/0/cells", cells);
  for (const uint64_t first : {(uint64_t{1} << 52) + 1, ~uint64_t{0}}) refused("/axes/0/first", first);
  refused("/axes/0/cells", 12.0);  // whole, but not written so
  refused("/axes/0/step", 0);
  refused("/axes/0/sample", 1);
  refused("/axes/0/type", "round");
  refused("/axes/1/planes", {0, 0, 1});
  refused("/axes/1/planes", {0});
  refused("/ray_axis", "w");
  refused("/ray_axis", "");
  refused("/materials/0/rank", 0);  // equal to another
  refused("/materials/1/rank", 1);
  refused("/materials/1/rank", 3);  // above the background's
  refused("/materials/0/rank", 65536);
  refused("/labels/1/material", 3);
  refused("/labels", ordered_json::array());
  refused("/materials", ordered_json::array());
  refused("/channels/0/levels", ordered_json::array());
  refused("/channels/0/levels/0/level", 1);   // level 0 is missing
  refused("/channels/0/levels/1/level", 0);   // twice
  refused("/channels/0/levels/1/level", 30);  // twice
  refused("/channels/0/levels/2/level", 32);  // beyond the last
  refused("/channels/0/levels/2/level", 1);   // not ascending
  refused("/channels/1/cover/frames", 0);
  REQUIRE_THROWS_AS(decode_metadata(edited([](ordered_json& j) { j["axes"].push_back(j["axes"][0]); })), FormatError);
  REQUIRE_THROWS_AS(decode_metadata(edited([](ordered_json& j) { j["axes"].erase(2); })), FormatError);
}

TEST_CASE("A deep or large text is no metadata") {
  REQUIRE_THROWS_AS(decode_metadata(encode_text(std::string(1'000'000, '['))), FormatError);
  REQUIRE_THROWS_AS(decode_metadata(encode_text(std::string(1'000'000, ' '))), FormatError);
  REQUIRE_THROWS_AS(decode_metadata(encode_text("")), FormatError);
  REQUIRE_THROWS_AS(decode_metadata(encode_text("\xFF\xFE{}")), FormatError);
}

// ---- shape of a level -----------------------------------------------------------------------------------------------

TEST_CASE("Chunks and pages of a level divide its rays and cells without gap or overlap") {
  Metadata meta;
  meta.grid = {{Axis::uniform(0, 1, 0, 300, 0.5), Axis::uniform(0, 1, 0, 41, 0.5), Axis::uniform(0, 1, 0, 97, 0.5)}};
  meta.ray_axis = 1;
  meta.chunk_rays = 8;
  meta.chunk_cells = 16;
  meta.page_chunks = 3;
  for (int level = 0; level < meta.grid.levels(); ++level) {
    const LevelShape s(meta, level);
    const Index3 n = meta.grid.cells(level);
    REQUIRE((s.nu == n[0] && s.nv == n[2] && s.nw == n[1]));
    uint64_t rays = 0;
    std::vector<uint32_t> chunks(s.pages(), 0);
    for (uint32_t w = 0; w < s.segments; ++w)
      for (uint32_t v = 0; v < s.chunks_v; ++v)
        for (uint32_t u = 0; u < s.chunks_u; ++u) {
          const uint64_t page = s.page_of(u, v, w);
          REQUIRE(page < s.pages());
          REQUIRE(s.slot_of(u, v, page) == chunks[page]++);  // raster order within the page
          rays += uint64_t{s.rays_u(u)} * s.rays_v(v) * s.length(w);
        }
    REQUIRE(rays == uint64_t{s.nu} * s.nv * s.nw);
    for (uint64_t page = 0; page < s.pages(); ++page) REQUIRE(chunks[page] == s.page_width(page) * s.page_height(page));
  }
}

}  // namespace
}  // namespace teracell

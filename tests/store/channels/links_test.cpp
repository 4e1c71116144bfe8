// Links of a chunk to bytes and back; and bytes that no encoder wrote.
#include "store/channels/links.hpp"

#include "store/format/format.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;

// A grid of one chunk.
Metadata links_of_one_chunk(int64_t nu, int64_t nv, int64_t length) {
  Metadata meta;
  meta.ray_axis = 2;
  meta.grid = unit_grid({nu, nv, length});
  meta.materials = {{"air", "#00000000", 1}, {"steel", "#112233", 0}};
  meta.labels = {{0, ""}, {1, ""}};
  for (int i = 0; i < 10; ++i) meta.patches.push_back({std::to_string(i), "", 1});
  meta.channels.push_back(links_channel());
  return meta;
}

ChunkLinks random_links(std::mt19937_64& random, uint32_t nu, uint32_t nv, uint32_t length) {
  ChunkLinks out{nu, nv, length, {}};
  for (int axis = 0; axis < 3; ++axis) {
    uint32_t patch = 6;
    for (uint64_t line = 0; line < out.lines(axis); ++line)
      for (uint32_t cell = 0; cell + 1 < out.cells(axis); ++cell) {
        if (random_int(random, 0, 5) != 0) continue;
        Link link{line, cell, static_cast<uint32_t>(random_int(random, 1, 65536)), 0, patch};
        link.begin = link.end;
        switch (random_int(random, 0, 9)) {
          case 0: link.begin = static_cast<uint32_t>(random_int(random, static_cast<int>(link.end), 65536)); break;
          case 1: link.end = link.begin = 0, link.patch = kNoPatch; break;
          case 2: link.patch = patch = static_cast<uint32_t>(random_int(random, 6, 9)); break;
          default: break;
        }
        out.along[axis].push_back(link);
      }
  }
  return out;
}

ChunkLinks decoded_links(const Metadata& meta, std::span<const uint8_t> frame) {
  ChunkLinks out;
  decode_links(meta, {0, 0, 0, 0}, frame, out);
  return out;
}

// A FormatError, or links that keep every promise of links.hpp.
void expect_refused_or_sound_links(const Metadata& meta, const Bytes& bytes) {
  const Bytes exact(bytes.begin(), bytes.end());  // its own piece of the heap, so that ASan sees one byte too far
  ChunkLinks links;
  try {
    decode_links(meta, {0, 0, 0, 0}, exact, links);
  } catch (const FormatError&) {
    return;
  }
  bool sound = !links.empty();
  for (int axis = 0; axis < 3; ++axis)
    for (size_t i = 0; i < links.along[axis].size(); ++i) {
      const Link& l = links.along[axis][i];
      sound &= l.line < links.lines(axis) && l.cell + 1 < links.cells(axis) && (l.patch == kNoPatch || l.patch < 10) && l.end <= l.begin &&
               l.begin <= 65536 && (l.end > 0 || l.begin == 0);
      if (i > 0) sound &= std::pair(links.along[axis][i - 1].line, links.along[axis][i - 1].cell) < std::pair(l.line, l.cell);
    }
  if (!sound) FAIL("decoded links are not sound");
}

TEST_CASE("Links come back from their bytes", "[links]") {
  std::mt19937_64 random(3);
  for (const auto& [nu, nv, length] : {std::array<uint32_t, 3>{4, 4, 50}, {7, 3, 200}, {1, 1, 9}, {8, 1, 3}}) {
    const Metadata meta = links_of_one_chunk(nu, nv, length);
    for (int i = 0; i < 20; ++i) {
      const ChunkLinks links = random_links(random, nu, nv, length);
      if (links.empty()) continue;
      const Bytes frame = LinksEncoder().encode(links);
      const ChunkLinks back = decoded_links(meta, frame);
      REQUIRE(back.along == links.along);
      REQUIRE(LinksEncoder().encode(back) == frame);
    }
  }
}

TEST_CASE("A flat wall, however it leans, takes less than a byte per link", "[links]") {
  ChunkLinks links{64, 64, 1000, {}};
  for (uint32_t v = 0; v < 64; ++v)
    for (uint32_t u = 0; u < 64; ++u) {
      const uint32_t height = 7'000'000 + 7919 * u + 104'729 * v;
      links.along[2].push_back({uint64_t{v} * 64 + u, height >> 16, (height & 0xFFFF) + 1, (height & 0xFFFF) + 1, 6});
    }
  CHECK(LinksEncoder().encode(links).size() < links.along[2].size() / 4);
}

TEST_CASE("Bytes that are no links are refused", "[links]") {
  const Metadata meta = links_of_one_chunk(2, 3, 4);
  const auto frame_of = [](const std::vector<uint64_t>& numbers) {
    Bytes body;
    for (const uint64_t n : numbers) put_varint(body, n);
    return encode_text({body.begin(), body.end()});
  };
  // Along u one link: in line 2, cell 0 ends at 3 and its neighbour begins at 5, patch 6. None along v and w.
  const std::vector<uint64_t> sound = {1, 3, 2, 1, 1, 2 * 2, 2, 0, 2, 2, 0, 7, 0, 0, 0, 0, 0, 0, 0, 0};
  const ChunkLinks links = decoded_links(meta, frame_of(sound));
  REQUIRE(links.along[0] == std::vector<Link>{{2, 0, 3, 5, 6}});
  const auto refused = [&](size_t at, uint64_t value, const std::string& words) {
    INFO(words);
    std::vector<uint64_t> numbers = sound;
    numbers[at] = value;
    REQUIRE_THROWS_WITH(decoded_links(meta, frame_of(numbers)), Catch::Contains(words));
  };
  refused(0, 0, "links");
  refused(2, 12, "lines of a group");
  refused(3, 11, "lines of a group");
  refused(4, 2, "links of a line");
  refused(5, 2 * 65536, "beyond its line");  // the last cell has no neighbour above it
  refused(11, 11, "patch of a link");
  refused(5, 1, "beyond its line");
  refused(7, 1, "without an exception");
  refused(12, 5, "");
  std::vector<uint64_t> none(12, 0);
  REQUIRE_THROWS_WITH(decoded_links(meta, frame_of(none)), Catch::Contains("there is no link"));
  std::vector<uint64_t> more = sound;
  more.push_back(1);
  REQUIRE_THROWS_WITH(decoded_links(meta, frame_of(more)), Catch::Contains("expected the end"));
}

TEST_CASE("Links cut at any byte are refused, and changed ones are refused or sound", "[links]") {
  std::mt19937_64 random(7);
  const Metadata meta = links_of_one_chunk(4, 5, 30);
  const Bytes frame = LinksEncoder().encode(random_links(random, 4, 5, 30));
  for (size_t size = 0; size < frame.size(); ++size) REQUIRE_THROWS_AS(decoded_links(meta, std::span(frame).first(size)), FormatError);
  const std::string body = decode_text(frame, "body");
  for (size_t i = 0; i < rounds(4000); ++i) {
    std::string changed = body;
    for (int n = random_int(random, 1, 3); n > 0; --n)
      changed[static_cast<size_t>(random_int(random, 0, static_cast<int>(body.size()) - 1))] = static_cast<char>(random_int(random, 0, 255));
    expect_refused_or_sound_links(meta, encode_text(changed));
  }
}

}  // namespace
}  // namespace teracell

// The index of a channel that has frames for chunks.
#include "store/format/cell_frames.hpp"

#include "store/whole/verify.hpp"
#include "store/write/writer.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;

constexpr ChannelKind kNames[] = {
    {kLabels, kRuns, nullptr}, {"names", "text", [](const GridReader& reader, const Channel& channel, const std::function<Bytes(uint64_t)>& frame) {
                                  check_cell_frames(reader.meta(), channel, frame, [](const ChunkKey& key, const Bytes* bytes) {
                                    if (bytes && decode_text(*bytes, "name") != chunk_name(key)) throw FormatError("it is another chunk's");
                                  });
                                }}};

// Puts the name of a chunk for two chunks of three.
std::optional<std::string> name_for(const ChunkKey& key) {
  if ((key.cu + 2 * key.cv + key.segment) % 3 == 0) return std::nullopt;
  return chunk_name(key);
}

void put_chunk(GridWriter& writer, ChunkEncoder& encoder, const ChunkKey& key) {
  const LevelShape s(writer.meta(), key.level);
  RayBlock rays;
  rays.fill(s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), 0);
  writer.put(key, encode_chunk(encoder, rays, SetTable(2), key.level == 0));
  if (key.level > 0) return;
  const auto name = name_for(key);
  writer.put_cells(1, key, name ? encode_text(*name) : Bytes());
}

struct NamedFrames {
  TempFolder folder;
  Metadata meta;
  std::vector<ChunkKey> keys;
  NamedFrames() {
    const Axis axis = Axis::uniform(0, 1, 0, 61, 0.5);
    meta = with_tiny_chunks(metadata_of({{axis, axis, Axis::uniform(0, 1, 0, 23, 0.5)}}, 2, 2));
    meta.channels.push_back({"names", "text", false, {}, 0, 0});
    for (int level = 0; level < meta.grid.levels(); ++level) {
      if (level == 1) continue;
      const LevelShape s(meta, level);
      for (uint64_t page = 0; page < s.pages(); ++page)
        for (uint32_t slot = 0; slot < s.page_size(page); ++slot) keys.push_back(s.key_of(page, slot));
    }
  }
  std::filesystem::path whole() {
    GridWriter writer(folder / "g.tcell", meta);
    ChunkEncoder encoder;
    for (const ChunkKey& key : keys) put_chunk(writer, encoder, key);
    writer.finish("{}", 0);
    return folder / "g.tcell";
  }
};

TEST_CASE("Each chunk finds its frame, or that it has none", "[fractions]") {
  NamedFrames named;
  const GridReader reader(named.whole());
  REQUIRE(reader.shape(0).pages() > 3);
  const Channel& channel = reader.meta().others()[0];
  REQUIRE(channel.bytes > 0);
  for (const ChunkKey& key : named.keys) {
    if (key.level != 0) continue;
    Bytes frame;
    const bool found = reader.read_cells(channel, key, frame);
    const auto name = name_for(key);
    REQUIRE(found == name.has_value());
    if (found) REQUIRE(decode_text(frame, "name") == *name);
  }
  verify(
      reader, 1, [](double) {}, kNames);
}

TEST_CASE("A writer that goes on from any state makes the same index", "[fractions]") {
  NamedFrames named;
  const std::string expected = bytes_of(named.whole());
  const auto at = named.folder / "again.tcell";
  ChunkEncoder encoder;
  for (size_t killed = 1; killed < named.keys.size(); killed += 97) {
    Bytes state;
    const auto aside = named.folder / "aside";
    {
      GridWriter writer(at, named.meta);
      for (size_t i = 0; i < killed; ++i) put_chunk(writer, encoder, named.keys[i]);
      writer.save(state);
      std::filesystem::copy_file(at.string() + ".partial", aside, std::filesystem::copy_options::overwrite_existing);
    }
    std::filesystem::rename(aside, at.string() + ".partial");
    ByteReader in(state, "state");
    GridWriter writer(at, named.meta, in);
    for (size_t i = killed; i < named.keys.size(); ++i) put_chunk(writer, encoder, named.keys[i]);
    writer.finish("{}", 0);
    REQUIRE(bytes_of(at) == expected);
  }
}

TEST_CASE("A chunk or a page that is there twice is refused, as is one that is missing", "[fractions]") {
  NamedFrames named;
  const LevelShape s(named.meta, 0);
  CellFrames frames(named.meta);
  const auto put_all = [&](uint64_t page) {
    for (uint32_t slot = 0; slot < s.page_size(page); ++slot) frames.put(s.key_of(page, slot), kNoFrame, 0);
  };
  frames.put(s.key_of(0, 0), 7, 8);
  CHECK_THROWS_WITH(frames.put(s.key_of(0, 0), 7, 8), Catch::Contains("twice"));
  CHECK_THROWS_WITH(frames.put_page(0, 3), Catch::Contains("twice"));
  put_all(1);
  CHECK_THROWS_WITH(frames.put(s.key_of(1, 0), kNoFrame, 0), Catch::Contains("twice"));
  CHECK_THROWS_WITH(frames.put_page(1, kNoFrame), Catch::Contains("twice"));
  frames.put_page(2, 9);
  CHECK_THROWS_WITH(frames.put(s.key_of(2, 0), kNoFrame, 0), Catch::Contains("twice"));
  CHECK_THROWS_WITH(frames.lists(), Catch::Contains("lacks chunks"));
}

TEST_CASE("One frame named for many chunks is decoded for one of them alone", "[fractions]") {
  NamedFrames named;
  const auto path = named.folder / "g.tcell";
  {
    GridWriter writer(path, named.meta);
    ChunkEncoder encoder;
    const LevelShape s(named.meta, 0);
    for (const ChunkKey& key : named.keys) {
      RayBlock rays;
      const LevelShape of(named.meta, key.level);
      rays.fill(of.rays_u(key.cu), of.rays_v(key.cv), of.length(key.segment), 0);
      writer.put(key, encode_chunk(encoder, rays, SetTable(2), key.level == 0));
    }
    writer.put_frame(1, encode_text("one for all"));
    std::vector<uint64_t> pages;
    for (uint64_t page = 0; page < s.pages(); ++page) {
      pages.push_back(page + 1);
      writer.put_frame(1, encode_cell_page(CellPage(s.page_size(page), 0), page + 1));
    }
    writer.put_frame(1, encode_cell_list(pages));
    writer.finish("{}", 0);
  }
  const GridReader reader(path);
  const Channel& channel = reader.meta().others()[0];
  Bytes frame;
  CHECK(reader.read_cells(channel, {0, 0, 0, 0}, frame));
  CHECK(reader.read_cells(channel, {0, 0, 0, 0}, frame));
  CHECK_THROWS_WITH(reader.read_cells(channel, {0, 1, 0, 0}, frame), Catch::Contains("belongs to two things"));
}

TEST_CASE("An index that names frames wrongly is refused", "[fractions]") {
  const CellPage page = {3, kNoFrame, 5};
  const Bytes frame = encode_cell_page(page, 7);
  REQUIRE(decode_cell_page(frame, 3, 7) == page);
  REQUIRE_THROWS_AS(decode_cell_page(frame, 2, 7), FormatError);
  REQUIRE_THROWS_AS(decode_cell_page(frame, 4, 7), FormatError);
  REQUIRE_THROWS_WITH(decode_cell_page(frame, 3, 3), Catch::Contains("distance of a frame"));
  const std::vector<uint64_t> list = {kNoFrame, 0, 9};
  REQUIRE(decode_cell_list(encode_cell_list(list), 3, 10) == list);
  REQUIRE_THROWS_WITH(decode_cell_list(encode_cell_list(list), 3, 9), Catch::Contains("number of a page's frame"));
  for (const Bytes& whole : {frame, encode_cell_list(list)})
    for (size_t size = 0; size < whole.size(); ++size) {
      REQUIRE_THROWS_AS(decode_cell_page(std::span(whole).first(size), 3, 7), FormatError);
      REQUIRE_THROWS_AS(decode_cell_list(std::span(whole).first(size), 3, 10), FormatError);
    }
}

TEST_CASE("verify() finds a frame that belongs to no chunk", "[fractions]") {
  NamedFrames named;
  GridWriter writer(named.folder / "g.tcell", named.meta);
  ChunkEncoder encoder;
  for (const ChunkKey& key : named.keys) {
    put_chunk(writer, encoder, key);
    if (key == named.keys[5]) writer.put_frame(1, encode_text("stray"));
  }
  writer.finish("{}", 0);
  const GridReader reader(named.folder / "g.tcell");
  const auto check = [&] {
    verify(
        reader, 1, [](double) {}, kNames);
  };
  REQUIRE_THROWS_WITH(check(), Catch::Contains("frames, but its pages name"));
}

}  // namespace
}  // namespace teracell

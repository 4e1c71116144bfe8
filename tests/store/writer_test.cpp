// The writer: interrupted anywhere it makes the same file, and it notices what would make a wrong one.
#include "store/writer.hpp"

#include <fstream>

#include <catch2/catch.hpp>

#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

struct Put {
  ChunkKey key;
  EncodedChunk chunk;
};

Metadata some_metadata() {
  const Axis axis = Axis::uniform(0, 1, 0, 17, 0.5);
  return with_tiny_chunks(metadata_of({{axis, axis, axis}}, 2, 3));
}

// All chunks that a file of this metadata has, of random cells: what they hold is not the writer's business.
std::vector<Put> some_chunks(const Metadata& meta) {
  std::mt19937_64 random(11);
  ChunkEncoder encoder;
  std::vector<Put> puts;
  for (int level = 0; level < meta.grid.levels(); ++level) {
    if (level == 1) continue;
    const LevelShape s(meta, level);
    for (uint64_t page = 0; page < s.pages(); ++page)
      for (uint32_t slot = 0; slot < s.page_size(page); ++slot) {
        const ChunkKey key = s.key_of(page, slot);
        Chunk chunk = random_chunk(random, testing::Kind::kNoise, s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), 3);
        if (random() % 2 == 0) chunk.rays.fill(chunk.rays.nu, chunk.rays.nv, chunk.rays.length, static_cast<SetId>(random() % 3));
        puts.push_back({key, encode_chunk(encoder, chunk.rays, chunk.sets, level == 0)});
      }
  }
  std::ranges::shuffle(puts, random);  // pages stay open for long
  return puts;
}

Bytes written_at_once(const std::filesystem::path& path, const std::vector<Put>& puts) {
  GridWriter writer(path, some_metadata());
  for (const Put& p : puts) writer.put(p.key, p.chunk);
  writer.finish("{}", 7);
  return file_bytes(path);
}

// A writer that saves its state after `count` chunks, writes one more and is killed.
Bytes state_after(const std::filesystem::path& path, const std::vector<Put>& puts, size_t count) {
  Bytes state;
  const std::filesystem::path other = path.string() + ".aside";
  {
    GridWriter writer(path, some_metadata());
    for (size_t i = 0; i < count; ++i) writer.put(puts[i].key, puts[i].chunk);
    writer.save(state);
    if (count < puts.size()) writer.put(puts[count].key, puts[count].chunk);
    std::filesystem::copy_file(path.string() + ".partial", other);
  }
  std::filesystem::rename(other, path.string() + ".partial");
  return state;
}

TEST_CASE("A writer that goes on from any state makes the bytes of one that was never interrupted") {
  const TempFolder folder;
  const std::vector<Put> puts = some_chunks(some_metadata());
  const Bytes expected = written_at_once(folder / "whole.tcell", puts);
  for (size_t count = 0; count <= puts.size(); count += puts.size() / 7) {
    INFO(count << " of " << puts.size() << " chunks");
    const Bytes state = state_after(folder / "g.tcell", puts, count);
    ByteReader in(state, "state");
    GridWriter writer(folder / "g.tcell", some_metadata(), in);
    in.expect_end();
    for (size_t i = count; i < puts.size(); ++i) writer.put(puts[i].key, puts[i].chunk);
    writer.finish("{}", 7);
    REQUIRE(file_bytes(folder / "g.tcell") == expected);
  }
}

TEST_CASE("A partial file with a changed byte is refused and left where it is") {
  const TempFolder folder;
  const std::vector<Put> puts = some_chunks(some_metadata());
  const Bytes state = state_after(folder / "g.tcell", puts, puts.size() / 2);
  const std::filesystem::path partial = folder / "g.tcell.partial";
  const Bytes bytes = file_bytes(partial);
  std::fstream(partial, std::ios::in | std::ios::out | std::ios::binary).seekp(40).put(static_cast<char>(bytes[40] ^ 1));
  ByteReader in(state, "state");
  REQUIRE_THROWS_WITH(GridWriter(folder / "g.tcell", some_metadata(), in), Catch::Contains("damaged"));
  REQUIRE(file_bytes(partial).size() >= 41);
  std::filesystem::resize_file(partial, 40);
  ByteReader again(state, "state");
  REQUIRE_THROWS_AS(GridWriter(folder / "g.tcell", some_metadata(), again), IoError);
}

TEST_CASE("What the writer counts is what the reader finds, and every chunk comes back") {
  const TempFolder folder;
  const std::vector<Put> puts = some_chunks(some_metadata());
  written_at_once(folder / "g.tcell", puts);
  const GridReader reader(folder / "g.tcell");
  std::vector<LevelInfo> expected;
  for (const LevelInfo& l : reader.meta().levels()) expected.push_back({l.level, l.directory, 0, 0, 0});
  for (const Put& p : puts) {
    ChunkEntry found = *reader.entry(p.key);
    found.offset = 0;
    REQUIRE(found == p.chunk.entry);
    LevelInfo& level = *std::ranges::find(expected, p.key.level, &LevelInfo::level);
    level.chunks += p.chunk.entry.size != 0;
    level.bytes += p.chunk.entry.size;
    level.changes += p.chunk.changes;
  }
  REQUIRE(reader.meta().levels() == expected);
  REQUIRE(reader.meta().crossings == 7);
  REQUIRE(reader.report() == "{}");
}

TEST_CASE("A file that lacks a chunk of an open page is not finished") {
  const TempFolder folder;
  std::vector<Put> puts = some_chunks(some_metadata());
  std::erase_if(puts, [](const Put& p) { return p.key == ChunkKey{0, 0, 0, 0}; });
  REQUIRE_THROWS_WITH(written_at_once(folder / "g.tcell", puts), Catch::Contains("lacks chunks"));
  REQUIRE_FALSE(std::filesystem::exists(folder / "g.tcell"));
}

TEST_CASE("A grid with more rays than a directory can name is refused before anything is written") {
  const TempFolder folder;
  const Axis longest = Axis::uniform(0, 1, 0, Axis::kMaxCells, 0.5);
  REQUIRE_THROWS_WITH(GridWriter(folder / "g.tcell", with_tiny_chunks(metadata_of({{longest, longest, longest}}, 2, 2))),
                      Catch::Contains("more than a file can index"));
}

TEST_CASE("A uniform chunk has no frame, any other one its frame's checksum and, on level 0, statistics") {
  ChunkEncoder encoder;
  RayBlock block;
  block.fill(4, 4, 8, 2);
  const EncodedChunk uniform = encode_chunk(encoder, block, SetTable(3), true);
  REQUIRE((uniform.frame.empty() && uniform.changes == 0));
  REQUIRE(uniform.entry == ChunkEntry{0, 0, 0, {2}, {}});
  block.reset(1, 1, 8);
  block.append(std::array<SetId, 2>{0, 1}, std::array<uint32_t, 1>{3});
  for (const bool with_stats : {true, false}) {
    const EncodedChunk chunk = encode_chunk(encoder, block, SetTable(3), with_stats);
    REQUIRE(chunk.changes == 1);
    REQUIRE(chunk.entry.size == chunk.frame.size());
    REQUIRE(chunk.entry.checksum == checksum(chunk.frame));
    REQUIRE(chunk.entry.stats.size() == (with_stats ? 2 : 0));
  }
}

}  // namespace
}  // namespace teracell

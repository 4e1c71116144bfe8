// The writer: interrupted anywhere it makes the same file, and it notices what would make a wrong one. Channels beside the labels are
// written with them.
#include "store/write/writer.hpp"

#include "store/format/checked_read.hpp"
#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;

struct Put {
  ChunkKey key;
  EncodedChunk chunk;
};

Metadata some_metadata() { return with_tiny_chunks(metadata_of(cube_grid_of(0, 1, 17), 2, 3)); }

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
        Chunk chunk = random_chunk(random, testing::BlockKind::kNoise, s.rays_u(key.cu), s.rays_v(key.cv), s.length(key.segment), 3);
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

TEST_CASE("A page that was made elsewhere is put once, and none is left out") {
  const TempFolder folder;
  GridWriter writer(folder / "g.tcell", some_metadata());
  const Bytes frame = {1, 2, 3};
  writer.put_bytes(frame);
  writer.put_page({0, 0, 0, 0, 0}, 1, 3, checksum(frame));
  CHECK_THROWS_WITH(writer.put_page({0, 0, 0, 0, 0}, 1, 3, checksum(frame)), Catch::Contains("level 0 index page 1: it is there twice"));
  CHECK_THROWS_WITH(writer.finish("{}", 0), Catch::Contains("lacks chunks"));
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

// ---- A kind of channel that is made up for these tests: frame i holds the square of i.

Metadata with_squares(Metadata meta, bool required = false) {
  meta.channels.push_back({"squares", "text", required, {}, 0, 0});
  return meta;
}

Bytes square(uint64_t i) { return encode_text(std::to_string(i * i)); }

uint64_t squares_checked;  // a check is a plain function, so it can't capture what it found

void check_squares(const GridReader&, const Channel& channel, const std::function<Bytes(uint64_t)>& frame) {
  squares_checked = 0;
  for (uint64_t i = 0; i < channel.frames; ++i, ++squares_checked)
    if (decode_text(frame(i), "square") != std::to_string(i * i)) throw FormatError(fmt::format("frame {} is no square", i));
}

constexpr ChannelKind kKinds[] = {{kLabels, kRuns, nullptr}, {"squares", "text", check_squares}};

// A file with a square behind each column of chunks of level 0; `odd` is added to the last.
struct Squares {
  Bytes file;
  uint64_t count = 0;
  Levels cells;
};
Squares file_with_squares(const Bytes& odd = {}) {
  const TempFolder folder;
  std::mt19937_64 random(3);
  const Index3 n = {5, 9, 4};
  const Metadata meta = with_tiny_chunks(metadata_of(unit_grid(n), 2, 3));
  const std::vector<Label> cells = random_cells(random, n, 3);
  Squares out;
  store_cells(folder / "g.tcell", with_squares(meta), cells, [&](GridWriter& writer) {
    writer.put_frame(1, odd.empty() || out.count != 3 ? square(out.count) : odd);
    out.count += 1;
  });
  out.file = file_bytes(folder / "g.tcell");
  store_cells(folder / "plain.tcell", meta, cells);
  out.cells = read_everything(GridReader(folder / "plain.tcell"));
  return out;
}

void verify_squares(const GridReader& reader) {
  verify(
      reader, 1, [](double) {}, kKinds);
}

TEST_CASE("The frames of a channel come back by its cover, and its kind checks them") {
  const auto [file, count, cells] = file_with_squares();
  const GridReader reader = reader_of(file);
  REQUIRE(count == 6);
  REQUIRE(reader.meta().others().size() == 1);
  const Channel& channel = reader.meta().others()[0];
  REQUIRE(channel.name == "squares");
  REQUIRE(channel.coding == "text");
  REQUIRE_FALSE(channel.required);
  REQUIRE(channel.frames == count);
  for (uint64_t i = 0; i < count; ++i) {
    Bytes frame;
    read_checked(reader.source(), reader.frame_place(channel, i), "frame", frame);
    REQUIRE(frame == square(i));
  }
  REQUIRE((read_everything(reader) == cells));
  verify_squares(reader);
  REQUIRE(squares_checked == count);
  verify_quietly(reader);  // which does not know the kind
  REQUIRE_THROWS_WITH(verify_squares(reader_of(file_with_squares(encode_text("10")).file)), "memory.tcell: frame 3 is no square");
}

TEST_CASE("A file with another channel that is cut short, or has a changed bit, is never taken for sound") {
  const auto [file, count, cells] = file_with_squares();
  for (size_t size = 0; size < file.size(); size += kStride) {
    const Bytes prefix(file.begin(), file.begin() + static_cast<ptrdiff_t>(size));
    expect_noticed(prefix, cells, "cut at", size);
  }
  for (size_t i = 0; i < file.size(); i += kStride) {
    Bytes damaged = file;
    damaged[i] ^= static_cast<uint8_t>(1u << i % 8);
    expect_noticed(damaged, cells, "byte", i);
  }
}

TEST_CASE("A writer that goes on from any state makes the same bytes of all channels") {
  const TempFolder folder;
  Metadata meta = with_squares(some_metadata());
  meta.channels.push_back({"cubes", "", false, {}, 0, 0});
  std::vector<Put> puts = some_chunks(meta);
  // After every chunk a square, after every third one a cube.
  const auto put = [&](GridWriter& writer, size_t i) {
    writer.put(puts[i].key, puts[i].chunk);
    writer.put_frame(1, square(i));
    if (i % 3 == 0) writer.put_frame(2, encode_text(std::to_string(i * i * i)));
  };
  {
    GridWriter writer(folder / "whole.tcell", meta);
    for (size_t i = 0; i < puts.size(); ++i) put(writer, i);
    writer.finish("{}", 7);
  }
  const Bytes expected = file_bytes(folder / "whole.tcell");
  REQUIRE(reader_of(expected).meta().others()[1].frames == (puts.size() + 2) / 3);
  const std::filesystem::path path = folder / "g.tcell", partial = folder / "g.tcell.partial", aside = folder / "aside";
  for (size_t count = 0; count <= puts.size(); count += puts.size() / 7) {
    INFO(count << " of " << puts.size() << " chunks");
    Bytes state;
    {
      GridWriter writer(path, meta);
      for (size_t i = 0; i < count; ++i) put(writer, i);
      writer.save(state);
      if (count < puts.size()) put(writer, count);
      std::filesystem::copy_file(partial, aside);
    }
    std::filesystem::rename(aside, partial);
    ByteReader in(state, "state");
    GridWriter writer(path, meta, in);
    in.expect_end();
    for (size_t i = count; i < puts.size(); ++i) put(writer, i);
    writer.finish("{}", 7);
    REQUIRE(file_bytes(path) == expected);
  }
}

TEST_CASE("A channel without a frame is not finished, and one that is required is refused by readers that don't know it") {
  const TempFolder folder;
  const std::vector<Put> puts = some_chunks(some_metadata());
  const auto write = [&](const Metadata& meta, int frames) {
    GridWriter writer(folder / "g.tcell", meta);
    for (const Put& p : puts) writer.put(p.key, p.chunk);
    for (int i = 0; i < frames; ++i) writer.put_frame(1, square(1));
    writer.finish("{}", 7);
  };
  REQUIRE_THROWS_WITH(write(with_squares(some_metadata()), 0), "channel 'squares' has no frame");
  REQUIRE_FALSE(std::filesystem::exists(folder / "g.tcell"));
  write(with_squares(some_metadata(), true), 1);
  REQUIRE_THROWS_WITH(GridReader(folder / "g.tcell"), Catch::Contains("requires channel 'squares'"));
}

}  // namespace
}  // namespace teracell

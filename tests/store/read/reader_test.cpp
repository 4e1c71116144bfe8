// The reader of whole files: sound ones are read, damaged ones are refused, no lie crashes it, threads may share it.
#include "store/read/reader.hpp"

#include "store/runs/chunk_codec.hpp"
#include "store/whole/info.hpp"
#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;

TEST_CASE("A reader tells what the file holds") {
  const Bytes file = meshed_file();
  const GridReader reader = reader_of(file);
  REQUIRE(reader.file_bytes() == file.size());
  REQUIRE(reader.meta().grid == unit_grid({12, 9, 8}));
  REQUIRE(reader.levels() == 5);
  REQUIRE((reader.stored(0) && !reader.stored(1) && reader.stored(2) && reader.stored(3) && reader.stored(4)));
  REQUIRE(reader.report().starts_with('{'));
  REQUIRE(reader.hash().size() == 32);
  REQUIRE(reader.hash() == reader_of(meshed_file()).hash());
  REQUIRE(reader.hash() != reader_of(chunked_file()).hash());
}

TEST_CASE("A file of a newer minor version is read, and the version told is its own") {
  REQUIRE(reader_of(chunked_file()).version() == "3.2");
  const Bytes newer = forge(chunked_file(), {.bytes = [](FilePart part, Bytes& body) {
                              if (part == FilePart::kHeader) body[18] = 7;
                            }});
  REQUIRE(reader_of(newer).version() == "3.7");
  REQUIRE(nlohmann::json::parse(info_json(reader_of(newer)))["file"]["version"] == "3.7");
  REQUIRE_NOTHROW(verify_quietly(reader_of(newer)));
}

TEST_CASE("The file read by threads at once is the file read by one", "[threads]") {
  const Index3 n = {23, 21, 30};
  const Bytes file = chunked_file(2, n);
  const GridReader reader = reader_of(file);
  const Levels expected = read_everything(reader);
  const GridReader shared = reader_of(file);  // with a cold cache
  std::atomic<int> wrong = 0;
  std::vector<std::jthread> pool;
  for (uint64_t seed = 0; seed < 4; ++seed)
    pool.emplace_back([&, seed] {
      std::mt19937_64 random(seed);
      for (int round = 0; round < 200; ++round) {
        const int level = random_int(random, 0, reader.levels() - 1);
        const Index3 size = reader.meta().grid.cells(level);
        Box box;
        for (int d = 0; d < 3; ++d) {
          box.lo[d] = random_int(random, 0, static_cast<int>(size[d]) - 1);
          box.hi[d] = random_int(random, static_cast<int>(box.lo[d]) + 1, static_cast<int>(size[d]));
        }
        const int64_t nx = box.hi[0] - box.lo[0], ny = box.hi[1] - box.lo[1], nz = box.hi[2] - box.lo[2];
        std::vector<uint32_t> cells(static_cast<size_t>(nx * ny * nz));
        read_box<uint32_t>(shared, level, box, [](const std::vector<Label>& s) { return static_cast<uint32_t>(mask_of(s)); }, 0, cells.data(),
                           {1, nx, nx * ny});
        for (int64_t z = 0; z < nz; ++z)
          for (int64_t y = 0; y < ny; ++y)
            for (int64_t x = 0; x < nx; ++x)
              wrong +=
                  cells[static_cast<size_t>((z * ny + y) * nx + x)] !=
                  expected[static_cast<size_t>(level)][static_cast<size_t>(((z + box.lo[2]) * size[1] + y + box.lo[1]) * size[0] + x + box.lo[0])];
      }
    });
  pool.clear();
  REQUIRE(wrong == 0);
}

TEST_CASE("A chunk said to be uniform is, on stored levels and derived ones; one set below makes a derived chunk uniform") {
  const Index3 n = {19, 16, 32};
  std::vector<Label> cells;  // one half each; a single cell of a third label
  for (int64_t i = 0; i < n[0] * n[1] * n[2]; ++i) cells.push_back(i == 0 ? 2 : i / (n[0] * n[1]) >= 16);
  for (int ray_axis = 0; ray_axis < 3; ++ray_axis) {
    const GridReader reader = reader_of(with_tiny_chunks(metadata_of(unit_grid(n), ray_axis, 3)), cells);
    std::vector<int> said(static_cast<size_t>(reader.levels()), 0);
    Chunk chunk;
    for (int level = 0; level < reader.levels(); ++level) {
      const LevelShape s = reader.shape(level);
      for (uint32_t cv = 0; cv < s.chunks_v; ++cv)
        for (uint32_t cu = 0; cu < s.chunks_u; ++cu)
          for (uint32_t segment = 0; segment < s.segments; ++segment) {
            const ChunkKey key{level, cu, cv, segment};
            reader.read(key, chunk);
            const auto set = reader.uniform(key);
            if (reader.stored(level)) REQUIRE(set.has_value() == chunk.rays.uniform());
            if (!set) continue;
            REQUIRE(chunk.rays.uniform());
            REQUIRE(*set == chunk.sets.members(chunk.rays.sets(0)[0]));
            ++said[static_cast<size_t>(level)];
          }
    }
    REQUIRE(said[0] == 5 * 4 * 8 - 1);
    REQUIRE(said[1] == 3 * 2 * 4 - 1);  // derived
    REQUIRE(said[2] == 2 * 1 * 2 - 1);
  }
}

TEST_CASE("A reader gives its descriptor back, whether the file was sound or not") {
  const TempFolder folder;
  const Bytes file = meshed_file();
  const auto write = [&](const char* name, size_t size) { write_bytes(folder / name, {file.data(), size}); };
  write("sound", file.size());
  write("cut", file.size() - 1);
  write("shorter", 10);
  write("empty", 0);
  const size_t before = open_descriptors();
  for (int round = 0; round < 10; ++round) {
    {
      const GridReader reader(folder / "sound");
      verify_quietly(reader, 2);
      REQUIRE(open_descriptors() == before + 1);
    }
    for (const char* name : {"cut", "shorter", "empty"}) REQUIRE_THROWS_AS(GridReader(folder / name), FormatError);
    REQUIRE_THROWS_AS(GridReader(folder / "missing"), IoError);
  }
  REQUIRE(open_descriptors() == before);
}

TEST_CASE("What is no .tcell file is a FormatError that names it") {
  for (const std::string& text : {std::string(), std::string("solid cube\n"), std::string(1000, 'x'), std::string(1000, '\0')})
    REQUIRE_THROWS_WITH(reader_of({text.begin(), text.end()}), Catch::StartsWith("memory.tcell: ") && Catch::Contains("teracell"));
}

TEST_CASE("A file with further optional channels is read like one without, and sound") {
  const Bytes file = chunked_file();
  std::vector<Bytes> frames;
  for (int i = 0; i < 400; ++i) frames.push_back(encode_text(std::to_string(i)));  // more than two blocks of a directory
  std::mt19937_64 random(3);
  Bytes large(5 << 20);
  for (uint8_t& b : large) b = static_cast<uint8_t>(random());
  for (const std::vector<ForgedChannel>& channels : {std::vector<ForgedChannel>{{"one", {encode_text("x")}}},
                                                     {{"one", {encode_text("x")}}, {"many", frames}},
                                                     {{"large", {large}}, {"", {encode_text("y")}}}}) {
    const Bytes more = forge(file, {.channels = channels});
    const GridReader reader = reader_of(more);
    REQUIRE(reader.meta().others().size() == channels.size());
    for (size_t i = 0; i < channels.size(); ++i) {
      REQUIRE(reader.meta().others()[i].name == channels[i].name);
      REQUIRE(reader.meta().others()[i].frames == channels[i].frames.size());
    }
    REQUIRE(nlohmann::json::parse(info_json(reader))["levels"].size() == static_cast<size_t>(reader.levels()));
    REQUIRE(read_everything(reader) == read_everything(reader_of(file)));
    REQUIRE(reader.hash() != reader_of(file).hash());
    REQUIRE_NOTHROW(verify_quietly(reader));
  }
}

TEST_CASE("A file cut short at any byte, or continued, is refused when it is opened") {
  for (const Bytes& file : {meshed_file(), chunked_file()}) {
    for (size_t n = 0; n < file.size(); ++n) REQUIRE_THROWS_AS(reader_of({file.begin(), file.begin() + static_cast<ptrdiff_t>(n)}), FormatError);
    Bytes longer = file;
    longer.push_back(0);
    REQUIRE_THROWS_AS(reader_of(longer), FormatError);
    longer = file;
    longer.insert(longer.end(), file.begin(), file.end());  // a sound header and a sound footer, of two files
    REQUIRE_THROWS_AS(reader_of(longer), FormatError);
  }
}

TEST_CASE("A cell of level 0 with a set of several labels is refused, by verify and by every reading of it") {
  const Bytes file = meshed_file();
  bool done = false;
  const Bytes forged = forge(file, {.bytes = [&](FilePart part, Bytes& body) {
                               if (part != FilePart::kChunk || done) return;
                               Chunk honest, lie{{}, SetTable(3)};
                               ChunkDecoder().decode(encode_text({body.begin(), body.end()}), 12, 9, 8, 3, honest);
                               std::vector<Mask> cells = expand(honest);
                               for (Mask& cell : cells) cell |= cell == 4 ? 2 : 0;
                               lie = block_of_cells(12, 9, 8, 3, cells);
                               const std::string text = decode_text(ChunkEncoder().encode(lie.rays, lie.sets), "chunk");
                               body.assign(text.begin(), text.end());
                               done = true;
                             }});
  REQUIRE(done);
  expect_verify_refuses(forged, "level 0");
  REQUIRE_THROWS_WITH(level_as_read(reader_of(forged), 0), Catch::Contains("level 0"));
  REQUIRE_THROWS_WITH(level_as_read(reader_of(forged), 1), Catch::Contains("level 0"));
}

TEST_CASE("Offsets outside the file, and sizes beyond it, are refused wherever they stand") {
  const Bytes file = chunked_file();
  for (const uint64_t bad : {uint64_t{file.size()} - 1, uint64_t{file.size()}, uint64_t{file.size()} + 1, uint64_t{1} << 40, uint64_t{1} << 63,
                             ~uint64_t{0} - 7, ~uint64_t{0}}) {
    INFO(bad);
    REQUIRE_THROWS_AS(reader_of(forge(file, {.footer = [&](Footer& f) { f.metadata.offset = bad; }})), FormatError);
    REQUIRE_THROWS_AS(reader_of(forge(file, {.footer = [&](Footer& f) { f.metadata.size = bad; }})), FormatError);
    const Bytes resized = forge(file, {.footer = [&](Footer& f) { f.file_bytes = bad; }});
    if (resized.size() != bad) REQUIRE_THROWS_AS(reader_of(resized), FormatError);
    REQUIRE_THROWS_AS(reader_of(forge(file, {.metadata = [&](Metadata& m) { m.levels()[0].directory = bad; }})), FormatError);
    const Bytes report = forge(file, {.footer = [&](Footer& f) { f.report.offset = bad; }});
    REQUIRE_THROWS_WITH(reader_of(report).report(), Catch::StartsWith("memory.tcell: "));
    for (const Bytes& lie : {report, forge(file, {.footer = [&](Footer& f) { f.report.size = bad; }}),
                             forge(file, {.directory = [&](int, std::vector<DirectoryEntry>& pages) { pages[0].offset = bad; }}),
                             forge(file, {.directory = [&](int, std::vector<DirectoryEntry>& pages) { pages[0].size = bad; }}),
                             forge(file, {.page =
                                              [&](int, std::vector<ChunkEntry>& entries) {
                                                for (ChunkEntry& e : entries) e.offset = bad;
                                              }}),
                             forge(file, {.page = [&](int, std::vector<ChunkEntry>& entries) {
                                     for (ChunkEntry& e : entries) e.size = e.size == 0 ? 0 : static_cast<uint32_t>(bad) | 1;
                                   }})}) {
      expect_verify_refuses(lie, "");
      read_hostile(lie);
    }
  }
}

TEST_CASE("Structures that name each other in loops are refused") {
  const Bytes file = chunked_file();
  Footer honest;
  forge(file, {.footer = [&](Footer& f) { honest = f; }});
  // The footer as its own metadata; the metadata as a page; the report as a chunk; one directory for two levels; ...
  REQUIRE_THROWS_AS(reader_of(forge(file, {.footer = [&](Footer& f) { f.metadata = {f.file_bytes - kFooterBytes, kFooterBytes, 0}; }})), FormatError);
  expect_verify_refuses(forge(file, {.directory = [&](int, std::vector<DirectoryEntry>& pages) { pages[0] = honest.metadata; }}), "");
  expect_verify_refuses(forge(file, {.page =
                                         [&](int, std::vector<ChunkEntry>& entries) {
                                           for (ChunkEntry& e : entries)
                                             if (e.size != 0)
                                               e.offset = honest.report.offset, e.size = static_cast<uint32_t>(honest.report.size),
                                               e.checksum = honest.report.checksum;
                                         }}),
                        "");
  REQUIRE_THROWS_AS(verify_quietly(reader_of(forge(file, {.metadata = [](Metadata& m) { m.levels()[1].directory = m.levels()[0].directory; }}))),
                    FormatError);
  expect_verify_refuses(forge(file, {.footer = [](Footer& f) { f.report = f.metadata; }}), "two things");
}

TEST_CASE("A grid that is larger than its index is refused when it is opened") {
  const Bytes file = chunked_file();
  const int64_t n = Axis::kMaxCells;
  for (const Index3& cells : {Index3{n, n, n}, Index3{n, 1, 1}, Index3{1, n, 1}, Index3{1, 1, n}, Index3{50, 60, 90}}) {
    const Bytes lie = forge(file, {.metadata = [&](Metadata& m) { m.grid = unit_grid(cells); }});
    REQUIRE_THROWS_AS(reader_of(lie), FormatError);
  }
}

TEST_CASE("A file whose chunks, pages or labels are counted otherwise than they were written does not crash the reader") {
  for (const Bytes& file : {meshed_file(), chunked_file()}) {
    for (const uint32_t chunk_rays : {4u, 8u, 64u, 256u})
      for (const uint32_t chunk_cells : {4u, 8u, 65536u, 1u << 31})
        for (const uint32_t page_chunks : {1u, 2u, 16u})
          for (const int axis : {0, 1, 2}) {
            if (kSanitized && axis != 1) continue;
            read_hostile(forge(file, {.metadata = [&](Metadata& m) {
                                 m.chunk_rays = chunk_rays, m.chunk_cells = chunk_cells, m.page_chunks = page_chunks, m.ray_axis = axis;
                               }}));
          }
    for (const size_t labels : {1, 2, 4, 60'000})
      read_hostile(forge(file, {.metadata = [&](Metadata& m) { m.labels.resize(labels), m.materials.resize(std::max<size_t>(labels, 3)); }}));
    for (const Index3& n : {Index3{1, 1, 1}, Index3{12, 9, 7}, Index3{5, 6, 10}, Index3{64, 64, 65536}})
      read_hostile(forge(file, {.metadata = [&](Metadata& m) { m.grid = unit_grid(n); }}));
    read_hostile(forge(file, {.metadata = [&](Metadata& m) { m.levels().resize(1); }}));
  }
}

TEST_CASE("Any byte of the plain bodies changed under right checksums is refused or read, never a crash") {
  const Bytes file = chunked_file(2, {4, 5, 5});
  std::vector<std::pair<FilePart, size_t>> bodies;
  forge(file, {.bytes = [&](FilePart part, Bytes& body) { bodies.emplace_back(part, body.size()); }});
  for (size_t target = 0; target < bodies.size(); ++target) {
    const size_t step = bodies[target].first == FilePart::kMetadata ? 7 : 1;
    for (size_t at = 0; at < bodies[target].second; at += step * kStride)
      for (const uint8_t change : {0x01, 0x80, 0xFF}) {
        size_t index = 0;
        read_hostile(forge(file, {.bytes = [&](FilePart, Bytes& body) {
                             if (index++ == target) body[at] ^= change;
                           }}));
      }
  }
}

}  // namespace
}  // namespace teracell

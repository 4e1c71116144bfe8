// pack(): the same cells, in an order that needs few requests.
#include "store/whole/pack.hpp"

#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;

Bytes packed(const Bytes& file, const PackOptions& options = {}) {
  const TempFolder folder;
  pack(reader_of(file), folder / "p.tcell", options, [](double) {});
  return file_bytes(folder / "p.tcell");
}

TEST_CASE("A packed file is sound and has the same cells, report and statistics") {
  for (const Bytes& file : {meshed_file(), chunked_file(0), chunked_file(1), chunked_file(2, {1, 1, 1}), chunked_file(2, {40, 30, 33}),
                            with_channel(chunked_file(1, {5, 2, 4}))}) {
    const Bytes after = packed(file);
    const GridReader old = reader_of(file), now = reader_of(after);
    verify_quietly(now);
    REQUIRE(read_everything(now) == read_everything(old));
    REQUIRE(now.report() == old.report());
    REQUIRE(now.cells_hash() == old.cells_hash());
    const Box all = old.meta().grid.box(0);
    const auto a = read_stats(old, all), b = read_stats(now, all);
    for (size_t i = 0; i < a.size(); ++i) REQUIRE((a[i].cells == b[i].cells && a[i].volume == b[i].volume));
    REQUIRE(packed(after) == after);
    REQUIRE(packed(file, {.threads = 3}) == after);
    if (old.meta().others().empty()) REQUIRE(packed(without_amounts(file)) == after);
    const Bytes smaller = packed(file, {.with_level_1 = false});
    verify_quietly(reader_of(smaller));
    REQUIRE(packed(after, {.with_level_1 = false}) == smaller);
    REQUIRE(packed(smaller) == after);
    REQUIRE(now.stored(1) == (old.meta().grid.levels() > 1));
    REQUIRE_FALSE(reader_of(smaller).stored(1));
  }
}

TEST_CASE("Statistics that do not add up to the cells of the grid are not packed into sums") {
  const Bytes lie = forge(chunked_file(), {.page = [](int, std::vector<ChunkEntry>& entries) {
                            for (ChunkEntry& e : entries)
                              for (LabelStats& s : e.stats) s.hi[2] += 1000;
                          }});
  REQUIRE_THROWS_WITH(packed(without_amounts(lie)), Catch::Contains("don't add up to the cells of the grid"));
}

TEST_CASE("The hash of the cells is another one for other cells, names and coordinates, and stays when channels come") {
  const Index3 n = {9, 7, 5};
  const std::vector<Label> cells(9 * 7 * 5, 0);
  const Metadata meta = with_tiny_chunks(metadata_of(unit_grid(n), 2, 2));
  std::set<std::string> hashes = {reader_of(meta, cells).cells_hash()};
  for (size_t i = 0; i < cells.size(); ++i) {
    std::vector<Label> changed = cells;
    changed[i] = 1;
    CHECK(hashes.insert(reader_of(meta, changed).cells_hash()).second);
  }
  Metadata renamed = meta, moved = meta;
  renamed.materials[1].name = "other";
  moved.grid = uniform_grid(0.5, 1, n);
  for (const Metadata& m : {renamed, moved}) CHECK(hashes.insert(reader_of(m, cells).cells_hash()).second);
  const Bytes file = chunked_file(1, {5, 2, 4});
  CHECK(reader_of(with_channel(file)).cells_hash() == reader_of(file).cells_hash());
}

TEST_CASE("In a packed file, squares of chunks are stretches of bytes, and pages lie behind all chunks") {
  const Bytes file = packed(chunked_file(2, {40, 40, 9}));
  const GridReader reader = reader_of(file);
  uint64_t last_chunk = 0, first_page = ~uint64_t{0};
  for (const LevelInfo& l : reader.meta().levels()) {
    const LevelShape s = reader.shape(l.level);
    for (uint64_t p = 0; p < s.pages(); ++p) {
      if (l.level != 1) first_page = std::min(first_page, reader.page_place(l.level, p).offset);
      uint64_t from = ~uint64_t{0}, to = 0, bytes = 0;  // a page is a square
      for (const ChunkEntry& e : *reader.page(l.level, p)) {
        if (e.size == 0) continue;
        from = std::min(from, e.offset), to = std::max(to, e.offset + e.size), bytes += e.size;
      }
      if (bytes > 0) REQUIRE(to - from == bytes);
      last_chunk = std::max(last_chunk, to);
    }
  }
  REQUIRE(last_chunk <= first_page);
}

TEST_CASE("Damage is not packed, and leaves no file") {
  const Bytes file = chunked_file();
  for (size_t at = 40; at < file.size() - 200; at += 97) {
    Bytes damaged = file;
    damaged[at] ^= 1;
    const TempFolder folder;
    REQUIRE_THROWS_AS(pack(reader_of(damaged), folder / "p.tcell", {}, [](double) {}), FormatError);
    REQUIRE(std::filesystem::is_empty(folder.path()));
  }
}

}  // namespace
}  // namespace teracell

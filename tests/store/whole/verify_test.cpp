// verify: it passes sound files, and it sees every damage and every lie.
#include "store/whole/verify.hpp"
#include "store/channels/fraction_reader.hpp"
#include "store/channels/link_reader.hpp"
#include "store/format/cell_frames.hpp"
#include "store/runs/chunk_codec.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;

TEST_CASE("A sound file is verified by any number of threads, with shares of 1 that ascend", "[threads]") {
  for (const Bytes& file :
       {meshed_file(), chunked_file(0), chunked_file(1), chunked_file(2), chunked_file(2, {1, 1, 1}), chunked_file(0, {40, 30, 33})}) {
    const GridReader reader = reader_of(file);
    for (const int threads : {1, 2, 5}) {
      double last = 0;
      bool ascending = true;
      verify(reader, threads, [&](double share) {
        ascending &= share >= last && share <= 1;
        last = share;
      });
      REQUIRE(ascending);
    }
  }
}

TEST_CASE("Any single bit flipped in a file is reported by verify, and no wrong cell is ever read") {
  for (Bytes file : {meshed_file(), chunked_file(), with_channel(chunked_file(1, {5, 2, 4}))}) {
    const Levels undamaged = read_everything(reader_of(file));
    for (size_t bit = 0; bit < 8 * file.size(); bit += kStride) {
      file[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
      expect_noticed(file, undamaged, "bit", bit);
      file[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    }
  }
}

TEST_CASE("Any single bit flipped in a file with fractions and links is reported by verify, and no wrong share or link is ever read") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(0, 1, 9);
  mesh_quietly(scene_of(folder, {{shapes::sphere({4, 4, 4}, 3.2, 1)}, {shapes::box({3, 3, 3}, {8.2, 8.3, 8.4}), oracle::Rule::kNonzero, 2}}, grid),
               folder / "g.tcell", {.fractions = Subdivision{2, 2, 4}, .links = true, .chunk_rays = 4});
  const Bytes whole = file_bytes(folder / "g.tcell");
  const auto read = [&](const GridReader& reader) {
    std::pair<std::vector<double>, std::vector<CellLink>> out;
    out.first.resize(729);
    FractionReader(reader).read_box(grid.box(0), 1, 0.0, out.first.data(), {1, 9, 81});
    for (int d = 0; d < 3; ++d)
      LinkReader(reader).for_each(d, grid.box(0),
                                  [&](std::span<const CellLink> found) { out.second.insert(out.second.end(), found.begin(), found.end()); });
    return out;
  };
  const auto undamaged = read(reader_of(whole));
  REQUIRE(undamaged.second.size() > 200);
  Bytes file = whole;
  size_t missed = 0, wrong = 0;
  for (size_t bit = 0; bit < 8 * file.size(); bit += kStride) {
    file[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    try {
      verify_quietly(reader_of(file));
      ++missed;
    } catch (const FormatError&) {
    }
    try {
      wrong += read(reader_of(file)) != undamaged;
    } catch (const FormatError&) {
    }
    file[bit / 8] = whole[bit / 8];
  }
  CHECK(missed == 0);
  CHECK(wrong == 0);
}

TEST_CASE("A block of a file overwritten, or two of them swapped, is reported by verify") {
  const Bytes file = chunked_file(2, {9, 9, 9});
  const Levels undamaged = read_everything(reader_of(file));
  std::mt19937_64 random(8);
  for (int round = 0; round < 300; ++round) {
    Bytes damaged = file;
    const size_t size = random() % 64 + 1, a = random() % (file.size() - size), b = random() % (file.size() - size);
    if (round % 2 == 0) std::fill_n(damaged.begin() + static_cast<ptrdiff_t>(a), size, uint8_t{0});
    else
      std::swap_ranges(damaged.begin() + static_cast<ptrdiff_t>(std::min(a, b)),
                       damaged.begin() + static_cast<ptrdiff_t>(std::min(a, b) + std::min(size, std::max(a, b) - std::min(a, b))),
                       damaged.begin() + static_cast<ptrdiff_t>(std::max(a, b)));
    if (damaged != file) expect_noticed(damaged, undamaged, "round", static_cast<size_t>(round));
  }
}

TEST_CASE("A file taken apart and put together without a lie is sound") {
  for (const Bytes& file : {meshed_file(), chunked_file()}) {
    const Bytes again = forge(file, {});
    REQUIRE_NOTHROW(verify_quietly(reader_of(again)));
    REQUIRE(read_everything(reader_of(again)) == read_everything(reader_of(file)));
  }
}

TEST_CASE("Bytes that nothing names, or that two things name, are found by verify") {
  const Bytes file = chunked_file();
  expect_verify_refuses(forge(file, {.gap = 1}), "belongs to nothing");
  expect_verify_refuses(forge(file, {.gap = 1000}), "belongs to nothing");
  expect_verify_refuses(forge(file, {.directory =
                                         [](int, std::vector<DirectoryEntry>& pages) {
                                           if (pages.size() > 1) pages[1] = pages[0];
                                         }}),
                        "");
  bool done = false;
  const auto share_a_frame = [&](int, std::vector<ChunkEntry>& entries) {
    ChunkEntry* first = nullptr;
    for (ChunkEntry& e : entries) {
      if (e.size == 0 || done) continue;
      if (first != nullptr) e.offset = first->offset, e.size = first->size, e.checksum = first->checksum, e.stats = first->stats, done = true;
      first = &e;
    }
  };
  const Bytes shared = forge(file, {.page = share_a_frame});
  REQUIRE(done);
  expect_verify_refuses(shared, "");
}

TEST_CASE("A cover that lies is refused when the file is opened, or by verify") {
  const Bytes file = chunked_file();
  const auto says = [&](const std::function<void(Channel&)>& lie) {
    return with_channel(file, {.metadata = [=](Metadata& m) { lie(m.channels[1]); }});
  };
  const uint64_t size = with_channel(file).size();
  REQUIRE_THROWS_WITH(reader_of(says([](Channel& c) { c.frames = 0; })), Catch::Contains("at least one frame"));
  for (const uint64_t count :
       {uint64_t{1}, uint64_t{2}, uint64_t{4}, size, size / kDirectoryEntry, uint64_t{1} << 32, uint64_t{1} << 61, ~uint64_t{0}})
    REQUIRE_THROWS_AS(reader_of(says([&](Channel& c) { c.frames = count; })), FormatError);
  for (const uint64_t offset : {uint64_t{0}, size - 1, size, size + 1, uint64_t{1} << 63, ~uint64_t{0} - 7, ~uint64_t{0}})
    REQUIRE_THROWS_AS(reader_of(says([&](Channel& c) { c.cover = offset; })), FormatError);
  REQUIRE_THROWS_WITH(reader_of(says([](Channel& c) { c.cover -= 1; })), Catch::StartsWith("memory.tcell: "));

  const auto lists = [&](const std::function<void(std::vector<DirectoryEntry>&)>& lie) {
    return with_channel(file, {.cover = [=](const std::string&, std::vector<DirectoryEntry>& frames) { lie(frames); }});
  };
  expect_verify_refuses(lists([](auto& frames) { frames.pop_back(); }), "belongs to nothing");
  expect_verify_refuses(lists([](auto& frames) { frames[1] = frames[0]; }), "two things");
  expect_verify_refuses(lists([](auto& frames) { frames[0].offset -= 1; }), "two things");
  expect_verify_refuses(lists([](auto& frames) { frames[2].size += 1; }), "two things");
  expect_verify_refuses(lists([](auto& frames) { frames[0].size -= 1; }), "checksum");
  expect_verify_refuses(lists([](auto& frames) { frames[1].size = 0; }), "a frame has bytes");
  expect_verify_refuses(lists([](auto& frames) { frames[1].checksum ^= 1; }), "channel 'fractions' frame 1");
  for (const uint64_t bad : {size, uint64_t{1} << 63, ~uint64_t{0}}) {
    expect_verify_refuses(lists([=](auto& frames) { frames[0].offset = bad; }), "outside");
    expect_verify_refuses(lists([=](auto& frames) { frames[0].size = bad; }), "outside");
  }
  expect_verify_refuses(with_channel(file, {.metadata = [](Metadata& m) { m.channels.push_back(m.channels[1]); }}), "two things");
}

TEST_CASE("Sums, statistics, coarse sets and hashes that lie are found by verify") {
  const Bytes file = chunked_file();
  const std::string hash = verify(reader_of(file), 1, [](double) {});
  const auto with_hash = [&](const std::string& told) { return forge(file, {.metadata = [=](Metadata& m) { m.labels_hash = told; }}); };
  CHECK_NOTHROW(verify_quietly(reader_of(with_hash(hash))));
  expect_verify_refuses(with_hash(std::string(32, '0')), "the labels of all cells have the hash " + hash);
  CHECK_THROWS_WITH(reader_of(with_hash("0f")), Catch::Contains("FORMAT.md 7.11"));
  for (const int which : {0, 1, 2})
    expect_verify_refuses(forge(file, {.metadata =
                                           [&](Metadata& m) {
                                             ++(which == 0 ? m.levels()[0].chunks : which == 1 ? m.levels()[1].bytes : m.levels()[0].changes);
                                           }}),
                          "the metadata counts");
  for (const bool cells : {true, false})
    expect_verify_refuses(forge(file, {.metadata =
                                           [&](Metadata& m) {
                                             if (cells) --m.amounts[0].cells, ++m.amounts[1].cells;
                                             else m.amounts[1].box = m.grid.box(0);
                                           }}),
                          cells ? "label 0: the metadata says" : "label 1: the metadata says");
  expect_verify_refuses(forge(file, {.page =
                                         [](int level, std::vector<ChunkEntry>& entries) {
                                           for (ChunkEntry& e : entries)
                                             if (level == 0 && !e.stats.empty()) e.stats[0].cells += 1;
                                         }}),
                        "statistics");
  expect_verify_refuses(forge(file, {.page =
                                         [](int level, std::vector<ChunkEntry>& entries) {
                                           for (ChunkEntry& e : entries)
                                             if (level == 4 && e.size == 0) e.uniform = {0};
                                         }}),
                        "sets");
  expect_verify_refuses(forge(file, {.footer = [](Footer& f) { f.hash[15] ^= 1; }}), "content hash");
}

// What the check of a kind was called for and the frames that it read. (A check is a plain function: it captures nothing.)
std::string checked;

void check_fractions(const GridReader& reader, const Channel& channel, const std::function<Bytes(uint64_t)>& frame) {
  checked = fmt::format("{} of {} labels:", channel.name, reader.meta().labels.size());
  for (uint64_t i = 0; i < channel.frames; ++i) checked += ' ' + decode_text(frame(i), "frame");
  if (checked.find("all of it") != checked.npos) throw FormatError("a fraction of 1");
}

TEST_CASE("A channel of a known kind and coding is checked by its kind, any other one as bytes") {
  const auto file = [](const std::string& coding, const std::string& last) {
    return forge(chunked_file(), {.metadata = [=](Metadata& m) { m.channels[1].coding = coding; },
                                  .channels = {{"fractions", {encode_text("half"), encode_text(last)}}}});
  };
  constexpr ChannelKind kKinds[] = {{kLabels, kRuns, nullptr}, {"fractions", "text", check_fractions}};
  const auto verify_with_kinds = [&](const Bytes& bytes) {
    verify(
        reader_of(bytes), 1, [](double) {}, kKinds);
  };
  REQUIRE_NOTHROW(verify_with_kinds(file("text", "a quarter")));
  REQUIRE(checked == "fractions of 3 labels: half a quarter");
  REQUIRE_THROWS_WITH(verify_with_kinds(file("text", "all of it")), "memory.tcell: a fraction of 1");
  checked.clear();
  REQUIRE_NOTHROW(verify_with_kinds(file("other", "all of it")));
  REQUIRE_NOTHROW(verify_quietly(reader_of(file("text", "all of it"))));
  REQUIRE(checked.empty());
}

// A file with links that were changed on the way, under right checksums.
Bytes with_links(const Bytes& plain, const ChunkLinks& links) {
  const Metadata meta = reader_of(plain).meta();
  CellFrames frames(meta);
  std::vector<Bytes> all;
  if (!links.empty()) all.push_back(LinksEncoder().encode(links));
  const auto page = frames.put({0, 0, 0, 0}, all.empty() ? kNoFrame : 0, all.size());
  if (!page->empty()) all.push_back(*page);
  for (const Bytes& list : frames.lists()) all.push_back(list);
  return forge(plain, {.channels = {{kLinks, all, kDistances}}});
}

TEST_CASE("Links that are not where labels change are reported by verify", "[links]") {
  const TempFolder folder;
  const mesher::Scene scene = scene_of(folder, {{shapes::sphere({4, 4, 4}, 3.2, 1)}}, cube_grid_of(0, 1, 9));
  mesher::MeshOptions options;
  mesh_quietly(scene, folder / "plain.tcell", options);
  options.links = true;
  mesh_quietly(scene, folder / "g.tcell", options);
  const Bytes plain = file_bytes(folder / "plain.tcell");
  const GridReader reader(folder / "g.tcell");
  const ChunkLinks sound = *LinkReader(reader).chunk({0, 0, 0, 0});
  REQUIRE_NOTHROW(verify_quietly(reader_of(with_links(plain, sound))));
  for (int axis_of_link = 0; axis_of_link < 3; ++axis_of_link) {
    const auto d = static_cast<size_t>(axis_of_link);
    ChunkLinks fewer = sound, moved = sound;
    fewer.along[d].pop_back();
    expect_verify_refuses(with_links(plain, fewer), "but there are");
    moved.along[d].front().cell -= 1;
    expect_verify_refuses(with_links(plain, moved), "between cells with the same label");
  }
  expect_verify_refuses(with_links(plain, {sound.nu, sound.nv, sound.length, {}}), "has no frame");
}

TEST_CASE("Fractions of files before version 3.2 are read and verified, and damage to them is found", "[fractions]") {
  const TempFolder folder;
  const mesher::Scene scene = scene_of(folder, {{shapes::sphere({4, 4, 4}, 3.2, 2)}}, cube_grid_of(0, 1, 9));
  mesher::MeshOptions options;
  mesh_quietly(scene, folder / "plain.tcell", options);
  options.fractions = Subdivision{2, 4, 8};
  mesh_quietly(scene, folder / "new.tcell", options);
  const GridReader reader(folder / "new.tcell");
  const FractionReader fractions(reader);
  const MixedCells cells = *fractions.chunk({0, 0, 0, 0});
  const auto channel = [&](const Bytes& frame, const char* coding) {
    CellFrames frames(reader.meta());
    std::vector<Bytes> all = {frame};
    if (const auto page = frames.put({0, 0, 0, 0}, 0, 1); !page->empty()) all.push_back(*page);
    for (const Bytes& list : frames.lists()) all.push_back(list);
    return ForgedChannel{kFractions, all, coding, fractions_channel(*options.fractions).about};
  };
  const auto with = [&](const std::vector<ForgedChannel>& channels) { return forge(file_bytes(folder / "plain.tcell"), {.channels = channels}); };
  const ForgedChannel of_old = channel(old_mixed_frame(cells), kShares), of_new = channel(MixedCellsEncoder().encode(cells), kStretches);
  const GridReader old = reader_of(with({of_old}));
  REQUIRE_NOTHROW(verify_quietly(old));
  for (const auto& both : {std::vector{of_old, of_new}, std::vector{of_new, of_old}}) REQUIRE_NOTHROW(verify_quietly(reader_of(with(both))));
  const MixedCells back = *FractionReader(old).chunk({0, 0, 0, 0});
  REQUIRE(back.begin == cells.begin);
  REQUIRE(back.counts == cells.counts);
  expect_verify_refuses(with({channel(MixedCellsEncoder().encode(cells), kShares)}), "(FORMAT.md 13.2)");
  expect_verify_refuses(with({channel(old_mixed_frame(cells), kStretches)}), "(FORMAT.md 13.5)");
}

TEST_CASE("Frames that are named twice, and bytes that are counted wrong, are reported by verify", "[fractions]") {
  const TempFolder folder;
  mesh_quietly(scene_of(folder, {{shapes::sphere({4, 4, 4}, 3.2, 1)}}, cube_grid_of(0, 1, 9)), folder / "plain.tcell", {});
  const Bytes plain = file_bytes(folder / "plain.tcell");
  const std::string about = fractions_channel({1, 1, 1}).about;
  const Bytes list = encode_cell_list(std::vector<uint64_t>{0}), page = encode_cell_page({kNoFrame}, 0);
  expect_verify_refuses(forge(plain, {.channels = {{kFractions, {page, page, list}, kStretches, about}}}), "but its pages name 2");
  expect_verify_refuses(forge(plain, {.channels = {{kFractions, {encode_cell_list(std::vector<uint64_t>{0})}, kStretches, about}}}), "named twice");
  expect_verify_refuses(
      forge(plain, {.metadata = [](Metadata& m) { m.channels[1].bytes = 7; }, .channels = {{kFractions, {page, list}, kStretches, about}}}),
      "counts 7 bytes");
}

}  // namespace
}  // namespace teracell

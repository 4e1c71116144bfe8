// Files that say too much, under right checksums: refused when they are opened, or when they are verified and read; and what
// the longest report that is allowed costs.
#include "store/runs/chunk_codec.hpp"
#include "store/whole/info.hpp"
#include "tests/support/assembled.hpp"
#include "tests/support/peak.hpp"
#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;

Bytes with_report(const Bytes& file, const std::string& report) {
  return forge(file, {.bytes = [&](FilePart part, Bytes& body) {
                 if (part == FilePart::kReport) body.assign(report.begin(), report.end());
               }});
}

Bytes with_metadata_text(const Bytes& file, const std::function<void(std::string&)>& edit) {
  return forge(file, {.bytes = [&](FilePart part, Bytes& body) {
                 if (part != FilePart::kMetadata) return;
                 std::string text(body.begin(), body.end());
                 edit(text);
                 body.assign(text.begin(), text.end());
               }});
}

// JSON of so many bytes that no reader takes for tiny: an array of objects that differ.
std::string report_of(size_t bytes) {
  std::string text = "[";
  for (int i = 0; text.size() + 600 < bytes; ++i)
    text +=
        fmt::format(R"({{"name":"body-{}","at":[{},{},0.5],"text":"{}"}},)", i, i * 7919 % 100'003, i * 104'729 % 1'299'709, std::string(400, 'x'));
  text += '"' + std::string(bytes - text.size() - 3, 'y') + "\"]";
  return text;
}

TEST_CASE("A small file whose report or metadata become very long is refused") {
  const Bytes file = chunked_file();
  const std::string blanks(60u << 20, ' ');
  const Bytes report = with_report(file, "{}" + blanks);
  REQUIRE(report.size() < file.size() + 10'000);
  expect_verify_refuses(report, "report: expected a zstd frame of at most 1048576 bytes, as its own size is");
  REQUIRE_THROWS_WITH(info_json(reader_of(report)), Catch::StartsWith("memory.tcell: report: expected a zstd frame of at most"));
  REQUIRE_THROWS_WITH(reader_of(with_metadata_text(file, [&](std::string& text) { text += blanks; })),
                      Catch::StartsWith("memory.tcell: metadata: expected a zstd frame of at most 1048576 bytes"));
  const std::string mebibyte(1u << 20, ' ');
  REQUIRE_NOTHROW(verify_quietly(reader_of(with_report(file, "{}" + mebibyte.substr(2)))));
  expect_verify_refuses(with_report(file, "{}" + mebibyte), "report: expected a zstd frame of at most 1048576 bytes");
}

TEST_CASE("A report that is no JSON, too deep, not ASCII, or has a key twice is refused by verify and by info") {
  const Bytes file = chunked_file();
  const auto refused = [&](const std::string& report, const std::string& because) {
    const Bytes forged = with_report(file, report);
    expect_verify_refuses(forged, because);
    REQUIRE_THROWS_WITH(info_json(reader_of(forged)), Catch::StartsWith("memory.tcell: report: byte ") && Catch::Contains(because));
  };
  refused("", "expected JSON");
  refused("{} {}", "the end of the text");
  refused(R"({"bodies":[],"bodies":[]})", "twice");
  refused(R"({"a":{"b":1,"\u0062":2}})", "twice");
  refused(std::string(65, '[') + std::string(65, ']'), "at most 64 levels");
  refused(std::string(500'000, '['), "at most 64 levels");
  refused("{\"a\":\"\xc3\xbc\"}", "ASCII");
  refused("{\"a\":\"\xff\"}", "ASCII");
  refused("{\"a\":1e999}", "a double can hold");
}

TEST_CASE("Names, units and their sums are bounded in files, and in what is written") {
  const Bytes file = chunked_file();
  const std::string longest(256, 'n'), longer = longest + 'n';
  const auto refused = [&](const std::function<void(Metadata&)>& lie, const std::string& because) {
    REQUIRE_THROWS_WITH(reader_of(forge(file, {.metadata = lie})), Catch::StartsWith("memory.tcell: metadata: ") && Catch::Contains(because));
    Metadata meta = metadata_of(unit_grid({3, 3, 3}), 2, 3);
    lie(meta);
    const TempFolder folder;
    REQUIRE_THROWS_WITH(GridWriter(folder / "g.tcell", meta), Catch::Contains(because));
  };
  const auto with_names = [&](Metadata& m) {
    m.units = m.materials[1].name = m.labels[2].body = longest;
    m.labels_hash.clear();  // it is of other names
  };
  REQUIRE_NOTHROW(verify_quietly(reader_of(forge(file, {.metadata = with_names}))));
  refused([&](Metadata& m) { m.materials[1].name = longer; }, "names of at most 256 bytes, found one of 257: 'nnn");
  refused([&](Metadata& m) { m.labels[2].body = longer; }, "names of at most 256 bytes");
  refused([&](Metadata& m) { m.units = longer; }, "names of at most 256 bytes");
  refused([&](Metadata& m) { m.channels.push_back({longer, "", false, {}, 1, 1}); }, "names of at most 256 bytes");
  if (kSanitized) return;  // what follows has 10 MB of names
  refused([&](Metadata& m) { m.materials[1].name.assign(10'000'000, 'n'); }, "found one of 10000000: 'nnn");
  refused(
      [&](Metadata& m) {
        for (uint32_t i = 3; i < (1 << 22) / 256 + 3; ++i) m.materials.push_back({longest, "#000000", i});
        for (uint32_t i = 0; i < m.materials.size(); ++i) m.materials[i].rank = static_cast<uint32_t>(m.materials.size()) - 1 - i;
      },
      "at most 4194304 bytes of names");
  refused(
      [&](Metadata& m) {
        std::vector<double> planes(kMostMetadataValues);
        for (size_t i = 0; i < planes.size(); ++i) planes[i] = static_cast<double>(i);
        m.grid.axis[0] = Axis::graded(planes, 0.5);
      },
      "values");
}

TEST_CASE("Metadata of too many values are refused before they take memory, and so is a key that occurs twice") {
  const Bytes file = chunked_file();
  std::mt19937_64 random(1);
  std::string values;
  for (int i = 0; i < 1 << 20; ++i) values += fmt::format("{},", random() % 10);
  REQUIRE_THROWS_WITH(reader_of(with_metadata_text(file, [&](std::string& text) { text.insert(1, "\"new\":[" + values + "0],"); })),
                      "memory.tcell: metadata: expected JSON of at most 1048576 values, found more");
  REQUIRE_THROWS_WITH(reader_of(with_metadata_text(file, [&](std::string& text) { text.insert(1, "\"units\":\"km\","); })),
                      "memory.tcell: metadata: units: this key is given twice: keep one of them");
}

TEST_CASE("As many values as metadata may have are read in bounded memory, whatever they are") {
  if (kSanitized) return;  // their own memory counts, too
  const Bytes file = chunked_file();
  std::mt19937_64 random(1);
  for (const auto& [value, number] : {std::pair(R"({{"a":{}}},)", 2), {"[{}],", 2}, {"{},", 1}}) {
    std::string values;
    for (int i = 0; i < 1'040'000 / number; ++i) values += fmt::format(fmt::runtime(value), random() % 10);
    const Bytes forged = with_metadata_text(file, [&](std::string& text) { text.insert(1, "\"new\":[" + values + "0],"); });
    INFO(value);
    CHECK(peak_memory_of([&] { REQUIRE_NOTHROW(reader_of(forged)); }) < int64_t{160} << 20);
  }
}

TEST_CASE("Messages about metadata are short, whatever is in them") {
  const Bytes file = chunked_file();
  const std::string lie = '"' + std::string(900'000, 'q') + '"';
  for (const char* place : {"\"ray_axis\":\"y\"", "\"coding\":\"runs\"", "\"cells\":4", "\"type\":\"uniform\""}) {
    INFO(place);
    const Bytes forged = with_metadata_text(file, [&](std::string& text) {
      const std::string_view key(place, std::string_view(place).find(':') + 1);
      const size_t at = text.find(place);
      REQUIRE(at != std::string::npos);
      text.replace(at, std::string_view(place).size(), std::string(key) + lie);
    });
    try {
      reader_of(forged);
      FAIL("was opened");
    } catch (const FormatError& e) {
      CHECK(std::string(e.what()).size() < 1000);
    }
  }
}

TEST_CASE("A text that zstd makes hundreds of times smaller is written so that it may be read") {
  std::string text;
  while (text.size() < size_t{60} << 20) text += R"({"name":"body","facets":12,"degenerate":0,"duplicates":0,"opposite":0,"shells":1,"holes":[]},)";
  const Bytes frame = encode_text(text);
  CHECK(frame.size() > text.size() / 256);
  CHECK(frame.size() < text.size() / 50);
  CHECK(decode_text(frame, "text") == text);
}

TEST_CASE("The longest report that is allowed is answered in little more memory than its text takes") {
  if (kSanitized) return;  // their own memory counts, too
  const Bytes file = with_report(chunked_file(), report_of(kMostText));
  const GridReader reader = reader_of(file);
  size_t length = 0;
  const int64_t peak = peak_memory_of([&] { length = info_json(reader, "g").size(); });
  CHECK(length > kMostText);
  CHECK(peak < int64_t{96} << 20);
  CHECK(peak_memory_of([&] { verify_quietly(reader); }) < int64_t{96} << 20);
  expect_verify_refuses(with_report(chunked_file(), report_of(kMostText + 1)), "report: expected a zstd frame of at most 67108864 bytes");
}

TEST_CASE("A small frame can't become a large chunk, and an honest chunk that shrinks too much is compressed less") {
  RayBlock plates;
  plates.reset(64, 64, 1000);
  std::vector<SetId> sets = {0};
  std::vector<uint32_t> changes;
  for (uint32_t i = 1; i <= 200; ++i) sets.push_back(i % 2), changes.push_back(4 * i);
  for (int ray = 0; ray < 64 * 64; ++ray) plates.append(sets, changes);
  const Bytes frame = ChunkEncoder().encode(plates, SetTable(2));
  CHECK(frame.size() > plates.at.size() / 5 / 256);  // five changes in a byte of the body
  CHECK(frame.size() < plates.at.size() / 50);
  Chunk again;
  ChunkDecoder().decode(frame, 64, 64, 1000, 2, again);
  CHECK(again.rays.at == plates.at);
  const Bytes zeros((1 << 16) + 1, 0), small = squeezed(zeros);
  REQUIRE_THROWS_WITH(ChunkDecoder().decode(small, 64, 64, 1000, 2, again), Catch::StartsWith("chunk: expected a zstd frame of at most 65536 bytes"));
  REQUIRE_THROWS_WITH(decode_page(small, 1, false, 2), Catch::StartsWith("index page: expected a zstd frame of at most 65536 bytes"));
}

TEST_CASE("A frame that two chunks name is refused when the second of them is read, and so is a page that stands for two") {
  const Bytes file = chunked_file();
  const auto read_all = [](const GridReader& reader) { level_as_read(reader, 0); };
  const GridReader chunks = reader_of(forge(file, {.page = [](int level, std::vector<ChunkEntry>& entries) {
                                              if (level != 0) return;
                                              const auto first = std::ranges::find_if(entries, [](const ChunkEntry& e) { return e.size != 0; });
                                              for (ChunkEntry& e : entries)
                                                if (e.size != 0 && first != entries.end()) e = *first;
                                            }}));
  REQUIRE_THROWS_WITH(read_all(chunks), Catch::StartsWith("memory.tcell: level 0 chunk (") &&
                                            Catch::EndsWith("belongs to two things that the index names (FORMAT.md 3.4)"));
  const GridReader pages = reader_of(forge(file, {.directory = [](int, std::vector<DirectoryEntry>& entries) {
                                             for (DirectoryEntry& e : entries) e = entries[0];
                                           }}));
  REQUIRE_THROWS_WITH(read_all(pages),
                      Catch::StartsWith("memory.tcell: ") && Catch::EndsWith("belongs to two things that the index names (FORMAT.md 3.4)"));
}

}  // namespace
}  // namespace teracell

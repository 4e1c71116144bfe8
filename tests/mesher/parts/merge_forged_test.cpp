// Parts that lie under right checksums are refused by words, whoever reads them.
#include "mesher/parts/merge.hpp"
#include "mesher/run/checkpoint.hpp"
#include "mesher/run/part_found.hpp"
#include "store/base/error.hpp"
#include "store/format/metadata_json.hpp"
#include "store/whole/verify.hpp"
#include "store/write/part.hpp"
#include "tests/support/forged_part.hpp"
#include "tests/support/parts.hpp"
#include "tests/support/stored.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

// What the records of a part say, as records again.
class Records : public PartTaker {
 public:
  std::vector<Bytes> chunks, children;  // of uniform chunks, and of children
  explicit Records(const PartReader& part) : meta_(part.head().meta) { part.replay(*this); }
  void bytes(uint64_t) override {}
  void page(const LevelInfo&, uint64_t, uint64_t, uint64_t) override {}
  void chunk(const ChunkKey& key, ChunkEntry&& entry, uint64_t) override {
    if (entry.size != 0) return;
    put_entry(begin(chunks, 0, {key.level, key.cu, key.cv, key.segment, 0}), entry, key.level == 0);
  }
  void cells(size_t, const ChunkKey&, uint64_t, uint64_t) override {}
  void frame(size_t, uint64_t, uint64_t) override {}
  void cells_page(size_t, uint64_t, uint64_t, uint64_t) override {}
  void child(int level, uint32_t cu, uint32_t cv, Chunk&& rays) override {
    put_child(begin(children, 2, {level, cu, cv, rays.rays.nu, rays.rays.nv, rays.rays.length}), rays);
  }
  // A child that says that it lies elsewhere.
  static Bytes child_at(int level, const Chunk& rays) {
    std::vector<Bytes> out;
    put_child(begin(out, 2, {level, 0, 0, rays.rays.nu, rays.rays.nv, rays.rays.length}), rays);
    return out[0];
  }

 private:
  static Bytes& begin(std::vector<Bytes>& out, uint8_t kind, std::initializer_list<int64_t> numbers) {
    Bytes& record = out.emplace_back(Bytes{kind, 0});
    for (const int64_t n : numbers) put_varint(record, static_cast<uint64_t>(n));
    return record;
  }
  static void put_child(Bytes& record, const Chunk& rays) {
    const Bytes frame = ChunkEncoder().encode(rays.rays, rays.sets);
    put_varint(record, frame.size());
    record.insert(record.end(), frame.begin(), frame.end());
  }
  const Metadata& meta_;
};

Chunk uniform_rays(uint32_t nu, uint32_t nv, uint32_t length) {
  Chunk chunk{{}, SetTable(3)};
  chunk.rays.fill(nu, nv, length, 0);
  return chunk;
}

// Three parts of a small grid, which has index pages in one part and in several.
class ThreeParts {
 public:
  ThreeParts() {
    const Grid grid{{Axis::uniform(-5, 0.05, 0, 200, 0.5), Axis::uniform(-5, 0.05, 0, 200, 0.5), Axis::uniform(-5, 0.5, 0, 20, 0.5)}};
    auto open = shapes::torus({0, 0, 1}, 3, 1.5, 20, 12);
    open.pop_back();
    const Scene scene = scene_of(folder, {{shapes::sphere({0, 0, 0}, 4, 2)}, {open, oracle::Rule::kNonzero, 2}}, grid);
    paths = make_parts(scene, output(), {.axis = 2, .thin = true, .chunk_rays = 4}, 3);
    for (const auto& path : paths) sections.push_back(take_apart(file_bytes(path)));
  }
  std::filesystem::path output() const { return folder / "g.tcell"; }
  // Merges the parts, of which this one is forged.
  void merge_with(size_t part, const PartSections& lie) const {
    std::vector<std::filesystem::path> all = paths;
    all[part] = folder / "forged";
    write_bytes(all[part], put_together(lie));
    try {
      verify(PartReader(all[part]));  // may pass: it knows nothing of the other parts
    } catch (const FormatError& e) {
      CHECK_THAT(e.what(), Catch::Contains("forged"));
    }
    merge(all, output(), kSilent, kGoOn);
  }
  void refused(size_t part, const PartSections& lie, const std::string& words) const {
    CHECK_THROWS_WITH(merge_with(part, lie), Catch::Contains(words));
    CHECK_FALSE(std::filesystem::exists(output()));
    CHECK_FALSE(std::filesystem::exists(output().string() + ".partial"));
  }

  const TempFolder folder;
  std::vector<std::filesystem::path> paths;
  std::vector<PartSections> sections;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  REQUIRE(text.find(from) != std::string::npos);
  return text.replace(text.find(from), from.size(), to);
}

Bytes before(const Bytes& records, const Bytes& more) {
  Bytes out = more;
  out.insert(out.end(), records.begin(), records.end());
  return out;
}

}  // namespace

TEST_CASE("A part that is taken apart and put together is the same", "[parts]") {
  const ThreeParts parts;
  for (size_t i = 0; i < 3; ++i) CHECK(put_together(parts.sections[i]) == file_bytes(parts.paths[i]));
  CHECK_NOTHROW(parts.merge_with(1, parts.sections[1]));
}

TEST_CASE("A forged head of a part is refused", "[parts]") {
  const ThreeParts parts;
  PartSections lie = parts.sections[1];
  for (const char* head :
       {"", "{", "7", "[]", "{}", R"({"run":7,"part":1,"parts":3,"first":0,"end":1})", R"({"run":"{}","part":-1,"parts":3,"first":0,"end":1})",
        R"({"run":"{}","part":1e300,"parts":3,"first":0,"end":1})", R"({"run":"{}","part":3,"parts":3,"first":0,"end":1})",
        R"({"run":"{}","part":1,"parts":3,"first":2,"end":1})", R"({"run":"{}","part":1,"parts":99999999999,"first":0,"end":1})"}) {
    INFO(head);
    lie.head = head;
    CHECK_THROWS_AS(parts.merge_with(1, lie), FormatError);
    parts.refused(1, lie, "forged: ");
  }
  lie = parts.sections[1];
  lie.metadata = "{}";
  parts.refused(1, lie, "forged: metadata");
  lie.metadata = replaced(parts.sections[1].metadata, R"("cells":200)", R"("cells":199)");
  parts.refused(1, lie, "another grid");
}

TEST_CASE("However parts describe their run, two descriptions are compared", "[parts]") {
  CHECK(difference(R"({"a":1,"b":2})", R"({"a":1,"b":3})") == "b was 2 and is 3 now");
  for (const char* other : {"", "{", "7", R"({"b":2,"a":1})", "[[[["})
    CHECK_THAT(difference(R"({"a":1,"b":2})", other), Catch::Contains("another way"));
  const std::string deep(100000, '[');
  CHECK_THAT(difference(deep, deep + "1"), Catch::Contains("another way"));
}

TEST_CASE("Parts whose number of parts or of index pages is forged take no memory for it", "[parts]") {
  const ThreeParts parts;
  PartSections lie = parts.sections[0];
  lie.head = replaced(lie.head, R"("parts":3)", R"("parts":4294967295)");
  write_bytes(parts.folder / "one", put_together(lie));
  CHECK_THROWS_WITH(merge({parts.folder / "one"}, parts.output(), kSilent, kGoOn), Catch::Contains("and 4294967274 more are missing"));

  lie = parts.sections[0];
  lie.head = replaced(lie.head, R"("parts":3)", R"("parts":1)");
  lie.head = lie.head.substr(0, lie.head.rfind(R"("end":)")) + fmt::format(R"("end":{}}})", TreeRange().end);
  Metadata meta = PartReader(parts.paths[0]).head().meta;
  meta.grid.axis[0] = meta.grid.axis[1] = Axis::uniform(0, 1, 0, 999999, 0.5);
  while (meta.levels().back().level + 1 < meta.grid.levels()) meta.levels().push_back({meta.levels().back().level + 1, 0, 0, 0, 0});
  lie.metadata = decode_text(encode_metadata(meta), "metadata");
  write_bytes(parts.folder / "huge", put_together(lie));
  CHECK_THROWS_WITH(merge({parts.folder / "huge"}, parts.output(), kSilent, kGoOn), Catch::Contains("index pages"));
}

TEST_CASE("Forged records of a part are refused", "[parts]") {
  const ThreeParts parts;
  const PartSections& honest = parts.sections[1];
  const Records records{PartReader(parts.paths[1])};
  REQUIRE_FALSE(records.chunks.empty());
  REQUIRE_FALSE(records.children.empty());
  PartSections lie = honest;
  const auto with = [&](const Bytes& record) {
    lie.records = before(honest.records, record);
    return lie;
  };
  const int top = PartReader(parts.paths[1]).head().meta.grid.levels() - 1;
  for (const int level : {0, 3, top, top - top % 2})
    if (level % 2 != 0 || level == 0 || level == top)
      parts.refused(1, with(Records::child_at(level, uniform_rays(2, 2, 10))), "a level that has parents");
  for (const auto& rays : {uniform_rays(1, 2, 3), uniform_rays(2, 1, 3), uniform_rays(2, 2, 4)})
    parts.refused(1, with(Records::child_at(2, rays)), "rays and cells of its place");
  parts.refused(1, with(records.children.front()), "is there twice");
  parts.refused(1, with(records.chunks.front()), "a chunk is there twice");
  lie.records = {3};
  put_varint(lie.records, honest.grid.size());
  parts.refused(1, lie, "lacks chunks");
}

TEST_CASE("What a part says was found must fit its grid", "[parts]") {
  const ThreeParts parts;
  const auto refused = [&](size_t part, const std::string& words, auto&& change) {
    PartFound found = decode_found(parts.sections[part].found, "found");
    change(found);
    PartSections lie = parts.sections[part];
    lie.found = encode_found(found.totals, found.surfaces ? &*found.surfaces : nullptr);
    INFO(words);
    parts.refused(part, lie, words);
  };
  using What = TallyKey::What;
  const auto tally = [](PartFound& found, What what, uint32_t of, uint8_t axis, Index3 cell) {
    found.totals.tallies.add({what, of, axis}, {1, 1e300, kSubPositions, 0, cell});
  };
  refused(1, "other bodies", [](PartFound& f) { f.totals.cells.pop_back(), f.totals.covered.pop_back(); });
  refused(1, "counts something else", [&](PartFound& f) { tally(f, What::kPairs, 0, 3, {0, 0, 0}); });
  refused(1, "counts something else", [&](PartFound& f) { tally(f, static_cast<What>(9), 0, 0, {0, 0, 0}); });
  refused(1, "counts in something else", [&](PartFound& f) { tally(f, What::kStretches, 2, 0, {0, 0, 0}); });
  refused(1, "counts in something else", [&](PartFound& f) { tally(f, What::kGaps, 3, 0, {0, 0, 0}); });
  refused(1, "lies outside", [&](PartFound& f) { tally(f, What::kPairs, 0, 2, {0, 0, 19}); });
  refused(1, "lies outside", [&](PartFound& f) { tally(f, What::kPairs, 0, 2, {-1, 0, 0}); });
  refused(1, "another length", [&](PartFound& f) { tally(f, What::kGaps, 1, 2, {0, 0, 0}); });
  const auto overlap = [](PartFound& found, uint32_t other, int64_t end) {
    OverlapPacker packer;
    packer.put({{0, other}, false, 1, {{0, 0, end - 1}, {1, 1, end}}, {0, 0, end - 1}});
    found.totals.overlaps.add(packer.take());
  };
  refused(1, "not there overlap", [&](PartFound& f) { overlap(f, 2, 1); });
  refused(1, "overlap outside", [&](PartFound& f) { overlap(f, 1, 100); });
  refused(0, "found none", [](PartFound& f) { f.surfaces.reset(); });
  refused(0, "other bodies", [](PartFound& f) { f.surfaces->counts.pop_back(); });
  refused(0, "other bodies", [](PartFound& f) { f.surfaces->bodies.bodies.pop_back(); });
  refused(0, "other bodies", [](PartFound& f) { f.surfaces->scene.bodies.pop_back(); });
  refused(0, "another axis", [](PartFound& f) { f.surfaces->rays.axis = 1000; });
  refused(0, "fill rule", [](PartFound& f) { f.surfaces->bodies.bodies[0].closed.fill.at(0).rule = static_cast<Fill>(99); });
}

}  // namespace teracell::mesher

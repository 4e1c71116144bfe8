// Metadata: to JSON and back, damaged, with strange channels, and with numbers that lie.
#include "store/format/metadata_json.hpp"

#include "store/format/format.hpp"
#include "tests/support/stored.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;
using nlohmann::ordered_json;

Metadata some_metadata() {
  Metadata meta;
  meta.units = "µm";
  meta.grid = {{Axis::uniform(-0.1, 0.30000000000000004, int64_t{1} << 40, Axis::kMaxCells, 0.25), Axis::graded({0, 0.1, 0.7, 1e74}, 0.5),
                Axis::uniform(0, 1e-74, 0, 17, 0)}};
  meta.ray_axis = 1;
  meta.materials = {{"air", "#00000000", 2}, {"\"steel\"\n", "#8899aa", 0}, {"", "#ffffff", 1}};
  meta.labels = {{0, ""}, {2, "hull"}, {2, "hull", true}, {1, "déck"}, {1, ""}};
  const Index3 n = meta.grid.cells();
  const unsigned __int128 all = static_cast<unsigned __int128>(n[0]) * static_cast<uint64_t>(n[1] * n[2]);
  meta.amounts = {{all - 8, meta.grid.box(0)}, {1, {{7, 1, 2}, {8, 2, 3}}}, {0, {}}, {7, {{0, 0, 10}, {n[0], 3, 17}}}, {0, {}}};
  meta.patches = {{"xmin", "", 0.1}, {"rüssel", "hull", 1.7976931348623157e308}, {"", "hull", 0}};
  meta.chunk_rays = 256;
  meta.chunk_cells = 1u << 31;
  meta.page_chunks = 1;
  meta.crossings = ~uint64_t{0};
  meta.levels() = {{0, ~uint64_t{0}, 1, uint64_t{1} << 63, 3}, {2, 4, 5, 6, 7}};
  for (int level = 4; level <= 30; level += 2) meta.levels().push_back({level, 1, 0, 0, 0});
  meta.channels.push_back({"fractions", "bytes", false, {}, ~uint64_t{0}, 1});
  meta.channels.push_back({"\"", "", false, {}, 0, ~uint64_t{0}});
  return meta;
}

TEST_CASE("Metadata come back to the last bit") {
  const Metadata meta = some_metadata();
  REQUIRE(decode_metadata(encode_metadata(meta)) == meta);
}

TEST_CASE("Metadata cut short, as a frame or as text, are refused") {
  const Bytes frame = encode_metadata(some_metadata());
  for (size_t n = 0; n < frame.size(); ++n)
    REQUIRE_THROWS_AS(decode_metadata(Bytes(frame.begin(), frame.begin() + static_cast<ptrdiff_t>(n))), FormatError);
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
  plain.channels.insert(plain.channels.begin() + 1, {"first", "", false, {}, 7, 8});
  plain.channels.push_back({"last", "bytes", false, {}, 9, 10});
  REQUIRE(decode_metadata(edited([](ordered_json& j) {
            j["new"] = {1, 2, 3};
            j["chunk"]["new"] = "x";
            j["channels"].push_back(
                {{"name", "last"}, {"required", false}, {"coding", "bytes"}, {"strange", 7}, {"cover", {{"offset", 9}, {"frames", 10}}}});
            j["channels"].insert(
                j["channels"].begin(),
                ordered_json::object({{"name", "first"}, {"required", false}, {"cover", {{"offset", 7}, {"frames", 8}, {"new", 1}}}}));
          })) == plain);
}

TEST_CASE("Fractions without valid numbers of sub-samples are refused when the file is opened; in another coding they are unknown") {
  const auto with = [](const char* coding, const ordered_json& about) {
    return edited([&](ordered_json& j) {
      j["channels"].push_back(
          {{"name", "fractions"}, {"required", false}, {"coding", coding}, {"about", about}, {"cover", {{"offset", 9}, {"frames", 10}}}});
    });
  };
  CHECK_NOTHROW(decode_metadata(with("other", {{"samples", {3}}})));
  for (const char* coding : {"stretches", "shares"}) {
    CHECK_NOTHROW(decode_metadata(with(coding, {{"samples", {4, 4, 64}}})));
    for (const ordered_json& about : {ordered_json::object(), ordered_json{{"samples", {4, 4}}}, ordered_json{{"samples", {4, 4, 3}}}})
      CHECK_THROWS_WITH(decode_metadata(with(coding, about)), Catch::Contains("channel 'fractions'"));
  }
}

TEST_CASE("Of two successive levels one must be stored: a reader would derive the rest from the whole grid") {
  Metadata meta = some_metadata();
  meta.levels().pop_back();
  REQUIRE_THROWS_WITH(decode_metadata(encode_metadata(meta)), Catch::Contains("successive levels"));
  meta.levels() = {meta.levels()[0]};
  REQUIRE_THROWS_WITH(decode_metadata(encode_metadata(meta)), Catch::Contains("successive levels"));
}

TEST_CASE("Required channels that are unknown, labels in an unknown coding, twice or not at all are refused by name") {
  REQUIRE_THROWS_WITH(decode_metadata(edited([](ordered_json& j) {
                        j["channels"].push_back({{"name", "fractions"}, {"required", true}, {"coding", "bytes"}});
                      })),
                      Catch::Contains("fractions"));
  REQUIRE_THROWS_WITH(decode_metadata(edited([](ordered_json& j) { j["channels"][0]["coding"] = "octrees"; })), Catch::Contains("octrees"));
  REQUIRE_THROWS_AS(decode_metadata(edited([](ordered_json& j) { j["channels"].push_back(j["channels"][0]); })), FormatError);
  REQUIRE_THROWS_WITH(decode_metadata(edited([](ordered_json& j) { j["channels"] = ordered_json::array(); })), Catch::Contains("labels"));
}

TEST_CASE("A required channel is read if its kind is known in this coding, and comes back as required") {
  constexpr ChannelKind kKinds[] = {{kLabels, kRuns, nullptr}, {"fractions", "bytes", nullptr}};
  const auto with_coding = [](const ordered_json& coding) {
    return edited([&](ordered_json& j) {
      j["channels"].push_back({{"name", "fractions"}, {"required", true}, {"coding", coding}, {"cover", {{"offset", 1}, {"frames", 2}}}});
    });
  };
  const Metadata meta = decode_metadata(with_coding("bytes"), kKinds);
  REQUIRE(meta.channels.back() == Channel{"fractions", "bytes", true, {}, 1, 2});
  REQUIRE(decode_metadata(encode_metadata(meta), kKinds) == meta);
  for (const ordered_json& coding : {ordered_json("octrees"), ordered_json(7), ordered_json(nullptr)})
    REQUIRE_THROWS_WITH(decode_metadata(with_coding(coding), kKinds), Catch::Contains("requires channel 'fractions' in coding " + coding.dump()));
  REQUIRE_THROWS_WITH(decode_metadata(with_coding("bytes")), Catch::Contains("requires channel 'fractions'"));
}

TEST_CASE("Every key of the metadata is needed and no value of another type is taken for it") {
  const ordered_json wrong[] = {nullptr, "text", -1, 1.5, ordered_json::array(), ordered_json::object(), true};
  for (const char* path : {"/units",
                           "/ray_axis",
                           "/axes",
                           "/axes/0/type",
                           "/axes/0/cells",
                           "/axes/0/first",
                           "/axes/1/planes",
                           "/materials",
                           "/materials/0/name",
                           "/materials/0/color",
                           "/materials/0/rank",
                           "/labels",
                           "/labels/0/material",
                           "/labels/1/cells",
                           "/labels/1/box",
                           "/patches/1/name",
                           "/patches/1/area",
                           "/chunk",
                           "/chunk/rays",
                           "/chunk/cells",
                           "/chunk/page",
                           "/crossings",
                           "/channels",
                           "/channels/0/name",
                           "/channels/0/levels",
                           "/channels/0/levels/0/level",
                           "/channels/0/levels/0/directory",
                           "/channels/0/levels/0/bytes",
                           "/channels/1/required",
                           "/channels/1/cover",
                           "/channels/1/cover/offset",
                           "/channels/1/cover/frames"}) {
    INFO(path);
    const ordered_json::json_pointer pointer(path);
    REQUIRE_THROWS_AS(decode_metadata(edited([&](ordered_json& j) { j[pointer.parent_pointer()].erase(pointer.back()); })), FormatError);
    for (const ordered_json& value : wrong) {
      const Bytes frame = edited([&](ordered_json& j) { j[pointer] = value; });
      if (value.is_string() &&
          (path == std::string("/units") || path == std::string("/patches/1/name") || std::string(path).starts_with("/materials/0/")))
        continue;  // texts are free
      if (value == 1.5 && path == std::string("/patches/1/area")) continue;
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
  for (const uint64_t cells : {uint64_t{0}, uint64_t{1}, uint64_t{3}, uint64_t{66}, (uint64_t{1} << 31) + 4, ~uint64_t{0}})
    refused("/chunk/cells", cells);
  for (const uint64_t page : {uint64_t{0}, uint64_t{17}, uint64_t{1} << 32}) refused("/chunk/page", page);
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
  for (const char* cells : {"", "0", "2", "01", "-1", "1.0", "1e0", " 1", "10000000000000000000000000000", "18446744073709551617"})
    refused("/labels/1/cells", cells);
  for (const ordered_json& box :
       {ordered_json{8, 1, 2, 8, 2, 3}, ordered_json{7, 1, 2, 8, 2, 18}, ordered_json{7, 1, 2, 8, 2}, ordered_json{7, 1, -2, 8, 2, 3}})
    refused("/labels/1/box", box);
  refused("/labels/3/box", {0, 0, 10, 1, 1, 16});  // too small for its cells
  refused("/materials/0/rank", 0);  // equal to another
  refused("/materials/1/rank", 1);
  refused("/materials/1/rank", 3);  // above the background's
  refused("/materials/0/rank", 65536);
  refused("/labels/1/material", 3);
  refused("/labels", ordered_json::array());
  for (const int label : {0, 1, 3, 4}) refused(fmt::format("/labels/{}/overlap", label).c_str(), true);  // not behind the label of the same body
  refused("/labels/2/material", 1);
  refused("/labels/2/overlap", 1);
  refused("/materials", ordered_json::array());
  refused("/patches/1/name", "xmin");  // equal to another
  refused("/patches/1/area", -1e-300);
  for (const ordered_json& none : {ordered_json(nullptr), ordered_json("text"), ordered_json(3), ordered_json({{"name", "a"}, {"area", 1}})})
    refused("/patches", none);
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

}  // namespace
}  // namespace teracell

#include "store/format/metadata_json.hpp"

#include <cmath>
#include <unordered_set>

#include <fmt/format.h>

#include "store/format/format.hpp"
#include "store/text/color.hpp"
#include "store/text/json_node.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

Json to_json(const Axis& a) {
  if (a.is_graded()) return {{"type", "graded"}, {"planes", a.planes()}, {"sample", a.sample()}};
  return {{"type", "uniform"}, {"min", a.origin()}, {"step", a.step()}, {"first", a.first()}, {"cells", a.cells()}, {"sample", a.sample()}};
}

// A whole number in [0, hi].
template <class T>
T whole(const JsonNode& j, std::string_view key, uint64_t hi = ~uint64_t{0}) {
  return static_cast<T>(j.require(key).whole(hi));
}

std::string text_or_none(const JsonNode& j, std::string_view key) {
  const auto text = j.find(key);
  return text ? text->any_text() : "";
}

Axis axis_from(const JsonNode& j) {
  const JsonNode type = j.require("type");
  const double sample = j.require("sample").exact();
  if (type.any_text() == "graded") {
    std::vector<double> planes;
    j.each("planes", [&](const JsonNode& plane) { planes.push_back(plane.exact()); });
    return Axis::graded(std::move(planes), sample);
  }
  if (type.any_text() != "uniform") type.fail("uniform or graded");
  return Axis::uniform(j.require("min").exact(), j.require("step").exact(), whole<int64_t>(j, "first", uint64_t{1} << 52),
                       whole<int64_t>(j, "cells", Axis::kMaxCells), sample);
}

Json to_json(const Channel& c) {
  Json j = {{"name", c.name}, {"required", c.required}};
  if (!c.coding.empty()) j["coding"] = c.coding;
  if (!c.about.empty()) j["about"] = Json::parse(c.about);
  if (c.name != kLabels) {
    j["cover"] = {{"offset", c.cover}, {"frames", c.frames}};
    if (c.bytes != 0) j["cover"]["bytes"] = c.bytes;
    return j;
  }
  j["levels"] = Json::array();
  for (const LevelInfo& l : c.levels)
    j["levels"].push_back({{"level", l.level}, {"directory", l.directory}, {"chunks", l.chunks}, {"bytes", l.bytes}, {"changes", l.changes}});
  return j;
}

Channel channel_from(const JsonNode& j, std::span<const ChannelKind> known) {
  Channel c;
  c.name = j.require("name").any_text();
  c.required = c.name == kLabels || j.require("required").boolean();
  if (const auto coding = j.find("coding"); coding && coding->is_string()) c.coding = coding->any_text();
  if (const auto about = j.find("about")) {
    if (!about->is_object()) about->fail("an object");
    c.about = about->json().dump();
  }
  if (c.required && find_kind(known, c.name, c.coding) == nullptr)
    throw FormatError(fmt::format("the file requires channel '{}' in coding {}, which this reader does not know (FORMAT.md 7.7)",
                                  printable(first_bytes(c.name, kMostName)), j.require("coding").found()));
  if (c.name != kLabels) {
    const JsonNode cover = j.require("cover");
    c.cover = whole<uint64_t>(cover, "offset");
    c.frames = whole<uint64_t>(cover, "frames");
    if (const auto bytes = cover.find("bytes")) c.bytes = bytes->whole();
    return c;
  }
  j.each("levels", [&](const JsonNode& l) {
    c.levels.push_back({whole<int>(l, "level", 31), whole<uint64_t>(l, "directory"), whole<uint64_t>(l, "chunks"), whole<uint64_t>(l, "bytes"),
                        whole<uint64_t>(l, "changes")});
  });
  return c;
}

// A number of cells can have more than 64 bits, so it is a text.
LabelAmount amount_from(const JsonNode& cells, const JsonNode& label) {
  LabelAmount out;
  const std::string& digits = cells.any_text();
  if (digits.empty() || digits.size() > 28 || (digits[0] == '0' && digits.size() > 1)) cells.fail("a number of cells as a text");
  for (const char c : digits) {
    if (c < '0' || c > '9') cells.fail("a number of cells as a text");
    out.cells = 10 * out.cells + static_cast<unsigned>(c - '0');
  }
  if (out.cells == 0) return out;
  const JsonNode box = label.require("box");
  const std::vector<JsonNode> corners = box.items(6);
  for (size_t d = 0; d < 3; ++d) {
    out.box.lo[d] = static_cast<int64_t>(corners[d].whole(Axis::kMaxCells));
    out.box.hi[d] = static_cast<int64_t>(corners[d + 3].whole(Axis::kMaxCells));
  }
  return out;
}

Metadata metadata_from(const JsonNode& j, std::span<const ChannelKind> known) {
  Metadata meta;
  meta.units = j.require("units").any_text();
  meta.ray_axis = static_cast<int>(j.require("ray_axis").choice({"x", "y", "z"}));
  const JsonNode axes = j.require("axes"), chunk = j.require("chunk");
  const std::vector<JsonNode> axis = axes.items(3);
  for (size_t d = 0; d < 3; ++d) meta.grid.axis[d] = axis_from(axis[d]);
  j.each("materials", [&](const JsonNode& m) {
    meta.materials.push_back({m.require("name").any_text(), m.require("color").any_text(), whole<uint32_t>(m, "rank", 65535)});
  });
  j.each("labels", [&](const JsonNode& l) {
    const auto overlap = l.find("overlap");
    meta.labels.push_back({whole<uint32_t>(l, "material", 65535), text_or_none(l, "body"), overlap && overlap->boolean()});
    if (const auto cells = l.find("cells")) meta.amounts.push_back(amount_from(*cells, l));
  });
  j.each("patches", [&](const JsonNode& p) {
    meta.patches.push_back({p.require("name").any_text(), text_or_none(p, "body"), p.require("area").exact()});
  });
  meta.chunk_rays = whole<uint32_t>(chunk, "rays", 256);
  meta.chunk_cells = whole<uint32_t>(chunk, "cells", uint64_t{1} << 31);
  meta.page_chunks = whole<uint32_t>(chunk, "page", 16);
  meta.crossings = whole<uint64_t>(j, "crossings");
  meta.labels_hash = text_or_none(j, "labels_hash");
  meta.channels.clear();
  bool found = false;
  j.each("channels", [&](const JsonNode& channel) {
    Channel c = channel_from(channel, known);
    const bool is_labels = c.name == kLabels;
    if (is_labels && found) throw FormatError("channel 'labels' occurs twice (FORMAT.md 7.7)");
    found |= is_labels;
    if (const ChannelKind* kind = find_kind(channel_kinds(), c.name, c.coding); kind && kind->check_about) kind->check_about(c);
    meta.channels.insert(is_labels ? meta.channels.begin() : meta.channels.end(), std::move(c));
  });
  if (!found) throw FormatError("no channel 'labels' (FORMAT.md 7.7)");
  return meta;
}

void check(const Metadata& meta) {
  const auto expect = [](bool ok, const char* message, const char* clause) {
    if (!ok) throw FormatError(fmt::format("{} (FORMAT.md {})", message, clause));
  };
  if (const std::string beyond = beyond_bounds(meta); !beyond.empty()) throw FormatError(fmt::format("{} (FORMAT.md 3.1)", beyond));
  expect(meta.chunk_rays >= 4 && meta.chunk_rays <= 256 && meta.chunk_rays % 4 == 0, "chunk rays must be a multiple of 4 up to 256", "7.6");
  expect(meta.chunk_cells >= 4 && meta.chunk_cells % 4 == 0, "chunk cells must be a multiple of 4", "7.6");
  expect(meta.page_chunks >= 1 && meta.page_chunks <= 16, "a page has 1 to 16 chunks per side", "7.6");
  expect(!meta.materials.empty() && meta.materials.size() <= 65536, "there are 1 to 65536 materials", "7.3");
  expect(!meta.labels.empty(), "there is at least one label", "7.4");
  std::vector<bool> taken(65536);  // by rank
  for (const MaterialInfo& m : meta.materials) {
    expect(parse_color(m.color).has_value(), "a colour is #rrggbb or #rrggbbaa", "7.3");
    expect(!taken[m.rank], "no two materials may have the same rank", "7.3");
    expect(m.rank <= meta.materials[0].rank, "no rank may be above the background's", "7.3");
    taken[m.rank] = true;
  }
  for (size_t i = 0; i < meta.labels.size(); ++i) {
    const LabelInfo& l = meta.labels[i];
    expect(l.material < meta.materials.size(), "a label names a material that is not there", "7.4");
    expect(!l.overlap || (i > 0 && !l.body.empty() && meta.labels[i - 1] == LabelInfo{l.material, l.body}),
           "a label of overlaps comes right after the label of its body", "7.4");
  }
  expect(meta.amounts.empty() || meta.amounts.size() == meta.labels.size(), "either all labels tell their cells or none does", "7.12");
  expect(meta.amounts.empty() || amounts_fit(meta), "the cells of the labels are not those of the grid", "7.12");
  std::unordered_set<std::string_view> patches;
  for (const PatchInfo& p : meta.patches) {
    expect(std::isfinite(p.area) && p.area >= 0, "the area of a patch is 0 or more", "7.5");
    expect(patches.insert(p.name).second, "no two patches may have the same name", "7.5");
  }
  expect(meta.labels_hash.empty() || (meta.labels_hash.size() == 32 && meta.labels_hash.find_first_not_of("0123456789abcdef") == std::string::npos),
         "the hash of the labels is 32 hexadecimal digits", "7.11");
  for (const Channel& c : meta.others()) expect(c.frames > 0, "the cover of a channel has at least one frame", "7.8");
  const std::vector<LevelInfo>& levels = meta.levels();
  expect(!levels.empty() && levels[0].level == 0, "level 0 must be stored", "4.3");
  for (size_t i = 1; i < levels.size(); ++i)
    expect(levels[i].level > levels[i - 1].level && levels[i].level < meta.grid.levels(), "stored levels must ascend", "7.10");
  for (size_t i = 0; i < levels.size(); ++i) {
    const int next = i + 1 < levels.size() ? levels[i + 1].level : meta.grid.levels();
    expect(next - levels[i].level <= 2, "of two successive levels at least one must be stored", "4.3");
  }
}

}  // namespace

Bytes encode_metadata(const Metadata& meta) {
  Json j;
  j["units"] = meta.units;
  j["ray_axis"] = axis_name(meta.ray_axis);
  for (const Axis& axis : meta.grid.axis) j["axes"].push_back(to_json(axis));
  for (const MaterialInfo& m : meta.materials) j["materials"].push_back({{"name", m.name}, {"color", m.color}, {"rank", m.rank}});
  for (size_t i = 0; i < meta.labels.size(); ++i) {
    const LabelInfo& l = meta.labels[i];
    Json label = {{"material", l.material}};
    if (!l.body.empty()) label["body"] = l.body;
    if (l.overlap) label["overlap"] = true;
    if (!meta.amounts.empty()) {
      label["cells"] = whole_text(meta.amounts[i].cells);
      if (meta.amounts[i].cells != 0) label["box"] = meta.amounts[i].box.corners();
    }
    j["labels"].push_back(label);
  }
  for (const PatchInfo& p : meta.patches) {
    Json patch = {{"name", p.name}};
    if (!p.body.empty()) patch["body"] = p.body;
    patch["area"] = p.area;
    j["patches"].push_back(patch);
  }
  j["chunk"] = {{"rays", meta.chunk_rays}, {"cells", meta.chunk_cells}, {"page", meta.page_chunks}};
  j["crossings"] = meta.crossings;
  if (!meta.labels_hash.empty()) j["labels_hash"] = meta.labels_hash;
  for (const Channel& c : meta.channels) j["channels"].push_back(to_json(c));
  return encode_text(j.dump());
}

Metadata decode_metadata(std::span<const uint8_t> frame, std::span<const ChannelKind> known) try {
  return naming("metadata", [&] {
    const Json json = parse_json(decode_text(frame, "metadata"), "", kMostMetadataValues);
    Metadata meta = metadata_from(JsonNode(json, "metadata"), known);
    check(meta);
    return meta;
  });
} catch (const UsageError& e) {  // an axis
  throw FormatError(fmt::format("metadata: {} (FORMAT.md 7.2)", e.what()));
}

}  // namespace teracell::store

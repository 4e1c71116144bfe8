#include "store/format/metadata_json.hpp"

#include <cmath>
#include <unordered_set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/format/channel_kinds.hpp"
#include "store/format/format.hpp"
#include "store/text/color.hpp"
#include "store/text/json_text.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const Axis& a) {
  if (a.is_graded()) return {{"type", "graded"}, {"planes", a.planes()}, {"sample", a.sample()}};
  return {{"type", "uniform"}, {"min", a.origin()}, {"step", a.step()}, {"first", a.first()}, {"cells", a.cells()}, {"sample", a.sample()}};
}

// A value as messages show it.
std::string shown(const ordered_json& j) {
  if (j.is_structured()) return j.is_array() ? "an array" : "an object";
  return printable(first_bytes(j.dump(), 60));
}

// A whole number in [0, hi]. (The library's own conversions wrap, or are undefined.)
template <class T>
T whole(const ordered_json& j, const char* key, uint64_t hi) {
  const ordered_json& v = j.at(key);
  if (!v.is_number_unsigned() || v.get<uint64_t>() > hi)
    throw FormatError(fmt::format("metadata: {} must be a whole number from 0 to {}, found {} (FORMAT.md 7.1)", key, hi, shown(v)));
  return static_cast<T>(v.get<uint64_t>());
}

Axis axis_from(const ordered_json& j) {
  if (j.at("type") == "graded") return Axis::graded(j.at("planes").get<std::vector<double>>(), j.at("sample"));
  if (j.at("type") != "uniform")
    throw FormatError(fmt::format("metadata: an axis is uniform or graded, found {} (FORMAT.md 7.2)", shown(j.at("type"))));
  return Axis::uniform(j.at("min"), j.at("step"), whole<int64_t>(j, "first", uint64_t{1} << 52), whole<int64_t>(j, "cells", Axis::kMaxCells),
                       j.at("sample"));
}

ordered_json to_json(const Channel& c) {
  ordered_json j = {{"name", c.name}, {"required", c.required}};
  if (!c.coding.empty()) j["coding"] = c.coding;
  if (!c.about.empty()) j["about"] = ordered_json::parse(c.about);
  if (c.name != kLabels) {
    j["cover"] = {{"offset", c.cover}, {"frames", c.frames}};
    if (c.bytes != 0) j["cover"]["bytes"] = c.bytes;
    return j;
  }
  j["levels"] = ordered_json::array();
  for (const LevelInfo& l : c.levels)
    j["levels"].push_back({{"level", l.level}, {"directory", l.directory}, {"chunks", l.chunks}, {"bytes", l.bytes}, {"changes", l.changes}});
  return j;
}

Channel channel_from(const ordered_json& j, std::span<const ChannelKind> known) {
  Channel c;
  c.name = j.at("name");
  c.required = c.name == kLabels || j.at("required").get<bool>();
  if (const auto coding = j.find("coding"); coding != j.end() && coding->is_string()) c.coding = *coding;
  if (const auto about = j.find("about"); about != j.end()) {
    if (!about->is_object())
      throw FormatError(fmt::format("metadata: what a channel says of itself must be an object, found {} (FORMAT.md 7.9)", shown(*about)));
    c.about = about->dump();
  }
  if (c.required && find_kind(known, c.name, c.coding) == nullptr)
    throw FormatError(fmt::format("metadata: the file requires channel '{}' in coding {}, which this reader does not know (FORMAT.md 7.7)",
                                  printable(first_bytes(c.name, kMostName)), shown(j.at("coding"))));
  if (c.name != kLabels) {
    const ordered_json& cover = j.at("cover");
    c.cover = whole<uint64_t>(cover, "offset", ~uint64_t{0});
    c.frames = whole<uint64_t>(cover, "frames", ~uint64_t{0});
    if (cover.contains("bytes")) c.bytes = whole<uint64_t>(cover, "bytes", ~uint64_t{0});
    return c;
  }
  for (const auto& l : j.at("levels"))
    c.levels.push_back({whole<int>(l, "level", 31), whole<uint64_t>(l, "directory", ~uint64_t{0}), whole<uint64_t>(l, "chunks", ~uint64_t{0}),
                        whole<uint64_t>(l, "bytes", ~uint64_t{0}), whole<uint64_t>(l, "changes", ~uint64_t{0})});
  return c;
}

Metadata metadata_from(const ordered_json& j, std::span<const ChannelKind> known) {
  Metadata meta;
  try {
    meta.units = j.at("units");
    const std::string axis = j.at("ray_axis");
    if (axis != "x" && axis != "y" && axis != "z")
      throw FormatError(fmt::format("metadata: ray_axis is x, y or z, found {} (FORMAT.md 7.1)", shown(j.at("ray_axis"))));
    meta.ray_axis = axis[0] - 'x';
    if (j.at("axes").size() != 3) throw FormatError(fmt::format("metadata: expected 3 axes, found {} (FORMAT.md 7.2)", j.at("axes").size()));
    for (int d = 0; d < 3; ++d) meta.grid.axis[d] = axis_from(j.at("axes").at(d));
    for (const auto& m : j.at("materials")) meta.materials.push_back({m.at("name"), m.at("color"), whole<uint32_t>(m, "rank", 65535)});
    for (const auto& l : j.at("labels")) meta.labels.push_back({whole<uint32_t>(l, "material", 65535), l.value("body", "")});
    if (const auto patches = j.find("patches"); patches != j.end()) {
      if (!patches->is_array()) throw FormatError(fmt::format("metadata: patches is an array, found {} (FORMAT.md 7.5)", shown(*patches)));
      for (const auto& p : *patches) {
        if (!p.at("area").is_number())
          throw FormatError(fmt::format("metadata: the area of a patch is a number, found {} (FORMAT.md 7.5)", shown(p.at("area"))));
        meta.patches.push_back({p.at("name"), p.value("body", ""), p.at("area")});
      }
    }
    meta.chunk_rays = whole<uint32_t>(j.at("chunk"), "rays", 256);
    meta.chunk_cells = whole<uint32_t>(j.at("chunk"), "cells", uint64_t{1} << 31);
    meta.page_chunks = whole<uint32_t>(j.at("chunk"), "page", 16);
    meta.crossings = whole<uint64_t>(j, "crossings", ~uint64_t{0});
    meta.channels.clear();
    bool found = false;
    for (const auto& channel : j.at("channels")) {
      Channel c = channel_from(channel, known);
      const bool is_labels = c.name == kLabels;
      if (is_labels && found) throw FormatError("metadata: channel 'labels' occurs twice (FORMAT.md 7.7)");
      found |= is_labels;
      if (const ChannelKind* kind = find_kind(channel_kinds(), c.name, c.coding); kind && kind->check_about) kind->check_about(c);
      meta.channels.insert(is_labels ? meta.channels.begin() : meta.channels.end(), std::move(c));
    }
    if (!found) throw FormatError("metadata: no channel 'labels' (FORMAT.md 7.7)");
  } catch (const nlohmann::json::exception& e) {
    throw FormatError(fmt::format("metadata: {} (FORMAT.md 7.1)", e.what()));
  } catch (const UsageError& e) {  // an axis
    throw FormatError(fmt::format("metadata: {} (FORMAT.md 7.2)", e.what()));
  }
  return meta;
}

void check(const Metadata& meta) {
  const auto expect = [](bool ok, const char* message, const char* clause) {
    if (!ok) throw FormatError(fmt::format("metadata: {} (FORMAT.md {})", message, clause));
  };
  if (const std::string beyond = beyond_bounds(meta); !beyond.empty()) throw FormatError(fmt::format("metadata: {} (FORMAT.md 3.1)", beyond));
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
  for (const LabelInfo& l : meta.labels) expect(l.material < meta.materials.size(), "a label names a material that is not there", "7.4");
  std::unordered_set<std::string_view> patches;
  for (const PatchInfo& p : meta.patches) {
    expect(std::isfinite(p.area) && p.area >= 0, "the area of a patch is 0 or more", "7.5");
    expect(patches.insert(p.name).second, "no two patches may have the same name", "7.5");
  }
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
  ordered_json j;
  j["units"] = meta.units;
  j["ray_axis"] = axis_name(meta.ray_axis);
  for (const Axis& axis : meta.grid.axis) j["axes"].push_back(to_json(axis));
  for (const MaterialInfo& m : meta.materials) j["materials"].push_back({{"name", m.name}, {"color", m.color}, {"rank", m.rank}});
  for (const LabelInfo& l : meta.labels) {
    ordered_json label = {{"material", l.material}};
    if (!l.body.empty()) label["body"] = l.body;
    j["labels"].push_back(label);
  }
  for (const PatchInfo& p : meta.patches) {
    ordered_json patch = {{"name", p.name}};
    if (!p.body.empty()) patch["body"] = p.body;
    patch["area"] = p.area;
    j["patches"].push_back(patch);
  }
  j["chunk"] = {{"rays", meta.chunk_rays}, {"cells", meta.chunk_cells}, {"page", meta.page_chunks}};
  j["crossings"] = meta.crossings;
  for (const Channel& c : meta.channels) j["channels"].push_back(to_json(c));
  return encode_text(j.dump());
}

Metadata decode_metadata(std::span<const uint8_t> frame, std::span<const ChannelKind> known) {
  Metadata meta = metadata_from(parse_json(decode_text(frame, "metadata"), "metadata", kMostMetadataValues), known);
  check(meta);
  return meta;
}

}  // namespace teracell::store

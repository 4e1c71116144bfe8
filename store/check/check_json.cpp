#include "store/check/check_json.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/format/format.hpp"
#include "store/text/json_writer.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

// Counts above 2^53 lose digits in most JSON readers, so they come as text, too.
void write_finding(JsonWriter& out, const Finding& f) {
  out.begin_object().field("kind", kFindingKinds[static_cast<size_t>(f.kind)]).field("level", kFindingLevels[static_cast<size_t>(f.level)]);
  out.key("bodies").begin_array();
  for (const std::string& body : f.bodies) out.value(body);
  out.end_array();
  out.count("cells", f.cells).field("at", f.at);
  if (f.box) out.field("box", f.box->corners());
  else out.field("box", nullptr);
  out.field("text", f.text).end_object();
}

void write_wall(JsonWriter& out, const WallReport& wall) {
  out.begin_object()
      .field("body", wall.body)
      .key("thinnest_cells")
      .raw(wall.thinnest ? fmt::format("{:g}", *wall.thinnest) : "null")
      .field("at", wall.at)
      .key("histogram")
      .begin_array();
  for (const CellCount count : wall.histogram)
    if (count <= ~uint64_t{0}) out.value(static_cast<uint64_t>(count));
    else out.value(static_cast<double>(count));
  out.end_array().end_object();
}

std::string at_text(const std::optional<Vec3>& at) { return at ? fmt::format("  at ({:.6g}, {:.6g}, {:.6g})", (*at)[0], (*at)[1], (*at)[2]) : ""; }

void add_walls(std::vector<std::string>& lines, const std::vector<WallReport>& walls, size_t most) {
  std::vector<const WallReport*> thin;
  for (const WallReport& wall : walls)
    if (wall.thinnest) thin.push_back(&wall);
  if (walls.empty()) return;
  lines.push_back("");
  if (thin.empty()) return lines.push_back("Walls: all are 8 cells thick or more.");
  std::ranges::stable_sort(
      thin, {}, [](const WallReport* wall) { return std::tuple(*wall->thinnest, ~wall->histogram[static_cast<size_t>(*wall->thinnest) - 1]); });
  lines.push_back("Cells by the thickness of the wall that they lie in:");
  size_t width = 4;
  for (size_t i = 0; i < std::min(most, thin.size()); ++i) width = std::max(width, thin[i]->body.size());
  std::string head = fmt::format("  {:<{}}", "", width);
  for (int cells = 1; cells <= 7; ++cells) head += fmt::format(" {:>12}", cells);
  lines.push_back(head + fmt::format(" {:>20}", "8 or more"));
  for (size_t i = 0; i < std::min(most, thin.size()); ++i) {
    std::string line = fmt::format("  {:<{}}", thin[i]->body, width);
    for (size_t k = 0; k < 8; ++k) line += fmt::format(" {:>{}}", fmt::group_digits(thin[i]->histogram[k]), k < 7 ? 12 : 20);
    lines.push_back(line);
  }
  if (thin.size() > most) lines.push_back(fmt::format("  and {} more with walls below 8 cells", thin.size() - most));
}

constexpr std::string_view kBegin = R"({"schema":1,"grid_hash":")";

// A document ends with the checksum of what is before it, so that one that was cut or changed is never taken for what was found.
constexpr std::string_view kChecksum = ",\"checksum\":\"";
constexpr size_t kEndBytes = kChecksum.size() + 16 + 2;
std::string checksum_of(std::string_view body) {
  return fmt::format("{}{:016x}\"}}", kChecksum, checksum({reinterpret_cast<const uint8_t*>(body.data()), body.size()}));
}

}  // namespace

std::string findings_json(const Findings& findings) {
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).field("grid_hash", findings.hash).field("cells_hash", findings.cells_hash).key("findings").begin_array();
  for (const Finding& f : findings.list) write_finding(out, f);
  out.end_array().key("totals").begin_object();
  for (size_t kind = 0; kind < kFindingKindCount; ++kind) {
    if (findings.totals[kind].findings == 0) continue;
    out.key(kFindingKinds[kind]).begin_object().field("findings", findings.totals[kind].findings);
    out.count("cells", findings.totals[kind].cells);
    out.end_object();
  }
  out.end_object().key("walls").begin_array();
  for (const WallReport& wall : findings.walls) write_wall(out, wall);
  out.end_array().key("not_looked_at").begin_array();
  for (const std::string& sentence : findings.not_looked_at) out.value(sentence);
  out.end_array();
  text += checksum_of(text);
  return text;
}

bool is_whole(std::string_view json) {
  if (!ends_as_whole(json)) return false;
  const std::string_view body = json.substr(0, json.size() - kEndBytes);
  return json.substr(body.size()) == checksum_of(body);
}

bool ends_as_whole(std::string_view json) {
  return json.size() > kEndBytes && json.ends_with("\"}") && json.substr(json.size() - kEndBytes).starts_with(kChecksum);
}

GridHashes hashes_in(std::string_view json) {
  const auto take = [&](std::string_view before) {
    if (!json.starts_with(before)) return std::string();
    json.remove_prefix(before.size());
    std::string hash(json.substr(0, json.find('"')));
    json.remove_prefix(hash.size());
    return hash;
  };
  std::string grid = take(kBegin);
  return {std::move(grid), take(R"(","cells_hash":")")};
}

std::string with_grid_hash(const std::string& json, const std::string& hash) {
  std::string text = json.substr(0, json.size() - kEndBytes);
  text.replace(kBegin.size(), hashes_in(json).grid.size(), hash);
  return text + checksum_of(text);
}

std::string findings_text(const Findings& findings, size_t most) {
  std::array<uint64_t, 3> levels{};
  std::vector<std::string> lines = {""};
  std::array<size_t, kFindingKindCount> shown{};
  for (size_t i = 0; i < findings.list.size(); ++i) {
    const Finding& f = findings.list[i];
    const auto kind = static_cast<size_t>(f.kind);
    ++levels[static_cast<size_t>(f.level)];
    if (++shown[kind] <= most)
      lines.push_back(fmt::format("  {:<7}  {:<12}  {}{}", kFindingLevels[static_cast<size_t>(f.level)], kFindingKinds[kind], f.text, at_text(f.at)));
  }
  for (size_t kind = 0; kind < kFindingKindCount; ++kind)
    if (const uint64_t all = findings.totals[kind].findings; all > std::min(most, shown[kind]))
      lines.push_back(
          fmt::format("  {:<7}  {:<12}  and {} more", "", kFindingKinds[kind], fmt::group_digits(all - std::min<uint64_t>(most, shown[kind]))));
  const uint64_t listed = levels[0] + levels[1] + levels[2];
  uint64_t all = 0;
  for (const KindTotal& total : findings.totals) all += total.findings;
  lines[0] = listed == 0 ? "nothing was found"
                         : fmt::format("{}, {}, {}", counted(levels[0], "error"), counted(levels[1], "warning"), counted(levels[2], "note"));
  if (all > listed) lines[0] += fmt::format(" of {} in all", fmt::group_digits(all));
  add_walls(lines, findings.walls, most);
  if (!findings.not_looked_at.empty()) {
    lines.push_back("");
    lines.push_back("Not looked at:");
    for (const std::string& sentence : findings.not_looked_at) lines.push_back("  " + sentence);
  }
  return fmt::format("{}", fmt::join(lines, "\n"));
}

}  // namespace teracell::store

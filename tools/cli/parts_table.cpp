#include "tools/cli/parts_table.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "mesher/surface/part_path.hpp"
#include "mesher/surface/read_options.hpp"
#include "mesher/survey/survey.hpp"
#include "mesher/survey/survey_json.hpp"
#include "store/grid/number_text.hpp"
#include "store/text/text.hpp"
#include "store/text/words.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {
namespace {

using mesher::FileSurvey;
using mesher::PartKind;

constexpr size_t kMostTreeLines = 200, kNoKind = ~size_t{0};

// A name in the tree, with what is below it.
struct Branch {
  std::string name;
  size_t kind = kNoKind;
  std::vector<Branch> below;
};

Branch tree_of(const FileSurvey& f) {
  Branch root;
  const auto add = [&](const std::string& path, size_t kind) {
    Branch* at = &root;
    for (const std::string& name : mesher::names_of(path)) {
      if (at->below.empty() || at->below.back().name != name) at->below.push_back({name, kNoKind, {}});  // parts come in the order of the tree
      at = &at->below.back();
    }
    at->kind = kind;
  };
  if (f.tree)
    for (const mesher::PartPlace& p : f.places) add(p.path, p.kind);
  else
    for (size_t i = 0; i < f.kinds.size(); ++i) add(f.kinds[i].path, i);
  return root;
}

// A name that is long loses its middle.
std::string name_shown(const std::string& name) {
  constexpr size_t kMost = 60;
  const std::string text = printable(name);
  if (text.size() <= kMost) return trimmed(text).empty() ? "'" + text + "'" : text;
  size_t end = text.size() - kMost / 3;
  while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) ++end;
  return std::string(first_bytes(text, kMost / 3 * 2)) + "…" + text.substr(end);
}

// Equal for branches that look the same.
size_t looks_of(const Branch& b) {
  size_t hash = std::hash<std::string_view>()(mesher::without_number(b.name)) * 31 + b.kind;
  for (const Branch& child : b.below) hash = (hash ^ looks_of(child)) * 0x9e3779b97f4a7c15;
  return hash;
}

// A line of the table: the tree, and what is known of a part.
struct Line {
  std::string tree;
  const PartKind* kind;
};

class Lines {
 public:
  explicit Lines(const FileSurvey& f) : survey_(f) { add_all(tree_of(f).below, "", true); }
  std::vector<Line> all;

 private:
  // Siblings that look the same share a line.
  void add_all(const std::vector<Branch>& branches, const std::string& indent, bool outermost) {
    struct Group {
      const Branch *first, *last;
      uint64_t count;
    };
    std::vector<Group> groups;
    std::map<size_t, size_t> known;
    for (const Branch& b : branches) {
      const auto [group, fresh] = known.try_emplace(looks_of(b), groups.size());
      if (fresh) groups.push_back({&b, &b, 0});
      groups[group->second].last = &b;
      ++groups[group->second].count;
    }
    for (size_t i = 0; i < groups.size(); ++i) {
      const auto& [b, end, count] = groups[i];
      const bool last = i + 1 == groups.size();
      all.push_back({fmt::format("{}{}{}{}", indent,
                                 outermost ? ""
                                 : last    ? "└─ "
                                           : "├─ ",
                                 name_shown(b->name), count > 1 ? fmt::format(" … {} × {}", name_shown(end->name), fmt::group_digits(count)) : ""),
                     b->kind == kNoKind ? nullptr : &survey_.kinds[b->kind]});
      add_all(b->below, outermost ? "" : indent + (last ? "   " : "│  "), false);
    }
  }
  const FileSurvey& survey_;
};

// How many columns of a terminal a text takes: characters of East Asian scripts take two, marks that combine take none.
size_t columns(std::string_view text) {
  size_t out = 0;
  for (size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const size_t bytes = first < 0x80 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
    uint32_t c = bytes == 1 ? first : first & (0xff >> (bytes + 1));
    for (size_t k = 1; k < bytes && i + k < text.size(); ++k) c = c << 6 | (static_cast<unsigned char>(text[i + k]) & 63);
    const bool combines = (c >= 0x300 && c < 0x370) || (c >= 0x200b && c < 0x2010) || (c >= 0xfe00 && c < 0xfe10);
    const bool wide = (c >= 0x1100 && c < 0x1160) || (c >= 0x2e80 && c < 0xa4d0) || (c >= 0xac00 && c < 0xd7a4) || (c >= 0xf900 && c < 0xfb00) ||
                      (c >= 0xfe30 && c < 0xfe70) || (c >= 0xff00 && c < 0xff61) || (c >= 0x1f300 && c < 0x1fa00) || (c >= 0x20000 && c < 0x40000);
    out += combines ? 0 : wide ? 2 : 1;
    i += bytes;
  }
  return out;
}

std::string padded(const std::string& text, size_t width) { return text + std::string(width - std::min(width, columns(text)), ' '); }

std::string size_of(const Vec3& lo, const Vec3& hi) {
  return fmt::format("{} × {} × {}", number_text(hi[0] - lo[0], 5), number_text(hi[1] - lo[1], 5), number_text(hi[2] - lo[2], 5));
}

std::string looks_text(const PartKind& k) { return printable(k.material) + (k.material.empty() || k.color.empty() ? "" : " ") + k.color; }

std::string volume_text(const std::optional<double>& v) { return v ? number_text(*v, 6) : ""; }

constexpr size_t kColumns = 7;
using Row = std::array<std::string, kColumns>;

void print_file(const std::string& name, const FileSurvey& f) {
  uint64_t parts = 0, facets = 0;
  for (const PartKind& k : f.kinds) parts += k.instances, facets += k.instances * k.facets;
  const std::string unit = f.file.unit.empty() ? "" : " " + f.file.unit;
  say(fmt::format("{}: {}, {}, {}{}, {}{}", printable(name), f.file.format, f.file.unit.empty() ? "no unit stated" : "in " + f.file.unit,
                  plural(parts, "part"), parts > f.kinds.size() ? fmt::format(" of {}", plural(f.kinds.size(), "kind")) : "", size_of(f.lo, f.hi),
                  unit));
  const Lines lines(f);
  const std::string cubic = unit.empty() ? "" : "," + unit + "³";
  std::vector<Row> rows = {{"part", "facets", "size" + (unit.empty() ? "" : "," + unit), "volume" + cubic, "", "", ""}};
  if (f.file.cad) rows[0][4] = "kernel", rows[0][5] = "sender";
  for (size_t i = 0; i < std::min(lines.all.size(), kMostTreeLines); ++i) {
    const auto& [tree, kind] = lines.all[i];
    if (!kind) rows.push_back({tree});
    else
      rows.push_back({tree, fmt::format("{}", fmt::group_digits(kind->facets)), size_of(kind->lo, kind->hi),
                      kind->closed            ? number_text(kind->volume, 6)
                      : kind->open_edges == 0 ? "open"
                                              : fmt::format("open: {}", plural(kind->open_edges, "edge")),
                      volume_text(kind->kernel_volume), volume_text(kind->sender_volume), looks_text(*kind)});
  }
  std::array<size_t, kColumns> widths{};
  for (const auto& row : rows)
    for (size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], columns(row[c]));
  for (const auto& row : rows) {
    std::string line = padded(row[0], widths[0]);
    for (size_t c = 1; c < row.size(); ++c)
      if (widths[c] > 0) line += "  " + (c + 1 < kColumns ? std::string(widths[c] - columns(row[c]), ' ') + row[c] : row[c]);
    say(line.substr(0, line.find_last_not_of(' ') + 1));
  }
  if (lines.all.size() > kMostTreeLines)
    say(fmt::format("and {} more lines; --json has one entry for each kind of part", fmt::group_digits(lines.all.size() - kMostTreeLines)));
  for (const std::string& w : f.file.warnings) say(fmt::format("note: {}", w));
}

}  // namespace

bool names_a_grid(const std::string& name) {
  if (name.find("://") != std::string::npos || name.ends_with(".tcell")) return true;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(name, ignored)) return false;  // of a pipe nothing may be taken
  std::ifstream in(name, std::ios::binary);
  char head[16] = {};
  in.read(head, sizeof head);
  return in.gcount() == 0 || std::string_view(head + 8, 8) == "teracell";
}

void print_surfaces(const std::vector<std::string>& names, bool json, const mesher::CadOptions& cad) {
  std::vector<FileSurvey> files;
  for (const std::string& name : names) {
    files.push_back(mesher::survey(name, mesher::modest_budget(), cad));
    if (json) continue;
    if (files.size() > 1) say("");
    print_file(name, files.back());
  }
  if (json) std::cout << mesher::survey_json(files, names) << "\n";
}

}  // namespace teracell::cli

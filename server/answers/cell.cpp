// What a cell is made of.
#include "server/answers/answers.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "store/channels/cut_plane.hpp"
#include "store/read/query.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::server {
namespace {

// Of a list.
void write_material(JsonWriter& out, const Metadata& meta, uint32_t id) { out.begin_object().field("id", id).field("name", meta.materials[id].name); }

// What a cell of level 0 is made of, by material, and if it is mixed the plane of one: of `own`, its material, or of the one with the largest
// share where a sheet owns the cell.
void write_shares(JsonWriter& out, const Metadata& meta, const FractionReader& fractions, const Index3& cell, uint32_t own) {
  const uint32_t total = sub_samples(fractions.samples());
  std::map<uint32_t, uint32_t> counts;
  for (const auto& [label, count] : fractions.cell(cell)) counts[meta.labels[label].material] += count;
  if (counts.empty()) counts[own] = total;
  out.key("shares").begin_array();
  for (const auto& [id, count] : counts) {
    write_material(out, meta, id);
    out.field("share", static_cast<double>(count) / total).end_object();
  }
  out.end_array();
  if (counts.size() == 1) return;
  if (!counts.contains(own)) own = std::ranges::max_element(counts, {}, &std::pair<const uint32_t, uint32_t>::second)->first;
  if (const auto plane = cut_plane(fractions, meta.grid, cell, own)) {
    out.key("plane");
    write_material(out, meta, own);
    out.field("normal", plane->normal).field("offset", plane->offset).end_object();
  }
}

Response answer_cell(const GridRequest& r) {
  r.target.allow({"v", "i", "j", "k", "level"});
  const int level = level_of(r.target.find("level"), r.reader());
  const Metadata& meta = r.meta();
  const Index3 n = meta.grid.cells(level);
  Box box;
  for (int d = 0; d < 3; ++d) {
    const std::string name(1, "ijk"[d]);
    const std::string* text = r.target.find(name);
    if (!text) throw bad_request(fmt::format("missing {}: expected a whole number from 0 to {}", name, n[d] - 1));
    box.lo[d] = integer_in(*text, name, 0, n[d] - 1);
    box.hi[d] = box.lo[d] + 1;
  }
  return json_answer(r, "cell", [&, box] {
    std::string text;
    JsonWriter out(text);
    out.begin_object().field("schema", 1).field("index", box.lo).field("level", level).key("centre").begin_array();
    for (int d = 0; d < 3; ++d) {
      const Axis& a = meta.grid.axis[d];
      const int64_t first = box.lo[d] << level, last = std::min(a.cells(), box.hi[d] << level);
      out.value(level == 0 ? a.centre(first) : (a.plane(first) + a.plane(last)) / 2);
    }
    out.end_array();
    for_each_run(r.reader(), level, box, [&](const BoxRun& run) {  // the cell is a single run
      const auto materials = materials_of(meta, *run.set);
      out.key("materials").begin_array();
      for (const uint32_t m : materials) {
        write_material(out, meta, m);
        out.end_object();
      }
      out.end_array();
      if (keeps_bodies(meta)) {
        out.key("bodies").begin_array();
        for (const Label label : *run.set) {
          const LabelInfo& info = meta.labels[label];
          out.begin_object().field("label", label).field("name", info.body).field("material", info.material);
          if (info.overlap) out.field("overlap", true);
          out.end_object();
        }
        out.end_array();
      }
      if (level == 0 && r.grid->fractions) write_shares(out, meta, *r.grid->fractions, box.lo, materials[0]);
    });
    out.end_object();
    return text;
  });
}

}  // namespace

const Answer kCellAnswer = {"cell", 1, Cost::kCheap, answer_cell};

}  // namespace teracell::server

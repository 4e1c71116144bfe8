#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/json_node.hpp"
#include "store/text/json_writer.hpp"
#include "store/whole/near_parts.hpp"
#include "store/whole/partition.hpp"

namespace teracell::inline store {
namespace {

constexpr std::string_view kMethods[] = {"blocks", "slabs"};

double work_of(const JsonNode& work) {
  if (work.number() < 0) work.fail("a number of at least 0");
  return work.number();
}

Box box_of(const JsonNode& box) {
  const auto n = box.wholes<6>();
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

bool within(const Box& inner, const Box& outer) {
  return std::ranges::all_of(std::array{0, 1, 2},
                             [&](int d) { return outer.lo[d] <= inner.lo[d] && inner.lo[d] < inner.hi[d] && inner.hi[d] <= outer.hi[d]; });
}

void check(const Partition& p) {
  const auto fail = [](const std::string& what) { throw InputError("partition: " + what); };
  if (static_cast<int64_t>(p.parts.size()) != p.options.ranks) fail(fmt::format("expected {} parts, found {}", p.options.ranks, p.parts.size()));
  if (p.options.align == 0) fail("align: expected at least 1, found 0");
  if (p.grid_hash.size() != 32 || p.grid_hash.find_first_not_of("0123456789abcdef") != std::string::npos)
    fail("grid_hash: expected 32 hexadecimal digits");
  const Box grid{{0, 0, 0}, p.cells};
  unsigned __int128 cells = 0, all = 1;
  for (int d = 0; d < 3; ++d) {
    if (p.cells[d] < 1 || p.cells[d] > Axis::kMaxCells)
      fail(fmt::format("expected 1 to {} cells along each axis, found {}", Axis::kMaxCells, p.cells[d]));
    all *= static_cast<unsigned __int128>(p.cells[d]);
  }
  for (size_t rank = 0; rank < p.parts.size(); ++rank) {
    const Part& part = p.parts[rank];
    if (!within(part.box, grid)) fail(fmt::format("rank {}: expected a box of cells of the grid", rank));
    for (int d = 0; d < 3; ++d)
      if (part.box.lo[d] % p.options.align != 0 || (part.box.hi[d] % p.options.align != 0 && part.box.hi[d] != p.cells[d]))
        fail(fmt::format("rank {}: expected a box that is cut at multiples of {} cells, found {} to {}", rank, p.options.align, part.box.lo[d],
                         part.box.hi[d]));
    if (part.halo_box != with_halo(part.box, p.options.halo, p.cells))
      fail(fmt::format("rank {}: expected a halo_box that is the box with {} cells around it, clipped to the grid", rank, p.options.halo));
    if (!std::ranges::is_sorted(part.neighbours, std::less_equal())) fail(fmt::format("rank {}: expected neighbours in ascending order", rank));
    unsigned __int128 volume = 1;
    for (int d = 0; d < 3; ++d) volume *= static_cast<unsigned __int128>(part.box.hi[d] - part.box.lo[d]);
    cells += volume;
    for (const int64_t n : part.neighbours)
      if (n < 0 || n >= p.options.ranks) fail(fmt::format("rank {}: expected neighbours from 0 to {}, found {}", rank, p.options.ranks - 1, n));
  }
  if (cells != all) fail(fmt::format("expected boxes of {} cells together, found {}", all, cells));
  for_each_near_pair(p.parts, 0, [&](size_t i, size_t j) {
    if (overlap(p.parts[i].box, p.parts[j].box)) fail(fmt::format("expected boxes that don't overlap, found ranks {} and {}", i, j));
  });
}

}  // namespace

const char* name_of(PartitionMethod method) { return kMethods[static_cast<int>(method)].data(); }

std::string partition_json(const Partition& p) {
  std::string text;
  JsonWriter out(text);
  const PartitionOptions& o = p.options;
  out.begin_object().field("schema", 1).field("ranks", o.ranks).field("method", name_of(o.method));
  out.field("align", o.align).field("halo", o.halo).key("weights").begin_object();
  for (size_t i = 0; i < p.materials.size(); ++i) out.raw(ascii_json(p.materials[i]) + ":" + Json(o.weights[i]).dump());
  out.end_object().field("cells", p.cells).field("grid_hash", p.grid_hash).field("total", p.total).key("parts").begin_array();
  for (size_t rank = 0; rank < p.parts.size(); ++rank) {
    const Part& part = p.parts[rank];
    out.begin_object().field("rank", rank).field("box", part.box.corners()).field("weight", part.weight);
    out.field("halo_box", part.halo_box.corners()).field("neighbours", part.neighbours).end_object();
  }
  out.end_array().end_object();
  return text;
}

Partition parse_partition(const std::string& text) try {
  const Json json = parse_json(text, "", ~size_t{0});
  const JsonNode root(json, "the file");
  if (const JsonNode schema = root.require("schema"); schema.whole() != 1) schema.fail("1");
  Partition p;
  p.options.ranks = static_cast<int64_t>(root.require("ranks").whole(INT64_MAX));
  p.options.method = static_cast<PartitionMethod>(root.require("method").choice(kMethods));
  p.options.align = static_cast<int64_t>(root.require("align").whole(Axis::kMaxCells));
  p.options.halo = static_cast<int64_t>(root.require("halo").whole(Axis::kMaxCells));
  const JsonNode weights = root.require("weights");
  for (const JsonNode& weight : weights.members()) p.materials.emplace_back(weight.key()), p.options.weights.push_back(work_of(weight));
  p.cells = root.require("cells").wholes<3>();
  p.grid_hash = root.require("grid_hash").any_text();
  p.total = work_of(root.require("total"));
  const JsonNode parts = root.require("parts");
  for (const JsonNode& part : parts.items()) {
    if (part.require("rank").whole() != p.parts.size())
      part.require("rank").fail(fmt::format("the parts in the order of their ranks, so {}", p.parts.size()));
    Part& out = p.parts.emplace_back(Part{box_of(part.require("box")), work_of(part.require("weight")), box_of(part.require("halo_box")), {}});
    part.each("neighbours", [&](const JsonNode& rank) { out.neighbours.push_back(static_cast<int64_t>(rank.whole(INT64_MAX))); });
  }
  check(p);
  return p;
} catch (const FormatError& e) {
  throw InputError(fmt::format("partition: {}", e.what()));
}

}  // namespace teracell::store

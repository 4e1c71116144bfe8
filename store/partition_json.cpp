#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/error.hpp"
#include "store/json_writer.hpp"
#include "store/partition.hpp"

namespace teracell {
namespace {

using nlohmann::json;

constexpr const char* kMethods[] = {"blocks", "slabs"};

void write_box(JsonWriter& out, const char* key, const Box& box) {
  out.key(key).begin_array();
  for (const Index3& corner : {box.lo, box.hi})
    for (const int64_t n : corner) out.value(n);
  out.end_array();
}

Box box_of(const json& numbers) {
  const auto n = numbers.get<std::array<int64_t, 6>>();
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

bool within(const Box& inner, const Box& outer) {
  return std::ranges::all_of(std::array{0, 1, 2},
                             [&](int d) { return outer.lo[d] <= inner.lo[d] && inner.lo[d] < inner.hi[d] && inner.hi[d] <= outer.hi[d]; });
}

void check(const Partition& p) {
  const auto fail = [](const std::string& what) { throw InputError("partition: " + what); };
  if (static_cast<int64_t>(p.parts.size()) != p.options.ranks) fail(fmt::format("expected {} parts, found {}", p.options.ranks, p.parts.size()));
  const Box grid{{0, 0, 0}, p.cells};
  unsigned __int128 cells = 0, all = 1;
  for (int d = 0; d < 3; ++d) {
    if (p.cells[d] < 1 || p.cells[d] > Axis::kMaxCells)
      fail(fmt::format("expected 1 to {} cells along each axis, found {}", Axis::kMaxCells, p.cells[d]));
    all *= static_cast<unsigned __int128>(p.cells[d]);
  }
  for (size_t rank = 0; rank < p.parts.size(); ++rank) {
    const Part& part = p.parts[rank];
    if (!within(part.box, grid) || !within(part.halo_box, grid) || !within(part.box, part.halo_box))
      fail(fmt::format("rank {}: expected a box within its halo_box within the grid", rank));
    unsigned __int128 volume = 1;
    for (int d = 0; d < 3; ++d) volume *= static_cast<unsigned __int128>(part.box.hi[d] - part.box.lo[d]);
    cells += volume;
    for (const int64_t n : part.neighbours)
      if (n < 0 || n >= p.options.ranks) fail(fmt::format("rank {}: expected neighbours from 0 to {}, found {}", rank, p.options.ranks - 1, n));
  }
  if (cells != all) fail(fmt::format("expected boxes of {} cells together, found {}", all, cells));
  std::vector<size_t> order(p.parts.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, {}, [&](size_t i) { return p.parts[i].box.lo[0]; });
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t j = i + 1; j < order.size() && p.parts[order[j]].box.lo[0] < p.parts[order[i]].box.hi[0]; ++j)
      if (overlap(p.parts[order[i]].box, p.parts[order[j]].box))
        fail(fmt::format("expected boxes that don't overlap, found ranks {} and {}", order[i], order[j]));
}

}  // namespace

std::string partition_json(const Partition& p) {
  std::string text;
  JsonWriter out(text);
  const PartitionOptions& o = p.options;
  out.begin_object().field("schema", 1).field("ranks", o.ranks).field("method", kMethods[static_cast<int>(o.method)]);
  out.field("align", o.align).field("halo", o.halo).key("weights").begin_object();
  for (size_t i = 0; i < p.materials.size(); ++i) out.raw(json(p.materials[i]).dump(-1, ' ', true) + ":" + json(o.weights[i]).dump());
  out.end_object().key("cells").begin_array();
  for (const int64_t n : p.cells) out.value(n);
  out.end_array().field("total", p.total).key("parts").begin_array();
  for (size_t rank = 0; rank < p.parts.size(); ++rank) {
    const Part& part = p.parts[rank];
    out.begin_object().field("rank", rank);
    write_box(out, "box", part.box);
    out.field("weight", part.weight);
    write_box(out, "halo_box", part.halo_box);
    out.key("neighbours").begin_array();
    for (const int64_t n : part.neighbours) out.value(n);
    out.end_array().end_object();
  }
  out.end_array().end_object();
  return text;
}

Partition parse_partition(const std::string& text) try {
  const json root = json::parse(text);
  if (root.at("schema") != 1) throw InputError("partition: expected \"schema\": 1");
  Partition p;
  p.options.ranks = root.at("ranks");
  const auto method = std::ranges::find(kMethods, root.at("method").get<std::string>(), [](const char* name) { return std::string(name); });
  if (method == std::end(kMethods)) throw InputError("partition: method: expected blocks or slabs");
  p.options.method = static_cast<PartitionMethod>(method - kMethods);
  p.options.align = root.at("align");
  p.options.halo = root.at("halo");
  for (const auto& [name, weight] : root.at("weights").items()) p.materials.push_back(name), p.options.weights.push_back(weight);
  p.cells = root.at("cells").get<Index3>();
  p.total = root.at("total");
  for (const json& part : root.at("parts")) {
    if (part.at("rank") != p.parts.size())
      throw InputError(fmt::format("partition: expected the parts in the order of their ranks, found another at {}", p.parts.size()));
    p.parts.push_back({box_of(part.at("box")), part.at("weight"), box_of(part.at("halo_box")), part.at("neighbours").get<std::vector<int64_t>>()});
  }
  check(p);
  return p;
} catch (const json::exception& e) {
  throw InputError(fmt::format("partition: expected what teracell partition writes: {}", e.what()));
}

}  // namespace teracell

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/base/error.hpp"
#include "store/text/json_writer.hpp"
#include "store/whole/partition.hpp"

namespace teracell::inline store {
namespace {

using nlohmann::json;

constexpr const char* kMethods[] = {"blocks", "slabs"};

void write_box(JsonWriter& out, const char* key, const Box& box) {
  out.key(key).begin_array();
  for (const Index3& corner : {box.lo, box.hi})
    for (const int64_t n : corner) out.value(n);
  out.end_array();
}

[[noreturn]] void refuse(const char* key, const char* expected, const json& found) {
  throw InputError(fmt::format("partition: {}: expected {}, found {}", key, expected, found.is_number() ? found.dump() : found.type_name()));
}

// The JSON library would cut 1.5 to 1, and take true for 1.
int64_t whole_number(const json& value, const char* key) {
  if (!value.is_number_integer() || (value.is_number_unsigned() && value.get<uint64_t>() > INT64_MAX)) refuse(key, "a whole number", value);
  return value.get<int64_t>();
}
int64_t whole_number(const char* key, const json& of) { return whole_number(of.at(key), key); }

double work_of(const json& value, const char* key) {
  if (!value.is_number() || value.get<double>() < 0) refuse(key, "a number of at least 0", value);
  return value.get<double>();
}

const json& list(const char* key, const json& of) {
  const json& found = of.at(key);
  if (!found.is_array()) refuse(key, "a list", found);
  return found;
}

template <size_t kCount>
std::array<int64_t, kCount> whole_numbers(const char* key, const json& of) {
  const json& found = list(key, of);
  if (found.size() != kCount) throw InputError(fmt::format("partition: {}: expected {} whole numbers, found {}", key, kCount, found.size()));
  std::array<int64_t, kCount> out;
  for (size_t i = 0; i < kCount; ++i) out[i] = whole_number(found[i], key);
  return out;
}

Box box_of(const char* key, const json& part) {
  const auto n = whole_numbers<6>(key, part);
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

bool within(const Box& inner, const Box& outer) {
  return std::ranges::all_of(std::array{0, 1, 2},
                             [&](int d) { return outer.lo[d] <= inner.lo[d] && inner.lo[d] < inner.hi[d] && inner.hi[d] <= outer.hi[d]; });
}

void check(const Partition& p) {
  const auto fail = [](const std::string& what) { throw InputError("partition: " + what); };
  if (static_cast<int64_t>(p.parts.size()) != p.options.ranks) fail(fmt::format("expected {} parts, found {}", p.options.ranks, p.parts.size()));
  const auto expect = [&](const char* key, int64_t value, int64_t least) {
    if (value < least || value > Axis::kMaxCells) fail(fmt::format("{}: expected {} to {}, found {}", key, least, Axis::kMaxCells, value));
  };
  expect("align", p.options.align, 1);
  expect("halo", p.options.halo, 0);
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
  std::vector<size_t> order(p.parts.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, {}, [&](size_t i) { return p.parts[i].box.lo[0]; });
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t j = i + 1; j < order.size() && p.parts[order[j]].box.lo[0] < p.parts[order[i]].box.hi[0]; ++j)
      if (overlap(p.parts[order[i]].box, p.parts[order[j]].box))
        fail(fmt::format("expected boxes that don't overlap, found ranks {} and {}", order[i], order[j]));
}

}  // namespace

const char* name_of(PartitionMethod method) { return kMethods[static_cast<int>(method)]; }

std::string partition_json(const Partition& p) {
  std::string text;
  JsonWriter out(text);
  const PartitionOptions& o = p.options;
  out.begin_object().field("schema", 1).field("ranks", o.ranks).field("method", name_of(o.method));
  out.field("align", o.align).field("halo", o.halo).key("weights").begin_object();
  for (size_t i = 0; i < p.materials.size(); ++i) out.raw(json(p.materials[i]).dump(-1, ' ', true) + ":" + json(o.weights[i]).dump());
  out.end_object().key("cells").begin_array();
  for (const int64_t n : p.cells) out.value(n);
  out.end_array().field("grid_hash", p.grid_hash).field("total", p.total).key("parts").begin_array();
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
  p.options.ranks = whole_number("ranks", root);
  const auto method = std::ranges::find(kMethods, root.at("method").get<std::string>(), [](const char* name) { return std::string(name); });
  if (method == std::end(kMethods)) throw InputError("partition: method: expected blocks or slabs");
  p.options.method = static_cast<PartitionMethod>(method - kMethods);
  p.options.align = whole_number("align", root);
  p.options.halo = whole_number("halo", root);
  for (const auto& [name, weight] : root.at("weights").items()) p.materials.push_back(name), p.options.weights.push_back(work_of(weight, "weights"));
  p.cells = whole_numbers<3>("cells", root);
  p.grid_hash = root.at("grid_hash");
  p.total = work_of(root.at("total"), "total");
  for (const json& part : list("parts", root)) {
    if (whole_number("rank", part) != static_cast<int64_t>(p.parts.size()))
      throw InputError(fmt::format("partition: expected the parts in the order of their ranks, found another at {}", p.parts.size()));
    Part& out = p.parts.emplace_back(Part{box_of("box", part), work_of(part.at("weight"), "weight"), box_of("halo_box", part), {}});
    for (const json& rank : list("neighbours", part)) out.neighbours.push_back(whole_number(rank, "neighbours"));
  }
  check(p);
  return p;
} catch (const json::exception& e) {
  throw InputError(fmt::format("partition: expected what teracell partition writes: {}", e.what()));
}

}  // namespace teracell::store

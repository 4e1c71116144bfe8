#include "mesher/survey/survey.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include <fmt/format.h>

#include "mesher/closing/boundary.hpp"
#include "mesher/closing/lengths.hpp"
#include "mesher/surface/cad_parts.hpp"
#include "mesher/surface/input.hpp"
#include "mesher/surface/part_path.hpp"
#include "mesher/surface/read_facets.hpp"
#include "store/base/error.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {
namespace {

// Takes the facets of a part one by one.
class Measure {
 public:
  void add(const Facet& f) {
    if (facets_++ == 0) origin_ = f.vertex[0];
    boundary_.add(vertex_hashes(f));
    std::array<Vec3, 3> p = f.vertex;
    for (Vec3& v : p) {
      extend(lo_, hi_, v);
      for (size_t d = 0; d < 3; ++d) v[d] -= origin_[d];  // volumes of small parts far from 0 keep their digits
    }
    const Vec3 n = cross(p[1] - p[0], p[2] - p[0]);
    area_ += std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
    const Vec3 m = cross(p[1], p[2]);
    volume_ += (p[0][0] * m[0] + p[0][1] * m[1] + p[0][2] * m[2]) / 6;
  }
  void put_into(PartKind& kind) const {
    kind.facets = facets_;
    if (facets_ == 0) return;
    kind.closed = boundary_.directed_boundary_is_empty();
    kind.lo = lo_, kind.hi = hi_;
    kind.volume = std::abs(static_cast<double>(volume_)), kind.area = static_cast<double>(area_);
  }

 private:
  Vec3 origin_{}, lo_ = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi_ = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  uint64_t facets_ = 0;
  BoundaryProof boundary_;
  long double volume_ = 0, area_ = 0;
};

uint64_t count_open_edges(const FacetPass& facets, const Budget& budget, const std::string& name) {
  uint64_t edges = 0;
  for (const BoundaryEdge& e : boundary_edges(facets, budget.bytes / 4, name)) edges += e.net;
  return edges;
}

// Equal for parts of one kind: their shape, looks, and scale, which is the products of their matrix's columns, to six digits.
std::string key_of(const PartNode& node, const Matrix& m) {
  std::string out = fmt::format("{}\n{}\n{}\n{}", *node.shape, node.product, node.color, node.material);
  for (size_t a = 0; a < 3; ++a)
    for (size_t b = a; b < 3; ++b) {
      const double product = m[a] * m[b] + m[4 + a] * m[4 + b] + m[8 + a] * m[8 + b];
      const double scale =
          std::sqrt((m[a] * m[a] + m[4 + a] * m[4 + a] + m[8 + a] * m[8 + a]) * (m[b] * m[b] + m[4 + b] * m[4 + b] + m[8 + b] * m[8 + b]));
      out += a == b ? fmt::format(" {:.6e}", product) : fmt::format(" {}", std::lround(scale > 0 ? 1e6 * product / scale : 0));
    }
  return out;
}

void survey_tree(PartTree& tree, const Budget& budget, FileSurvey& out) {
  std::unordered_map<std::string, size_t> known;
  for (const Part& part : tree.parts()) {
    const auto [kind, fresh] = known.try_emplace(key_of(tree.node(part), part.matrix), out.kinds.size());
    out.places.push_back({part.path, kind->second});
    if (!fresh) {
      ++out.kinds[kind->second].instances;
      tree.for_each_vertex(part, [&](const Vec3& v) { extend(out.lo, out.hi, v); });
      continue;
    }
    const PartNode& node = tree.node(part);
    PartKind& found = out.kinds.emplace_back();
    found.path = part.path;
    found.product = node.product, found.color = node.color, found.material = node.material;
    Measure measure;
    tree.read(part, [&](const Facet& f) { measure.add(f); });
    measure.put_into(found);
    if (found.facets == 0) continue;
    extend(out.lo, out.hi, found.lo), extend(out.lo, out.hi, found.hi);
    if (!found.closed)
      found.open_edges = count_open_edges([&](const std::function<void(const Facet&)>& f) { tree.read(part, f); }, budget, tree.name());
  }
}

void add_volumes(const PartTree& tree, FileSurvey& out) {
  std::vector<uint32_t> all(tree.parts().size());
  std::iota(all.begin(), all.end(), 0);
  const std::vector<CadPart> parts = cad_parts(tree, all, *out.file.cad);
  for (std::string& w : cad_warnings(parts, *out.file.cad)) out.file.warnings.push_back(std::move(w));
  for (size_t i = 0; i < tree.parts().size(); ++i) {
    PartKind& kind = out.kinds[out.places[i].kind];
    if (kind.path != tree.parts()[i].path) continue;
    const CadShape& shape = out.file.cad->shapes[*tree.node(tree.parts()[i]).shape];
    const double scale = std::abs(determinant(tree.parts()[i].matrix));
    kind.kernel_volume = shape.kernel_volume, kind.sender_volume = shape.sender_volume;
    for (std::optional<double>* v : {&kind.kernel_volume, &kind.sender_volume})
      if (*v) **v *= scale;
  }
}

// The file is read once more, however many parts are open: their facets are put beside each other, part by part.
void count_open_edges_of_flat(const std::filesystem::path& path, const Budget& budget, std::vector<PartKind>& kinds) {
  struct Stretch {  // of a part's facets, in bytes
    uint64_t first, next, end;
  };
  std::vector<Stretch> stretches;
  uint64_t bytes = 0;
  for (const PartKind& kind : kinds) {
    const uint64_t first = bytes;
    if (!kind.closed) bytes += kind.facets * sizeof(Facet);
    stretches.push_back({first, first, bytes});
  }
  if (bytes == 0) return;
  const auto fail = [&] { throw InputError(fmt::format("{}: the file changed while it was read", path.string())); };
  SpillFile file(budget.folder, bytes, bytes <= budget.bytes / 4);
  size_t here = 0;
  const auto put = [&](std::span<const Facet> facets) {
    if (here >= kinds.size()) fail();
    Stretch& s = stretches[here];
    if (kinds[here].closed) return;
    if (facets.size_bytes() > s.end - s.next) fail();
    file.write(s.next, {reinterpret_cast<const uint8_t*>(facets.data()), facets.size_bytes()});
    s.next += facets.size_bytes();
  };
  read_facets(path, "", put, {.budget = budget, .enter_patch = [&](uint32_t patch) { here = patch; }});
  std::vector<Facet> block;
  for (size_t i = 0; i < kinds.size(); ++i) {
    const Stretch& s = stretches[i];
    if (s.next != s.end) fail();
    if (kinds[i].closed) continue;
    const auto pass = [&](const std::function<void(const Facet&)>& f) {
      for (uint64_t at = s.first; at < s.end; at += block.size() * sizeof(Facet)) {
        block.resize(std::min<uint64_t>(4096, (s.end - at) / sizeof(Facet)));
        file.read(at, {reinterpret_cast<uint8_t*>(block.data()), block.size() * sizeof(Facet)});
        std::ranges::for_each(block, f);
      }
    };
    kinds[i].open_edges = count_open_edges(pass, budget, path.string());
  }
}

// Files without a tree: their groups, objects or solids are their parts.
void survey_flat(Input& input, const std::filesystem::path& path, const Budget& budget, FileSurvey& out) {
  std::vector<Measure> parts;
  size_t now = 0;
  const auto enter = [&](uint32_t patch) {
    now = patch;
    parts.resize(std::max(parts.size(), now + 1));
  };
  out.file = read_facets(input, "",
                         [&](std::span<const Facet> facets) {
                           for (const Facet& f : facets) parts[now].add(f);
                         },
                         {.budget = budget, .enter_patch = enter});
  for (size_t i = 0; i < parts.size(); ++i) {
    PartKind& kind = out.kinds.emplace_back();
    const std::string& name = out.file.patches[i];
    kind.path = path_below("", name.empty() ? kUnnamedPart : name);
    kind.product = name;
    parts[i].put_into(kind);
    extend(out.lo, out.hi, kind.lo), extend(out.lo, out.hi, kind.hi);
  }
  if (out.file.regular) count_open_edges_of_flat(path, budget, out.kinds);
}

}  // namespace

FileSurvey survey(const std::filesystem::path& path, const Budget& budget, const CadOptions& cad) {
  FileSurvey out;
  out.lo.fill(HUGE_VAL), out.hi.fill(-HUGE_VAL);
  Input input(path);
  KeptTree kept;
  out.tree = kept.open(input, {.budget = budget, .cad = std::make_shared<const CadOptions>(cad)});
  if (!out.tree) survey_flat(input, path, budget, out);
  else {
    if (kept.tree->parts().empty()) refuse_empty(path.string(), kept.file);
    out.file = std::move(kept.file);
    survey_tree(*kept.tree, budget, out);
    if (out.file.cad) add_volumes(*kept.tree, out);
  }
  return out;
}

}  // namespace teracell::mesher

#include "mesher/run/part_found.hpp"

#include <bit>

#include <fmt/format.h>

namespace teracell::mesher {
namespace {

// Puts values, or takes them, in one order, so that each structure is listed once.
class Put {
 public:
  explicit Put(Bytes& out) : out_(out) {}
  template <class T>
    requires std::is_integral_v<T> || std::is_enum_v<T>
  void operator()(const T& n) {
    put_varint(out_, static_cast<uint64_t>(n));
  }
  void operator()(const double& d) { put_fixed(out_, std::bit_cast<uint64_t>(d)); }
  void operator()(const std::string& text) { put_sized(out_, text); }
  template <class T>
  void operator()(const std::vector<T>& list) {
    put_varint(out_, list.size());
    for (const T& item : list) fields(*this, item);
  }

 private:
  Bytes& out_;
};

class Take {
 public:
  explicit Take(ByteReader& in) : in_(in) {}
  template <class T>
    requires std::is_integral_v<T> || std::is_enum_v<T>
  void operator()(T& n) {
    n = static_cast<T>(in_.varint());
  }
  void operator()(double& d) { d = std::bit_cast<double>(in_.fixed<uint64_t>()); }
  void operator()(std::string& text) {
    const auto bytes = in_.take(in_.varint());
    text.assign(bytes.begin(), bytes.end());
  }
  template <class T>
  void operator()(std::vector<T>& list) {
    list.clear();  // and grows with what is there, not with what a number says
    for (uint64_t left = in_.varint(0, in_.remaining(), "entries"); left > 0; --left) fields(*this, list.emplace_back());
  }

 private:
  ByteReader& in_;
};

template <class Way, class T>
void or_nothing(Way& way, T& number) {
  bool there = number.has_value();
  double value = number.value_or(0);
  way(there), way(value);
  if constexpr (!std::is_const_v<T>) number = there ? std::optional(value) : std::nullopt;
}

// What the CAD kernel said, without what was said of parts that are not taken.
template <class Way, class File>
void put_cad(Way& way, File& file) {
  bool there = file.cad != nullptr;
  way(there);
  if (!there) return;
  CadFacts facts = file.cad ? CadFacts{file.cad->kernel, file.cad->key, file.cad->hash, file.cad->deflection, file.cad->angle, {}} : CadFacts{};
  way(facts.kernel), way(facts.key), way(facts.hash), way(facts.deflection), way(facts.angle), way(file.cad_parts);
  if constexpr (!std::is_const_v<File>) file.cad = std::make_shared<const CadFacts>(std::move(facts));
}

template <class Way, class Planes>
void put_planes(Way& way, Planes& planes) {
  bool there = planes.has_value();
  way(there);
  if (!there) return;
  if constexpr (!std::is_const_v<Planes>) planes.emplace();
  way(planes->breaches), way(planes->left_out), way(planes->warnings);
}

// The fields of `T`, const or not.
template <class Way, class T>
void fields(Way& way, T& item) {
  using Item = std::remove_const_t<T>;
  const auto all = [&](auto&... values) { (way(values), ...); };
  const auto place = [&](auto& p) { all(p[0], p[1], p[2]); };
  if constexpr (std::is_same_v<Item, Vec3>) {
    place(item);
  } else if constexpr (std::is_same_v<Item, FillChoice>) {
    bool counted = item.shells.has_value();
    uint64_t shells = item.shells.value_or(0);
    all(item.rule, counted, shells, item.why);
    if constexpr (!std::is_const_v<T>) item.shells = counted ? std::optional(shells) : std::nullopt;
  } else if constexpr (std::is_same_v<Item, Hole>) {
    place(item.at), place(item.lo), place(item.hi);
    all(item.edges, item.diameter, item.width, item.cap_area, item.off_plane, item.extruded);
  } else if constexpr (std::is_same_v<Item, Flip>) {
    place(item.at);
    all(item.edges);
  } else if constexpr (std::is_same_v<Item, SurfaceCounts>) {
    all(item.degenerate, item.duplicates, item.opposite, item.shells);
  } else if constexpr (std::is_same_v<Item, PlaneBreach>) {
    all(item.axis, item.rule, item.at, item.found, item.expected);
  } else if constexpr (std::is_same_v<Item, CadPart>) {
    all(item.path, item.instances, item.shape.faces, item.shape.faces_without_facets, item.shape.closed, item.shape.facet_volume,
        item.shape.facet_area);
    or_nothing(way, item.shape.kernel_volume), or_nothing(way, item.shape.sender_volume);
  } else if constexpr (std::is_same_v<Item, BodyFacets>) {
    all(item.file.format, item.file.bytes, item.file.hash, item.file.facets, item.file.warnings);
    all(item.file.unit, item.file.factor.p, item.file.factor.q);
    put_cad(way, item.file);
    place(item.lo), place(item.hi);
    auto& closed = item.closed;
    all(closed.fill, closed.was_open, closed.holes, closed.flips, closed.stitch, closed.cut_from_others);
    all(closed.seams.number, closed.seams.length, closed.seams.widest_gap, closed.seams.collapsed);
  } else {
    way(item);
  }
}

}  // namespace

Bytes encode_found(const CastTotals& totals, const SurfacesFound* surfaces) {
  Bytes out;
  totals.save(out);
  out.push_back(surfaces != nullptr);
  if (!surfaces) return out;
  Put put(out);
  put(normalised(surfaces->scene));
  put(surfaces->bodies.bodies);
  put(surfaces->counts);
  put(surfaces->rays.axis), put(surfaces->rays.asked_for), fields(put, surfaces->rays.crossings);
  put(surfaces->thin), put(surfaces->all_patches);
  put_planes(put, surfaces->planes);
  return out;
}

PartFound decode_found(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader in(bytes, name);
  PartFound out;
  out.totals = CastTotals::restored(in);
  if (in.fixed<uint8_t>() != 0) {
    SurfacesFound& surfaces = out.surfaces.emplace();
    Take take(in);
    std::string scene;
    take(scene);
    try {
      surfaces.scene = parse_scene(scene, {});
    } catch (const Error& e) {
      in.fail(fmt::format("the scene: {}", e.what()));
    }
    take(surfaces.bodies.bodies);
    take(surfaces.counts);
    take(surfaces.rays.axis), take(surfaces.rays.asked_for), fields(take, surfaces.rays.crossings);
    take(surfaces.thin), take(surfaces.all_patches);
    put_planes(take, surfaces.planes);
  }
  in.expect_end();
  return out;
}

void expect_fit(const CastTotals& totals, const SurfacesFound& surfaces, const Metadata& meta, const std::string& name) {
  const auto expect = [&](bool fits, const char* what) {
    if (!fits) throw FormatError(fmt::format("{}: what was found does not fit the grid: {}", name, what));
  };
  const size_t bodies = surfaces.scene.bodies.size();
  expect(surfaces.bodies.bodies.size() == bodies && surfaces.counts.size() == bodies && totals.cells.size() == bodies, "it is of other bodies");
  expect(surfaces.rays.axis == meta.ray_axis, "its rays run along another axis");
  for (const BodyFacets& body : surfaces.bodies.bodies)
    for (const FillChoice& fill : body.closed.fill) expect(static_cast<size_t>(fill.rule) < kFillNames.size(), "there is no such fill rule");
  if (surfaces.planes)
    for (const PlaneBreach& b : surfaces.planes->breaches)
      expect(b.axis >= 0 && b.axis < 3 && static_cast<size_t>(b.rule) < kPlaneRuleNames.size(), "its planes break no rule that there is");
  for (const auto& [key, tally] : totals.tallies.all()) {
    using What = TallyKey::What;
    expect(key.what <= What::kLowerSide && key.axis < 3, "it counts something else");
    expect(key.of < (key.what == What::kGaps ? surfaces.scene.materials.size() : bodies), "it counts in something else");
    Index3 last = tally.cell;
    if (key.what != What::kLowerSide) ++last[key.axis];  // it lies between two sample points
    for (int d = 0; d < 3; ++d) expect(tally.cell[d] >= 0 && last[d] < meta.grid.axis[d].cells(), "it lies outside");
    const bool has_length = key.what == What::kStretches || key.what == What::kGaps;
    const double length = has_length ? length_of(meta.grid.axis[key.axis], tally.cell[key.axis], tally.widest) : 0;
    expect(tally.length == length, "it has another length");
  }
  totals.overlaps.for_each([&](const Overlap& o) {
    expect(o.bodies[0] < o.bodies[1] && o.bodies[1] < bodies, "bodies that are not there overlap");
    for (int d = 0; d < 3; ++d) expect(o.box.hi[d] <= meta.grid.axis[d].cells(), "bodies overlap outside");
  });
}

}  // namespace teracell::mesher

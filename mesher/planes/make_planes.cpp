#include "mesher/planes/make_planes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "mesher/planes/breaches.hpp"
#include "mesher/planes/candidates.hpp"
#include "mesher/planes/fill.hpp"
#include "store/base/error.hpp"
#include "store/grid/number_text.hpp"

namespace teracell::mesher {
namespace {

using Rank = Candidate::Rank;
constexpr int64_t kMostCells = int64_t{1} << 26;  // along an axis: all planes are in memory

// One axis on its way from the scene's rules to planes.
class AxisMaking {
 public:
  AxisMaking(const Scene& scene, int axis, const std::vector<ShapeOfBody>& shapes, const std::array<double, 2>& domain)
      : scene_(scene), d_(axis), rules_(*scene.axis[axis].made), shapes_(shapes), lo_(domain[0]), hi_(domain[1]) {}

  void make(MadePlanes& out) {
    const Kept kept = merged(candidates(), rules_.finest, face_slack({lo_, hi_}));
    const Widths widths(lo_, hi_, rules_.coarsest, resolutions(out.report.warnings));
    for (const Loss& loss : kept.losses) out.report.warnings.push_back(words(loss));
    try {
      out.planes[d_] = fill_between(kept.at, widths, rules_.finest, rules_.growth, kMostCells);
    } catch (const UsageError& e) {
      throw UsageError(fmt::format("axis {} of the grid: {}", axis_name(d_), e.what()));
    }
    add_breaches(d_, out.planes[d_], kept.at, widths, rules_, out.report);
  }

 private:
  std::vector<Candidate> candidates() const {
    std::vector<Candidate> out = {{lo_, Rank::kSide}, {hi_, Rank::kSide}};
    for (const double at : rules_.fixed) {
      if (!(at >= lo_ && at <= hi_)) refuse_fixed(d_, lo_, hi_, at);
      out.push_back({at, Rank::kFixed});
    }
    if (rules_.snap == AutoPlanes::Snap::kNone) return out;
    const double slack = face_slack({lo_, hi_});
    for (const size_t b : by_name())
      for (const FlatArea& face : grouped(shapes_[b].faces->axis[d_], slack, rules_.finest * rules_.finest)) add_face(face, b, out);
    return out;
  }

  void add_face(const FlatArea& face, size_t b, std::vector<Candidate>& out) const {
    const auto add = [&](double at) {
      if (at > lo_ && at < hi_) out.push_back({at, Rank::kFace, face.area, b});
    };
    const ShapeOfBody& shape = shapes_[b];
    const double step = std::max(within(b).step.value_or(rules_.finest), 3 * rules_.finest);
    const double outwards = shape.faces->volume < 0 ? -face.facing : face.facing;
    const bool thirds =
        rules_.snap == AutoPlanes::Snap::kThirds && is_metal(b) && shape.hi[d_] - shape.lo[d_] > step && std::abs(outwards) > 1e-9 * face.area;
    if (!thirds) return add(face.at);
    const double sign = outwards > 0 ? 1 : -1;
    add(face.at - sign * (step / 3));
    add(face.at + sign * (2 * step / 3));
  }

  // So that the order of bodies decides nothing.
  std::vector<size_t> by_name() const {
    std::vector<size_t> out(shapes_.size());
    std::iota(out.begin(), out.end(), size_t{0});
    std::ranges::sort(out, {}, [&](size_t b) -> const std::string& { return scene_.bodies[b].name; });
    return out;
  }
  const std::string& material_of(size_t b) const { return scene_.materials[scene_.bodies[b].material].name; }
  bool is_metal(size_t b) const {
    return std::ranges::any_of(rules_.metals, [&](const std::string& m) { return m == scene_.bodies[b].name || m == material_of(b); });
  }
  // By the body's name and by its material's: the finer of both.
  CellsWithin within(size_t b) const {
    CellsWithin out;
    for (const std::string& name : {scene_.bodies[b].name, material_of(b)}) {
      const auto found = rules_.resolution.find(name);
      if (found == rules_.resolution.end()) continue;
      const auto& [step, across] = found->second;
      if (step) out.step = std::min(*step, out.step.value_or(*step));
      if (across) out.across = std::max(*across, out.across.value_or(*across));
    }
    return out;
  }

  std::vector<Resolution> resolutions(std::vector<std::string>& warnings) const {
    std::vector<Resolution> out;
    for (const size_t b : by_name()) {
      const CellsWithin cells = within(b);
      const ShapeOfBody& shape = shapes_[b];
      const double extent = shape.hi[d_] - shape.lo[d_];
      if (!(extent > 0)) continue;
      double most = cells.step.value_or(rules_.coarsest);
      if (cells.across) {
        const double wanted = extent / static_cast<double>(*cells.across);
        if (wanted < rules_.finest)
          warnings.push_back(fmt::format("axis {}: {} cells across body '{}' would be {} {} wide: they are as wide as \"finest\" allows, {}",
                                         axis_name(d_), *cells.across, scene_.bodies[b].name, number_text(wanted, 3), scene_.units, rules_.finest));
        most = std::min(most, std::max(wanted, rules_.finest));
      }
      if (most < rules_.coarsest) out.push_back({shape.lo[d_], shape.hi[d_], most});
    }
    return out;
  }

  std::string name_of(const Candidate& c) const {
    if (c.rank == Rank::kSide) return "the domain's side";
    if (c.rank == Rank::kFixed) return "the fixed plane";
    return fmt::format("a face of body '{}'", scene_.bodies[c.body].name);
  }
  std::string words(const Loss& l) const {
    return fmt::format("axis {}: no plane for {} at {}: it is {} {} from {} at {}, and \"finest\" is {}", axis_name(d_), name_of(l.lost),
                       number_text(l.lost.at, 9), number_text(std::abs(l.lost.at - l.kept.at), 3), scene_.units, name_of(l.kept),
                       number_text(l.kept.at, 9), rules_.finest);
  }

  const Scene& scene_;
  const int d_;
  const AutoPlanes& rules_;
  const std::vector<ShapeOfBody>& shapes_;
  const double lo_, hi_;
};

// Names of materials without a body mean nothing.
void warn_of_unused(const Scene& scene, std::vector<std::string>& warnings) {
  std::set<std::string_view> used;
  for (const SceneBody& b : scene.bodies) used.insert(b.name), used.insert(scene.materials[b.material].name);
  std::set<std::pair<std::string_view, std::string_view>> unused;
  for (const SceneAxis& axis : scene.axis) {
    if (!axis.made) continue;
    for (const auto& [name, within] : axis.made->resolution)
      if (!used.contains(name)) unused.emplace("resolution", name);
    for (const std::string& name : axis.made->metals)
      if (!used.contains(name)) unused.emplace("metals", name);
  }
  for (const auto& [key, name] : unused) warnings.push_back(fmt::format("grid: \"{}\" names the material '{}', which no body has", key, name));
}

}  // namespace

bool makes_planes(const Scene& scene) {
  return std::ranges::any_of(scene.axis, [](const SceneAxis& a) { return a.made.has_value(); });
}

std::array<double, 2> domain_of(const AutoPlanes& made, const SceneAxis& axis, double lo, double hi) {
  const double around = static_cast<double>(made.pad) * made.coarsest;
  return axis.min ? std::array{*axis.min, *axis.max} : std::array{lo - around, hi + around};
}

MadePlanes make_planes(const Scene& scene, const std::vector<ShapeOfBody>& shapes, const Vec3& lo, const Vec3& hi) {
  MadePlanes out;
  for (int d = 0; d < 3; ++d) {
    if (!scene.axis[d].made) continue;
    const auto domain = domain_of(*scene.axis[d].made, scene.axis[d], lo[d], hi[d]);
    if (!(domain[0] < domain[1]))
      throw UsageError(fmt::format("axis {} of the grid: there is nothing that it could reach over: give it \"min\" and \"max\"{}", axis_name(d),
                                   lo[d] <= hi[d] ? ", or a \"pad\"" : ""));
    AxisMaking(scene, d, shapes, domain).make(out);
  }
  warn_of_unused(scene, out.report.warnings);
  return out;
}

}  // namespace teracell::mesher

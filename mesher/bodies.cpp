#include "mesher/bodies.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mesher/closure.hpp"
#include "store/background.hpp"
#include "store/error.hpp"

namespace teracell {
namespace {

std::string text(const Vec3& p) { return fmt::format("({}, {}, {})", p[0], p[1], p[2]); }

// The winding number is defined where every edge is matched by its reverse, the parity where every edge is used an even
// number of times.
void choose_rule(const SceneBody& body, const BoundaryProof& proof, BodyFacets& out) {
  const bool nonzero = proof.directed_boundary_is_empty(), evenodd = proof.undirected_boundary_is_empty();
  if (body.fill != Fill::kAuto) {
    out.rule = body.fill;
    out.why = "asked for";
  } else if (nonzero || !evenodd) {
    out.rule = Fill::kNonzero;
    out.why = "closed: every edge is matched by its reverse";
  } else {
    out.rule = Fill::kEvenodd;
    out.why = "closed, but some facets are oriented the other way round: every edge is used an even number of times";
  }
  if (out.rule == Fill::kNonzero ? nonzero : evenodd) return;

  BoundaryEdges boundary;
  read_facets(body.mesh, body.part, [&](std::span<const Facet> facets) {
    for (const Facet& f : facets) boundary.add(f);
  });
  const auto edges = out.rule == Fill::kNonzero ? boundary.directed() : boundary.undirected();
  if (edges.empty()) throw InputError(fmt::format("{}: the file changed while it was read", body.mesh.string()));
  Vec3 lo = edges[0].from, hi = lo;
  for (const auto& e : edges)
    for (const Vec3* p : {&e.from, &e.to})
      for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], (*p)[d]), hi[d] = std::max(hi[d], (*p)[d]);
  const auto& e = edges[0];
  throw InputError(fmt::format(
      "{}: body '{}' is not closed: expected every edge to be {}, found {} edge{} that {} not, within the box {} to {}; the first runs from {} to {} "
      "(coordinates of the mesh). Close the surface{}{}",
      body.mesh.string(), body.name, out.rule == Fill::kNonzero ? "matched by its reverse" : "used an even number of times", edges.size(),
      edges.size() == 1 ? "" : "s", edges.size() == 1 ? "is" : "are", text(lo), text(hi), text(e.from), text(e.to),
      out.rule == Fill::kNonzero && evenodd ? ", orient its facets alike or use fill evenodd" : "",
      body.part.empty() ? "" : fmt::format("; part '{}' may be cut off from parts that were left out", body.part)));
}

// The one pass over a body's facets: is it closed, and what box holds it once its matrix has moved it?
struct Study {
  BoundaryProof proof;
  Vec3 lo, hi;

  void take(std::span<SceneFacet> facets, const SceneBody& body) {
    const bool moved = body.matrix != kIdentity;
    for (SceneFacet& f : facets) {
      proof.add(f.facet);
      for (Vec3& p : f.facet.vertex) {
        if (moved) {
          p = transform(body.matrix, p);
          for (double& x : p)
            if (!(std::abs(x) >= 1e-75 && std::abs(x) <= 1e75))  // rare: 0 is fine, and -0 becomes +0
              x = checked_coordinate(x, fmt::format("{}: a vertex after the matrix of body '{}'", body.mesh.string(), body.name));
        }
        for (int d = 0; d < 3; ++d) {
          lo[d] = std::min(lo[d], p[d]);
          hi[d] = std::max(hi[d], p[d]);
        }
      }
    }
  }
};

}  // namespace

Bodies read_bodies(const Scene& scene, int threads, const std::function<void(double)>& tick) {
  Bodies out;
  out.lo.fill(HUGE_VAL);
  out.hi.fill(-HUGE_VAL);
  for (uint32_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    Study study{{}, out.lo, out.hi};
    Background background(threads > 1);  // after the study, which it uses
    BodyFacets found;
    found.first = out.facets.size();
    found.file = read_facets(body.mesh, body.part, [&](std::span<const Facet> facets) {
      while (!facets.empty()) {
        const std::span<SceneFacet> stored = out.facets.append(facets, b);
        facets = facets.subspan(stored.size());
        background.run([&study, &body, stored] { study.take(stored, body); });
      }
      tick(static_cast<double>(b) / static_cast<double>(scene.bodies.size()));
    });
    background.finish();
    out.lo = study.lo;
    out.hi = study.hi;
    choose_rule(body, study.proof, found);
    out.layers.push_back({b, found.rule == Fill::kEvenodd});
    out.bodies.push_back(std::move(found));
  }
  return out;
}

std::array<AxisCost, 3> axis_costs(const FacetStore& facets, const Grid& grid) {
  // Where a coordinate lies in units of cells; on a graded axis to the nearest centre. What lies outside costs nothing.
  Vec3 per_cell{};
  for (int d = 0; d < 3; ++d)
    if (!grid.axis[d].is_graded()) per_cell[d] = 1 / grid.axis[d].step();
  const auto place = [&](const Vec3& p) {
    Vec3 out;
    for (int d = 0; d < 3; ++d) {
      const Axis& a = grid.axis[d];
      out[d] = a.is_graded() ? static_cast<double>(a.first_centre_from(p[d]))
                             : std::clamp((p[d] - a.min()) * per_cell[d], 0.0, static_cast<double>(a.cells()));
    }
    return out;
  };
  Vec3 area{};
  facets.for_each(0, facets.size(), [&](const SceneFacet& f) {
    const Vec3 a = place(f.facet.vertex[0]), b = place(f.facet.vertex[1]), c = place(f.facet.vertex[2]);
    for (int d = 0; d < 3; ++d) {
      const auto [u, v, w] = Frame::along(d);
      area[d] += std::abs((b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u])) / 2;
    }
  });
  std::array<AxisCost, 3> out;
  for (int d = 0; d < 3; ++d) {
    const auto [u, v, w] = Frame::along(d);
    out[d] = {area[d], static_cast<double>(grid.axis[u].cells()) * static_cast<double>(grid.axis[v].cells())};
  }
  return out;
}

}  // namespace teracell

#include "mesher/bodies.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mesher/closure.hpp"
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

}  // namespace

Bodies read_bodies(const Scene& scene, const std::function<void(double)>& tick) {
  Bodies out;
  out.lo.fill(HUGE_VAL);
  out.hi.fill(-HUGE_VAL);
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    BodyFacets found;
    found.first = out.facets.size();
    BoundaryProof proof;
    const bool moved = body.matrix != kIdentity;
    found.file = read_facets(body.mesh, body.part, [&](std::span<const Facet> facets) {
      for (const Facet& facet : facets) {
        proof.add(facet);
        SceneFacet& f = out.facets.emplace_back(SceneFacet{facet, static_cast<uint32_t>(b)});
        for (Vec3& p : f.facet.vertex) {
          if (moved) {
            p = transform(body.matrix, p);
            for (double& x : p)
              if (!(std::abs(x) >= 1e-75 && std::abs(x) <= 1e75))  // rare: 0 is fine, and -0 becomes +0
                x = checked_coordinate(x, fmt::format("{}: a vertex after the matrix of body '{}'", body.mesh.string(), body.name));
          }
          for (int d = 0; d < 3; ++d) {
            out.lo[d] = std::min(out.lo[d], p[d]);
            out.hi[d] = std::max(out.hi[d], p[d]);
          }
        }
      }
      tick(static_cast<double>(b) / static_cast<double>(scene.bodies.size()));
    });
    found.count = out.facets.size() - found.first;
    choose_rule(body, proof, found);
    out.layers.push_back({static_cast<uint32_t>(b), found.rule == Fill::kEvenodd});
    out.bodies.push_back(std::move(found));
  }
  return out;
}

AxisCost axis_cost(const std::vector<SceneFacet>& facets, const Grid& grid, int axis) {
  const Frame f = Frame::along(axis);
  const Axis &u = grid.axis[f.u], &v = grid.axis[f.v];
  // Where a coordinate lies in units of cells; on a graded axis to the nearest centre.
  const auto place = [](const Axis& a, double x) {
    if (a.is_graded()) return static_cast<double>(a.first_centre_from(x));
    return std::clamp((x - a.min()) / a.step(), 0.0, static_cast<double>(a.cells()));  // what lies outside costs nothing
  };
  double area = 0;
  for (const SceneFacet& facet : facets) {
    const auto& [a, b, c] = facet.facet.vertex;
    const double au = place(u, a[f.u]), av = place(v, a[f.v]);
    area += std::abs((place(u, b[f.u]) - au) * (place(v, c[f.v]) - av) - (place(v, b[f.v]) - av) * (place(u, c[f.u]) - au)) / 2;
  }
  return {area, static_cast<double>(u.cells()) * static_cast<double>(v.cells())};
}

}  // namespace teracell

// OpenVDB: mesh -> signed distance field -> mask of the inside -> .vdb file. The time to beat is that of the whole process.
// Usage: openvdb_peer mesh.obj N out.vdb
//
// The field's band is the library's default, 3 cells; cells are those of the cubic domain, with samples at centres.
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include <cstdio>

#include "tools/bench/peers/mesh_domain.hpp"

namespace teracell::bench {
namespace {

void run(const Arguments& arguments) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 2);
  const Stopwatch whole;
  openvdb::initialize();
  const Mesh mesh = load_obj(arguments[0]);
  const CubicDomain domain = cubic_domain(mesh, whole_number(arguments[1]));

  // Index (i, j, k) is the place of that cell's centre.
  const auto transform = openvdb::math::Transform::createLinearTransform(domain.step);
  transform->postTranslate({domain.centre(0, 0), domain.centre(1, 0), domain.centre(2, 0)});
  std::vector<openvdb::Vec3s> points;
  points.reserve(mesh.vertices.size());
  for (const auto& v : mesh.vertices) points.emplace_back(openvdb::Vec3d(v[0], v[1], v[2]));
  std::vector<openvdb::Vec3I> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);

  const auto field = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, points, triangles);
  const double field_seconds = whole.seconds();
  const auto mask = openvdb::tools::sdfInteriorMask(*field);
  mask->setName("inside");
  openvdb::io::File file(arguments[2]);
  file.write({mask});
  file.close();
  std::printf("{\"peer\": \"openvdb\", \"field_seconds\": %.4f, \"seconds\": %.4f, \"cells_inside\": %llu}\n", field_seconds, whole.seconds(),
              static_cast<unsigned long long>(mask->activeVoxelCount()));
}

}  // namespace
}  // namespace teracell::bench

int main(int argc, char** argv) { return teracell::bench::peer_main(argc, argv, "openvdb_peer mesh.obj N out.vdb", 3, 3, teracell::bench::run); }

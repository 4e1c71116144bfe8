// Embree 3: N x N rays along z through a mesh's cubic domain, every hit collected by a filter function that rejects it.
// Usage: embree_peer mesh.obj N [way]    a way is one of kWays, e.g. rtcIntersect1
//
// The scene is "robust" (watertight edge tests), as that of any voxelizer must be. The build quality is medium, because high
// quality splits facets in space and would report a hit twice. Without a way on the command line, the fastest is taken: each of
// kWays casts a sample of the rays, and the fastest of them casts them all. Only that last casting is timed. A packet's rays
// form a block, the most coherent shape. Packets gain much: where rtcIntersect1 took 5 s for 10^8 rays on two AVX-512 cores,
// the best packets took 1 s.
#include <embree3/rtcore.h>

#include <atomic>
#include <cstdio>
#include <thread>

#include "tools/bench/peers/mesh_domain.hpp"

namespace teracell::bench {
namespace {

constexpr int kThreads = 2;
constexpr int kBandRows = 8;   // a thread's unit of work; a multiple of the rows of every block
constexpr int kSampling = 32;  // one band in 32 is cast to choose the way
constexpr int kMaxLanes = 64;
constexpr int kMaxHits = 64;  // the depths of a ray's first 64 hits are kept; further hits are only counted

struct Tally {
  uint64_t hits = 0;
  uint64_t odd_rays = 0;
};

// Embree passes its context to the filter, so the hits of the block's rays are behind it in memory.
struct CollectingContext {
  RTCIntersectContext base;
  uint32_t hits[kMaxLanes];
  float depth[kMaxLanes][kMaxHits];
};

void collect_and_reject(const RTCFilterFunctionNArguments* args) {
  auto* collecting = reinterpret_cast<CollectingContext*>(args->context);
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] == 0) continue;
    const unsigned ray = RTCRayN_id(args->ray, args->N, lane);
    const uint32_t hit = collecting->hits[ray]++;
    if (hit < kMaxHits) collecting->depth[ray][hit] = RTCRayN_tfar(args->ray, args->N, lane);
    args->valid[lane] = 0;
  }
}

// A block of rays: kPackets packets of kWidth rays each.
template <int kWidth, int kPackets>
struct Block {
  static constexpr int kLanes = kWidth * kPackets;
  static constexpr int kColumns = kLanes == 1 ? 1 : kLanes == 4 ? 2 : kLanes == 64 ? 8 : 4;
  static constexpr int kRows = kLanes / kColumns;
  static_assert(kBandRows % kRows == 0 && kLanes <= kMaxLanes);

  alignas(64) RTCRayHitNt<kWidth> packets[kPackets];
  alignas(64) int valid[kLanes];

  // Sets all but the places of the rays. Casting changes none of it, because every hit is rejected.
  explicit Block(const CubicDomain& domain) {
    for (int lane = 0; lane < kLanes; ++lane) {
      auto& [ray, hit] = packets[lane / kWidth];
      const int i = lane % kWidth;
      ray.org_z[i] = static_cast<float>(domain.min[2]);
      ray.dir_x[i] = ray.dir_y[i] = 0;
      ray.dir_z[i] = 1;
      ray.tnear[i] = ray.time[i] = 0;
      ray.tfar[i] = static_cast<float>(domain.step * static_cast<double>(domain.n));
      ray.mask[i] = ~0u;
      ray.id[i] = static_cast<unsigned>(lane);
      ray.flags[i] = 0;
      hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
  }

  void place(const CubicDomain& domain, int64_t x0, int64_t y0) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const int64_t x = x0 + lane % kColumns, y = y0 + lane / kColumns;
      RTCRayNt<kWidth>& ray = packets[lane / kWidth].ray;
      ray.org_x[lane % kWidth] = static_cast<float>(domain.centre(0, x));
      ray.org_y[lane % kWidth] = static_cast<float>(domain.centre(1, y));
      // Lanes outside the domain are also switched off by a ray of negative length, because a stream has no valid flags.
      const bool inside = x < domain.n && y < domain.n;
      valid[lane] = inside ? -1 : 0;
      ray.tnear[lane % kWidth] = inside ? 0 : std::numeric_limits<float>::infinity();
    }
  }

  void cast(RTCScene scene, RTCIntersectContext* context, bool shadow) {
    auto* first = &packets[0];
    if constexpr (kPackets > 1) {
      auto* hits = reinterpret_cast<RTCRayHitN*>(first);
      auto* rays = reinterpret_cast<RTCRayN*>(first);
      shadow ? rtcOccludedNM(scene, context, rays, kWidth, kPackets, sizeof *first)
             : rtcIntersectNM(scene, context, hits, kWidth, kPackets, sizeof *first);
    } else if constexpr (kWidth == 1) {
      shadow ? rtcOccluded1(scene, context, reinterpret_cast<RTCRay*>(first)) : rtcIntersect1(scene, context, reinterpret_cast<RTCRayHit*>(first));
    } else if constexpr (kWidth == 4) {
      shadow ? rtcOccluded4(valid, scene, context, reinterpret_cast<RTCRay4*>(first))
             : rtcIntersect4(valid, scene, context, reinterpret_cast<RTCRayHit4*>(first));
    } else if constexpr (kWidth == 8) {
      shadow ? rtcOccluded8(valid, scene, context, reinterpret_cast<RTCRay8*>(first))
             : rtcIntersect8(valid, scene, context, reinterpret_cast<RTCRayHit8*>(first));
    } else {
      shadow ? rtcOccluded16(valid, scene, context, reinterpret_cast<RTCRay16*>(first))
             : rtcIntersect16(valid, scene, context, reinterpret_cast<RTCRayHit16*>(first));
    }
  }
};

// Casts every `every`-th band of rows.
template <int kWidth, int kPackets>
Tally cast_bands(RTCScene scene, const CubicDomain& domain, bool shadow, int64_t every) {
  using Rays = Block<kWidth, kPackets>;
  std::atomic<int64_t> next_row{0};
  Tally tallies[kThreads];
  const auto work = [&](Tally& result) {
    Tally tally;
    Rays rays(domain);
    CollectingContext collecting{};
    rtcInitIntersectContext(&collecting.base);
    collecting.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    collecting.base.filter = collect_and_reject;
    for (int64_t band; (band = next_row.fetch_add(kBandRows * every)) < domain.n;) {
      for (int64_t y = band; y < std::min(band + kBandRows, domain.n); y += Rays::kRows) {
        for (int64_t x = 0; x < domain.n; x += Rays::kColumns) {
          rays.place(domain, x, y);
          rays.cast(scene, &collecting.base, shadow);
          for (int lane = 0; lane < Rays::kLanes; ++lane) {
            tally.hits += collecting.hits[lane];
            tally.odd_rays += collecting.hits[lane] & 1;
            collecting.hits[lane] = 0;
          }
        }
      }
    }
    result = tally;
  };
  std::vector<std::thread> threads;
  for (Tally& t : tallies) threads.emplace_back(work, std::ref(t));
  for (std::thread& t : threads) t.join();
  Tally sum;
  for (const Tally& t : tallies) {
    sum.hits += t.hits;
    sum.odd_rays += t.odd_rays;
  }
  return sum;
}

struct Way {
  const char* name;
  Tally (*cast)(RTCScene, const CubicDomain&, bool shadow, int64_t every);
  bool shadow;
};
constexpr Way kWays[] = {
    {"rtcIntersect1", cast_bands<1, 1>, false},   {"rtcOccluded1", cast_bands<1, 1>, true},   {"rtcIntersect4", cast_bands<4, 1>, false},
    {"rtcOccluded4", cast_bands<4, 1>, true},     {"rtcIntersect8", cast_bands<8, 1>, false}, {"rtcOccluded8", cast_bands<8, 1>, true},
    {"rtcIntersect16", cast_bands<16, 1>, false}, {"rtcOccluded16", cast_bands<16, 1>, true}, {"rtcIntersectNM", cast_bands<16, 4>, false},
    {"rtcOccludedNM", cast_bands<16, 4>, true},
};

RTCScene build_scene(RTCDevice device, const Mesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices =
      static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
  for (const auto& v : mesh.vertices) vertices = std::copy(v.begin(), v.end(), vertices);
  auto* corners = static_cast<uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), mesh.triangles.size()));
  for (const auto& t : mesh.triangles) corners = std::copy(t.begin(), t.end(), corners);
  rtcCommitGeometry(geometry);

  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error("Embree refused the scene");
  return scene;
}

const Way& named_way(const std::string& name) {
  for (const Way& way : kWays) {
    if (name == way.name) return way;
  }
  std::string names;
  for (const Way& way : kWays) names += std::string(" ") + way.name;
  throw std::runtime_error("there is no way to cast called '" + name + "'; there are:" + names);
}

const Way& fastest_way(RTCScene scene, const CubicDomain& domain) {
  const Way* fastest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Way& way : kWays) {
    const Stopwatch sampling;
    const Tally tally = way.cast(scene, domain, way.shadow, kSampling);
    const double seconds = sampling.seconds();
    std::fprintf(stderr, "  %-15s sample %.3f s, %llu hits\n", way.name, seconds, static_cast<unsigned long long>(tally.hits));
    if (seconds >= least) continue;
    least = seconds;
    fastest = &way;
  }
  return *fastest;
}

void run(const Arguments& arguments) {
  const Mesh mesh = load_obj(arguments[0]);
  const int64_t n = whole_number(arguments[1]);
  const CubicDomain domain = cubic_domain(mesh, n);
  const RTCDevice device = rtcNewDevice("threads=2");
  const Stopwatch building;
  const RTCScene scene = build_scene(device, mesh);
  const double build_seconds = building.seconds();

  const Way& way = arguments.size() > 2 ? named_way(arguments[2]) : fastest_way(scene, domain);
  const Stopwatch casting;
  const Tally tally = way.cast(scene, domain, way.shadow, 1);
  const double seconds = casting.seconds();
  std::printf(
      "{\"peer\": \"embree\", \"way\": \"%s\", \"rays\": %lld, \"build_seconds\": %.4f, \"cast_seconds\": %.4f, "
      "\"hits\": %llu, \"odd_rays\": %llu}\n",
      way.name, static_cast<long long>(n * n), build_seconds, seconds, static_cast<unsigned long long>(tally.hits),
      static_cast<unsigned long long>(tally.odd_rays));
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
}

}  // namespace
}  // namespace teracell::bench

int main(int argc, char** argv) { return teracell::bench::peer_main(argc, argv, "embree_peer mesh.obj N [way]", 2, 3, teracell::bench::run); }

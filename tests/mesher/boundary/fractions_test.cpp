// Shares of mixed cells: equal to the cells of a finer grid that rational arithmetic decides, whatever the ray axis, engine, threads,
// chunks and interruptions.
#include "mesher/parts/merge.hpp"
#include "store/channels/fraction_reader.hpp"
#include "store/whole/verify.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/parts.hpp"
#include "tests/support/ties.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;

// Of every cell in the order z, y, x, its sub-samples by material.
using Shares = std::vector<std::vector<uint32_t>>;

// Written from the definition: each cell is divided, and sub-samples lie in the middle of its parts.
Axis finer(const Axis& axis, uint32_t parts) {
  if (!axis.is_graded()) return Axis::uniform(axis.origin(), axis.step() / parts, axis.first() * parts, axis.cells() * parts, 0.5);
  std::vector<double> planes;
  for (int64_t i = 0; i < axis.cells(); ++i) {
    const double lo = axis.planes()[static_cast<size_t>(i)], hi = axis.planes()[static_cast<size_t>(i) + 1];
    for (uint32_t k = 0; k < parts; ++k) planes.push_back(lo + (double(k) / parts) * (hi - lo));
  }
  planes.push_back(axis.planes().back());
  return Axis::graded(planes, 0.5);
}

Shares expected_shares(const std::vector<Body>& bodies, const Grid& grid, const Subdivision& s, uint32_t materials) {
  std::vector<Body> solids = bodies;
  std::erase_if(solids, [](const Body& b) { return b.sheet; });
  const Grid fine{{finer(grid.axis[0], s[0]), finer(grid.axis[1], s[1]), finer(grid.axis[2], s[2])}};
  const std::vector<uint32_t> cells = oracle::materials(solids, fine);
  const Index3 n = grid.cells(), m = fine.cells();
  Shares out(static_cast<size_t>(n[0] * n[1] * n[2]), std::vector<uint32_t>(materials));
  for (int64_t z = 0, i = 0; z < m[2]; ++z)
    for (int64_t y = 0; y < m[1]; ++y)
      for (int64_t x = 0; x < m[0]; ++x, ++i)
        ++out[static_cast<size_t>((z / s[2] * n[1] + y / s[1]) * n[0] + x / s[0])][cells[static_cast<size_t>(i)]];
  return out;
}

// Those that a file holds; of a cell that is not mixed, all sub-samples have its own material.
Shares shares_of(const GridReader& reader, uint32_t materials) {
  const Metadata& meta = reader.meta();
  const FractionReader fractions(reader);
  const uint32_t total = sub_samples(fractions.samples());
  const std::vector<uint32_t> own = all_cells(reader);
  Shares out;
  for (const uint32_t material : own) {
    out.emplace_back(materials);
    out.back()[material] = total;
  }
  const Index3 n = meta.grid.cells();
  const RayFrame f = meta.frame();
  const LevelShape shape = reader.shape(0);
  for (uint64_t page = 0; page < shape.pages(); ++page)
    for (uint32_t slot = 0; slot < shape.page_size(page); ++slot) {
      const ChunkKey key = shape.key_of(page, slot);
      const auto decoded = fractions.chunk(key);
      const MixedCells& cells = *decoded;
      for (uint32_t ray = 0; ray < cells.nu * cells.nv; ++ray)
        for (const MixedCells::Run& run : cells.of_ray(ray))
          for (uint32_t w = run.from; w < run.to; ++w) {
            Index3 c;
            c[f.u] = int64_t{key.cu} * shape.chunk_rays + ray % cells.nu, c[f.v] = int64_t{key.cv} * shape.chunk_rays + ray / cells.nu;
            c[f.w] = int64_t{key.segment} * shape.chunk_cells + w;
            std::vector<uint32_t>& share = out[static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0])];
            const std::vector<uint32_t> before = share;
            std::ranges::fill(share, 0);
            for (size_t i = 0; i < cells.labels(run).size(); ++i) share[meta.labels[cells.labels(run)[i]].material] += cells.counts_of(run)[i];
            REQUIRE(share != before);  // only mixed cells are kept
          }
    }
  return out;
}

uint32_t materials_in(const std::vector<Body>& bodies) {
  uint32_t materials = 1;
  for (const Body& b : bodies) materials = std::max(materials, b.material + 1);
  return materials;
}

// Along x, y and z, by each engine.
void expect_exact_shares(const std::vector<Body>& bodies, const Grid& grid, const Subdivision& samples, uint32_t chunk_rays = 4) {
  const TempFolder folder;
  const uint32_t materials = materials_in(bodies);
  const Shares expected = expected_shares(bodies, grid, samples, materials);
  MeshOptions options;
  options.chunk_rays = chunk_rays;  // 4: several chunks and tile groups
  options.fractions = samples;
  for_engines_and_axes(scene_of(folder, bodies, grid), options, [&](const GridReader& reader, const auto&) {
    REQUIRE(subdivision_of(*find_fractions(reader.meta())) == samples);
    REQUIRE(shares_of(reader, materials) == expected);
    verify(reader, 1, [](double) {});
  });
}

Subdivision some_subdivision(std::mt19937_64& random) {
  const auto power = [&] { return uint32_t{1} << random_int(random, 0, 3); };
  return {power(), power(), power()};
}

TEST_CASE("Half a cell is half of its sub-samples") {
  const std::vector<Body> bodies = {{shapes::box({0.5, 1, 1}, {2.25, 3, 3})}};
  const Shares shares = shares_of(meshed_reader(bodies, cube_grid_of(0, 1, 4), {.fractions = Subdivision{4, 1, 1}}), 2);
  const auto row = [&](size_t x) { return shares[(1 * 4 + 1) * 4 + x]; };
  CHECK(row(0) == std::vector<uint32_t>{2, 2});
  CHECK(row(1) == std::vector<uint32_t>{0, 4});
  CHECK(row(2) == std::vector<uint32_t>{3, 1});
  CHECK(row(3) == std::vector<uint32_t>{4, 0});
}

TEST_CASE("Shares of random scenes full of ties equal the cells of the finer grid, along every axis and by every engine") {
  for_seeds(0, rounds(12), [](auto& random) {
    const int n = random_int(random, 3, 6);
    const Grid grid = shapes::grid_of_ties(random, n);
    expect_exact_shares(shapes::bodies_of_ties(random, n, 4), grid, some_subdivision(random));
  });
}

TEST_CASE("Shares of decimal lattices, slopes and needles equal the cells of the finer grid") {
  for_seeds(100, rounds(6), [](auto& random) {
    expect_exact_shares(shapes::decimal_bodies(random, 2), cube_grid_of(0, 1.1 / 5, 5), some_subdivision(random));
    expect_exact_shares({{shapes::needle(random)}, {shapes::sphere({4, 5, 3}, 6.3, 2), Rule::kNonzero, 2}}, cube_grid_of(-7, 5, 5), {8, 4, 2});
  });
}

TEST_CASE("Shares of rows that are longer than vectors equal the cells of the finer grid, on every vector unit") {
  // The second body is far from the first along x and z, so rows have rays of two patterns, of one body, and of both.
  const std::vector<Body> bodies = {{shapes::sphere({6, 5, 4}, 4.3, 2)}, {shapes::sphere({15, 5, 11}, 3.7, 1), Rule::kNonzero, 2}};
  for (const VectorUnit unit : {VectorUnit::kPlain, VectorUnit::kAvx2, VectorUnit::kAvx512}) {
    const OnVectorUnit on(unit);
    expect_exact_shares(bodies, cube_grid_of(0, 1, 19), {4, 2, 4}, 64);
    expect_exact_shares({bodies[0]}, cube_grid_of(0, 0.75, 14), {2, 1, 8}, 64);
  }
}

TEST_CASE("Shares of plates that rays cross hundreds of times, and of tiles wider than a block of sub-rays, equal the cells of the finer grid") {
  std::vector<shapes::Facets> plates;
  for (int i = 0; i < 150; ++i) plates.push_back(shapes::box({0.6, 0.7, 0.3 + i * 0.03}, {3.8, 2.6 + i % 3 * 0.4, 0.315 + i * 0.03}));
  expect_exact_shares({{shapes::join(plates)}}, cube_grid_of(0, 1, 5), {2, 2, 64});
  expect_exact_shares({{shapes::sphere({17, 5, 9}, 4.3, 2)}, {shapes::box({15, 4.5, 3}, {32, 5.2, 9}), Rule::kNonzero, 2}}, cube_grid_of(0, 1, 34),
                      {8, 1, 2}, 64);
}

// The part of the cell at `lo`, of size 1, inside a sphere about the origin: exact along lines, midpoints across.
double part_in_sphere(const Vec3& lo, double radius) {
  constexpr int kLines = 64;
  double near = 0, far = 0;  // of its points from the centre, squared
  for (const double at : lo) {
    const double a = std::abs(at), b = std::abs(at + 1);
    near += at < 0 && at > -1 ? 0 : std::min(a * a, b * b), far += std::max(a * a, b * b);
  }
  if (near >= radius * radius) return 0;
  if (far <= radius * radius) return 1;
  double sum = 0;
  for (int i = 0; i < kLines; ++i)
    for (int j = 0; j < kLines; ++j) {
      const double x = lo[0] + (i + 0.5) / kLines, y = lo[1] + (j + 0.5) / kLines, left = radius * radius - x * x - y * y;
      if (left <= 0) continue;
      const double half = std::sqrt(left);
      sum += std::max(0.0, std::min(lo[2] + 1, half) - std::max(lo[2], -half));
    }
  return sum / (kLines * kLines);
}

TEST_CASE("Shares of a sphere of 20.3 cells, 4 x 4 x 64 sub-samples, are as near to the truth as the issue asks for") {
  constexpr double kRadius = 20.3;
  const shapes::Facets facets = shapes::sphere({0, 0, 0}, kRadius, 7);
  const Grid grid = cube_grid_of(-22, 1, 44);
  const GridReader reader = meshed_reader({{facets}}, grid, {.axis = 2, .fractions = Subdivision{4, 4, 64}});
  std::vector<double> shares(44 * 44 * 44);
  FractionReader(reader).read_box(grid.box(0), 1, 0.0, shares.data(), {1, 44, 44 * 44});
  double volume = 0, squares = 0;
  int cut = 0;
  for (size_t i = 0; i < shares.size(); ++i) {
    volume += shares[i];
    const Vec3 lo = {static_cast<double>(i % 44) - 22, static_cast<double>(i / 44 % 44) - 22, static_cast<double>(i / 44 / 44) - 22};
    const double expected = part_in_sphere(lo, kRadius);
    if (expected == 0 || expected == 1) continue;
    ++cut;
    squares += (shares[i] - expected) * (shares[i] - expected);
  }
  REQUIRE(cut > 7000);
  const double rms = std::sqrt(squares / cut), off = std::abs(volume / shapes::volume(facets) - 1);
  CAPTURE(rms, off);
  CHECK(rms <= 0.01);
  CHECK(off <= 5e-5);
}

TEST_CASE("Sheets and kept thin parts own cells, but take no share") {
  const Grid grid = cube_grid_of(0, 1, 6);
  const std::vector<Body> bodies = {{shapes::box({1.2, 1.2, 1.2}, {4.7, 4.7, 4.7}), Rule::kNonzero, 1},
                                    {shapes::sphere({3, 3, 3}, 2.2, 2), Rule::kNonzero, 2, 1, true}};
  expect_exact_shares(bodies, grid, {4, 4, 4});

  const TempFolder folder;
  const std::vector<Body> plate = {{shapes::box({2.6, 1, 1}, {2.9, 5, 5})}};
  Scene scene = scene_of(folder, plate, grid);
  scene.bodies[0].thin = Thin::kKeep;
  const MeshOptions options{.fractions = Subdivision{8, 2, 2}};
  mesh_quietly(scene, folder / "g.tcell", options);
  CHECK(shares_of(GridReader(folder / "g.tcell"), 2) == expected_shares(plate, grid, *options.fractions, 2));
}

TEST_CASE("Many sub-samples per cell are counted in blocks of a ray, and give the same counts") {
  const Grid grid = cube_grid_of(0, 1, 3);
  const std::vector<Body> bodies = {{shapes::sphere({1.5, 1.4, 1.6}, 1.2, 2)}};
  const TempFolder folder;
  for (const Subdivision& samples : {Subdivision{256, 16, 1}, Subdivision{1, 256, 8}}) {
    const Shares expected = expected_shares(bodies, grid, samples, 2);
    const MeshOptions options{.fractions = samples};
    for_axes(scene_of(folder, bodies, grid), options, [&](const GridReader& reader, const auto&) { CHECK(shares_of(reader, 2) == expected); });
  }
}

TEST_CASE("Rays of a graded axis that are cut into pieces of 4096 cells have the same shares") {
  Grid grid = cube_grid_of(0, 1, 3);
  std::vector<double> planes;
  for (int i = 0; i <= 4200; ++i) planes.push_back(i < 4150 ? i : 4150 + (i - 4150) * 2.0);
  grid.axis[2] = Axis::graded(planes, 0.5);
  // Its walls lean, so cells on both sides of the cut have equal shares, and others.
  shapes::Facets rod = shapes::box({0.3, 0.2, 4080.4}, {1.6, 1.7, 4120.2});
  for (Facet& f : rod)
    for (Vec3& p : f.vertex) p[0] += (p[2] - 4080) * 0.02;
  const TempFolder folder;
  const std::vector<Body> bodies = {{rod}};
  const Subdivision samples{2, 2, 256};
  const GridReader reader = meshed_reader(bodies, grid, {.axis = 2, .fractions = samples});
  CHECK(shares_of(reader, 2) == expected_shares(bodies, grid, samples, 2));
  verify(reader, 1, [](double) {});
}

TEST_CASE("The cells are the same with and without fractions and links") {
  std::mt19937_64 random(9);
  const TempFolder folder;
  const Scene scene = scene_of(folder, shapes::bodies_of_ties(random, 8, 4), cube_grid_of(0, 0.5, 18));
  MeshOptions options{.axis = 1};
  mesh_quietly(scene, folder / "plain.tcell", options);
  options.fractions = Subdivision{2, 2, 2};
  options.links = true;
  mesh_quietly(scene, folder / "shares.tcell", options);
  const GridReader plain(folder / "plain.tcell"), shares(folder / "shares.tcell");
  CHECK(all_cells(plain) == all_cells(shares));
  CHECK(plain.meta().channels.size() == 1);
  CHECK(plain.meta().levels()[0].bytes == shares.meta().levels()[0].bytes);
}

TEST_CASE("A file with fractions and links is the same for any threads, from parts, and after an interruption") {
  std::mt19937_64 random(12);
  const TempFolder folder;
  const Scene scene =
      scene_of(folder, {{shapes::sphere({5, 5, 5}, 4.1, 3)}, {shapes::shell_of_ties(random, 9), Rule::kEvenodd, 2}}, cube_grid_of(0, 0.25, 40));
  MeshOptions options{.axis = 2, .threads = 1, .fractions = Subdivision{2, 4, 8}, .links = true, .chunk_rays = 4};
  mesh_quietly(scene, folder / "g.tcell", options);
  const std::string expected = bytes_of(folder / "g.tcell");

  options.threads = 3;
  mesh_quietly(scene, folder / "threads.tcell", options);
  CHECK(bytes_of(folder / "threads.tcell") == expected);

  for (const uint32_t parts : {2u, 5u}) {
    merge(make_parts(scene, folder / "p.tcell", options, parts), folder / "merged.tcell", kSilent, kGoOn);
    CHECK(bytes_of(folder / "merged.tcell") == expected);
  }

  options.checkpoint_seconds = 0;
  options.resume = true;
  options.threads = 1;
  for (const int call : {4, 5, 7, 10}) run_and_kill(scene, folder / "resumed.tcell", options, call);
  mesh_quietly(scene, folder / "resumed.tcell", options);
  CHECK(bytes_of(folder / "resumed.tcell") == expected);
}

TEST_CASE("Sub-samples that doubles can't tell apart are refused") {
  const TempFolder folder;
  Scene scene = scene_of(folder, {{shapes::box({1, 1, 1}, {2, 2, 2})}},
                         {{Axis::uniform(0, 1, 0, 4, 0.5), Axis::uniform(0, 1, 0, 4, 0.5), Axis::uniform(0x1p50, 0.5, 0, 4, 0.5)}});
  const MeshOptions options{.fractions = Subdivision{1, 1, 8}};
  CHECK_THROWS_WITH(mesh_quietly(scene, folder / "g.tcell", options), Catch::StartsWith("8 sub-samples per cell along z"));
}

}  // namespace
}  // namespace teracell::mesher

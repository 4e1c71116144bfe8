// The thickness of walls, against a search over all balls, and of shapes whose thickness is known.
#include "store/check/thickness.hpp"

#include "tests/support/stored.hpp"
#include "tests/support/thickness_search.hpp"

namespace teracell {
namespace {

using namespace testing;

// In half cells, of all cells of the labels: kThickest is that or more.
std::vector<uint32_t> found(const Cells& cells, int ray_axis, bool tiny_chunks, const std::vector<bool>& walls) {
  Metadata meta = metadata_of(unit_grid(cells.n), ray_axis, static_cast<uint32_t>(walls.size()));
  if (tiny_chunks) meta = with_tiny_chunks(meta);
  const GridReader reader = reader_of(meta, cells.labels);
  const LevelShape shape = reader.shape(0);
  const RayFrame frame = meta.frame();
  std::vector<uint32_t> out(cells.labels.size());
  for (size_t i = 0; i < out.size(); ++i) out[i] = walls[cells.labels[i]] ? kThickest : 0;
  const std::vector<Label> here = labels_here(meta);
  Thickness thickness(walls);
  std::shared_ptr<Chunk> scratch;
  Field field;
  for (uint32_t cv = 0; cv < shape.chunks_v; ++cv)
    for (uint32_t cu = 0; cu < shape.chunks_u; ++cu) {
      read_field(reader, here, cu, cv, scratch, field);
      uint64_t last = 0;  // place of the last cell
      for (const ThinRun& run : thickness.thin_runs(field)) {
        REQUIRE((run.u >= field.column.u0 && run.u < field.column.u1 && run.v >= field.column.v0 && run.v < field.column.v1));
        const uint64_t ray = (uint64_t{run.v} * field.rays.nu + run.u) << 32;
        REQUIRE((run.from < run.to && ray + run.from >= last));
        last = ray + run.to;
        for (uint32_t w = run.from; w < run.to; ++w) {
          const size_t i = cells.number(frame.cell(field.u + run.u, field.v + run.v, w));
          REQUIRE((cells.labels[i] == run.label && out[i] == kThickest && run.halves < kThickest));
          out[i] = run.halves;
        }
      }
    }
  return out;
}

TEST_CASE("The thickness of walls is that of a search over all balls, along every ray axis, in chunks of any size", "[check]") {
  uint64_t thin = 0, thick = 0;
  for (uint64_t seed = 0; seed < rounds(20); ++seed) {
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto below = [&](int n) { return static_cast<int64_t>(random() % static_cast<uint64_t>(n)); };
    Cells cells({1 + below(34), 1 + below(34), 1 + below(34)});
    if (seed % 5 == 0) cells = Cells({1 + below(12), 1 + below(12), 40 + below(90)});
    const uint32_t labels = 2 + static_cast<uint32_t>(seed % 2);
    for (int64_t i = 3 + below(8); i > 0; --i) {
      Vec3 at, size;
      for (size_t d = 0; d < 3; ++d)
        at[d] = random_in(random, 0, static_cast<double>(cells.n[d])), size[d] = random_in(random, 1, random() % 3 ? 25 : 5);
      const bool ball = random() % 2;
      cells.fill(static_cast<Label>(random() % labels), [&](const Vec3& p) {
        double sum = 0, most = 0;
        for (size_t d = 0; d < 3; ++d) {
          const double off = (p[d] - at[d]) / size[ball ? 0 : d];
          sum += off * off, most = std::max(most, std::abs(off));
        }
        return ball ? sum < 1 : most < 0.5;
      });
    }
    if (seed % 3 == 0)
      for (int64_t i = below(20); i > 0; --i) cells.labels[random() % cells.labels.size()] = static_cast<Label>(random() % labels);
    std::vector<uint32_t> expected(cells.labels.size());
    std::vector<bool> walls(labels, true);
    walls[0] = seed % 4 == 0;  // the background has gaps
    for (Label label = 0; label < labels; ++label) {
      if (!walls[label]) continue;
      const auto one = by_search(cells, label);
      for (size_t i = 0; i < one.size(); ++i) expected[i] += one[i];
    }
    for (const uint32_t halves : expected) thin += halves > 0 && halves < kThickest, thick += halves == kThickest;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool tiny : {false, true}) {
        if (kSanitized && tiny != (axis == 1)) continue;
        CAPTURE(axis, tiny);
        REQUIRE(found(cells, axis, tiny, walls) == expected);
      }
  }
  CHECK(thin > (kSanitized ? 300 : 1'000));
  CHECK(thick > 1'000);
}

TEST_CASE("Plates are as thick as they are, and so is a cube; at the domain's sides nothing is", "[check]") {
  for (int64_t cells_thick = 1; cells_thick <= 9; ++cells_thick)
    for (size_t d = 0; d < 3; ++d) {
      CAPTURE(cells_thick, d);
      Cells plate({40, 40, 40});
      plate.fill(1, [&](const Vec3& p) { return p[d] > 10 && p[d] < 10 + static_cast<double>(cells_thick); });
      const auto thickness = found(plate, 2, false, {false, true});
      for (size_t i = 0; i < thickness.size(); ++i)
        REQUIRE(thickness[i] == (plate.labels[i] ? std::min<uint32_t>(kThickest, 2 * static_cast<uint32_t>(cells_thick)) : 0));
    }
  Cells cube({30, 30, 30});
  cube.fill(1, [](const Vec3& p) { return std::ranges::all_of(p, [](double x) { return x > 5 && x < 25; }); });
  for (const uint32_t halves : found(cube, 1, true, {false, true})) REQUIRE((halves == 0 || halves == kThickest));
  Cells full({5, 1, 3});
  full.fill(1, [](const Vec3&) { return true; });
  for (const uint32_t halves : found(full, 0, false, {false, true})) REQUIRE(halves == kThickest);
}

TEST_CASE("An oblique plate is as thick as it is, within half a cell for most of its cells", "[check]") {
  for (const double wide : {2.0, 3.5, 5.0}) {
    CAPTURE(wide);
    const Vec3 normal = {2. / 7, 3. / 7, 6. / 7};
    Cells plate({60, 60, 60});
    plate.fill(1, [&](const Vec3& p) { return std::abs(normal[0] * (p[0] - 30) + normal[1] * (p[1] - 30) + normal[2] * (p[2] - 30)) < wide / 2; });
    uint64_t all = 0, near = 0;
    for (const uint32_t halves : found(plate, 2, false, {false, true})) all += halves > 0, near += halves > 0 && std::abs(halves / 2. - wide) <= 1;
    CHECK(static_cast<double>(near) > 0.9 * static_cast<double>(all));
  }
}

TEST_CASE("Long walls along the rays cost no more than short ones, and are as thick", "[check]") {
  Field field;
  constexpr uint32_t kLong = 1'000'000'000;
  field.u = field.v = 0, field.column = {0, 0, 24, 24};
  field.rays.reset(24, 24, kLong);
  for (uint32_t v = 0; v < 24; ++v)
    for (uint32_t u = 0; u < 24; ++u)
      if (u >= 10 && u < 13) field.rays.append(std::vector<SetId>{0, 1, 0}, std::vector<uint32_t>{7, kLong - 9});
      else field.rays.append(std::vector<SetId>{0}, {});
  Thickness thickness({false, true});
  const auto& runs = thickness.thin_runs(field);
  REQUIRE(runs.size() == 3 * 24);
  for (const ThinRun& run : runs) REQUIRE((run.from == 7 && run.to == kLong - 9 && run.halves == 6));
}

TEST_CASE("A ray through very many plates costs no more for each of them", "[check]") {
  constexpr uint32_t kPlates = 300'000;  // to look at all plates for each of them would take minutes
  std::vector<SetId> sets{0};
  std::vector<uint32_t> changes;
  for (uint32_t plate = 0; plate <= kPlates; ++plate) {  // the last one is thin
    changes.insert(changes.end(), {20 * plate + 4, 20 * plate + (plate < kPlates ? 16 : 6)});
    sets.insert(sets.end(), {1, 0});
  }
  Field field;
  field.u = field.v = 0, field.column = {0, 0, 1, 1};
  field.rays.reset(1, 1, 20 * kPlates + 20);
  field.rays.append(sets, changes);
  Thickness thickness({false, true});
  CHECK(thickness.thin_runs(field) == std::vector<ThinRun>{{0, 0, 20 * kPlates + 4, 20 * kPlates + 6, 1, 4}});
}

}  // namespace
}  // namespace teracell

#include "store/read/surface.hpp"

#include <algorithm>
#include <cmath>

#include "store/grid/vec3.hpp"
#include "store/read/line.hpp"
#include "store/read/query.hpp"

namespace teracell::inline store {
namespace {

constexpr double kReach = 6;           // of the widest side of the cell: how far around a normal is looked for
constexpr int64_t kFlat = 3;            // cells around one that tell whether a surface is a plane along axes
constexpr int64_t kMostAround = 48;    // cells to one side, where others are much thinner
constexpr double kLeastTurned = 0.02;  // of what half a ball would have: with less the material is all around
constexpr double kNearEntry = 1.5;     // cells: a line along a normal enters through the steps of a surface this near to the point
constexpr double kFirstLine = 32;      // cells
constexpr double kMostLineCells = 1048576;

Vec3 cell_sides(const Grid& grid, const Index3& cell) {
  Vec3 out;
  for (int d = 0; d < 3; ++d) out[d] = grid.axis[d].plane(cell[d] + 1) - grid.axis[d].plane(cell[d]);
  return out;
}

double longest(const Vec3& v) { return std::max({v[0], v[1], v[2]}); }

uint32_t material_of(const GridReader& reader, const SetValue& value, const Index3& cell) {
  uint32_t out = 0;
  read_box<uint32_t>(reader, 0, {cell, {cell[0] + 1, cell[1] + 1, cell[2] + 1}}, value, 0, &out, {1, 1, 1});
  return out;
}

// From the point to the middle of what of the ball around it is of the material, weighed less the farther away it is. Only what is looked at
// on both sides of the point counts, so that the end of the grid is no surface. In shares of the ball's radius.
Vec3 towards(const GridReader& reader, const SetValue& value, uint32_t material, const Index3& cell, const Vec3& at) {
  const Grid& grid = reader.meta().grid;
  const double radius = kReach * longest(cell_sides(grid, cell));
  Box box;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = grid.axis[d];
    const double reach = std::min({radius, at[d] - axis.min(), axis.max() - at[d]});
    box.lo[d] = std::max(axis.cell_at(std::clamp(at[d] - reach, axis.min(), axis.max())), cell[d] - kMostAround);
    box.hi[d] = std::min(axis.cell_at(std::clamp(at[d] + reach, axis.min(), axis.max())), cell[d] + kMostAround) + 1;
    box.hi[d] = std::min(box.hi[d], axis.cells());
  }
  const int64_t nx = box.hi[0] - box.lo[0], ny = box.hi[1] - box.lo[1], nz = box.hi[2] - box.lo[2];
  std::vector<uint32_t> cells(static_cast<size_t>(nx * ny * nz));
  read_box<uint32_t>(reader, 0, box, value, 0, cells.data(), {1, nx, nx * ny});
  Vec3 sum{0, 0, 0};
  double all = 0;
  const uint32_t* here = cells.data();
  for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
    for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
      for (int64_t x = box.lo[0]; x < box.hi[0]; ++x, ++here) {
        const Index3 i = {x, y, z};
        Vec3 away;
        double volume = 1, square = 0;
        bool both = true;
        for (int d = 0; d < 3; ++d) {
          const Axis& axis = grid.axis[d];
          const double low = axis.plane(i[d]), high = axis.plane(i[d] + 1), mirrored = 2 * at[d] - (low + high) / 2;
          both = both && mirrored > axis.plane(box.lo[d]) && mirrored < axis.plane(box.hi[d]);
          away[d] = ((low + high) / 2 - at[d]) / radius;
          volume *= (high - low) / radius;
          square += away[d] * away[d];
        }
        if (!both || square >= 1) continue;
        const double weight = volume * (1 - square);
        all += weight * std::sqrt(square);
        if (*here != material) continue;
        for (int d = 0; d < 3; ++d) sum[d] += weight * away[d];
      }
  return all > 0 ? sum * (1 / all) : Vec3{0, 0, 0};
}

// Whether a side of the cell is part of a plane along axes: whatever of the cells around is in the grid, inside is the material, beyond is something
// else.
bool is_flat(const GridReader& reader, const SetValue& value, uint32_t material, const Index3& cell, int axis, int sign) {
  const Grid& grid = reader.meta().grid;
  for (const bool beyond : {false, true}) {
    Box layer;
    for (int d = 0; d < 3; ++d) {
      const int64_t at = cell[d] + (d == axis && beyond ? sign : 0), reach = d == axis ? 0 : kFlat;
      layer.lo[d] = std::max<int64_t>(at - reach, 0), layer.hi[d] = std::min(at + reach + 1, grid.axis[d].cells());
      if (layer.lo[d] >= layer.hi[d]) return true;
    }
    const int64_t nx = layer.hi[0] - layer.lo[0], ny = layer.hi[1] - layer.lo[1], nz = layer.hi[2] - layer.lo[2];
    std::vector<uint32_t> cells(static_cast<size_t>(nx * ny * nz));
    read_box<uint32_t>(reader, 0, layer, value, 0, cells.data(), {1, nx, nx * ny});
    if (!std::ranges::all_of(cells, [&](uint32_t m) { return (m == material) != beyond; })) return false;
  }
  return true;
}

// The normal of the side of the cell on which the point lies, if something else begins there, or the grid ends.
struct Side {
  Vec3 normal;
  bool flat;
};
std::optional<Side> side_of(const GridReader& reader, const SetValue& value, uint32_t material, const Index3& cell, const Vec3& at) {
  const Grid& grid = reader.meta().grid;
  const Vec3 sides = cell_sides(grid, cell);
  std::optional<Side> out;
  double nearest = 0.01;  // of a side
  for (int d = 0; d < 3; ++d)
    for (const int sign : {-1, 1}) {
      const double away = std::abs(grid.axis[d].plane(cell[d] + (sign > 0)) - at[d]) / sides[d];
      if (away > nearest) continue;
      Index3 beyond = cell;
      beyond[d] += sign;
      if (beyond[d] >= 0 && beyond[d] < grid.axis[d].cells() && material_of(reader, value, beyond) == material) continue;
      nearest = away;
      out = Side{{0, 0, 0}, is_flat(reader, value, material, cell, d, sign)};
      out->normal[d] = sign;
    }
  return out;
}

// How far a line of a direction may go so that it does not pass through too many cells.
double farthest(const Grid& grid, const Vec3& direction) {
  double cells = 0;
  for (int d = 0; d < 3; ++d) cells += static_cast<double>(grid.axis[d].cells()) / (grid.axis[d].max() - grid.axis[d].min()) * std::abs(direction[d]);
  return kMostLineCells / cells;
}

}  // namespace

std::optional<Thick> thickness_at(const GridReader& reader, const Index3& cell, const Vec3& at) {
  const Grid& grid = reader.meta().grid;
  const SetValue value = strongest_material(reader.meta());
  const uint32_t material = material_of(reader, value, cell);
  const auto side = side_of(reader, value, material, cell, at);
  const Vec3 inwards = side && side->flat ? Vec3{0, 0, 0} : towards(reader, value, material, cell, at);
  const double turned = length(inwards);
  if (!side && turned < kLeastTurned) return std::nullopt;
  const Vec3 normal = turned < kLeastTurned ? side->normal : inwards * (-1 / turned);
  const Vec3 sides = cell_sides(grid, cell);
  const double step =
      std::abs(normal[0]) * sides[0] + std::abs(normal[1]) * sides[1] + std::abs(normal[2]) * sides[2];  // of the cell, along the normal
  const Vec3 from = at + normal * step;
  double across = 0;  // of the grid
  for (int d = 0; d < 3; ++d) across += grid.axis[d].max() - grid.axis[d].min();
  const double most = std::min(across, farthest(grid, normal));
  for (double reach = std::min(kFirstLine * step, most);; reach = std::min(4 * reach, most)) {
    const Vec3 to = at - normal * reach;
    const double whole = reach + step, entry = (1 + kNearEntry) * step / whole;
    const LineRun* best = nullptr;
    const std::vector<LineRun> runs = read_line(reader, from, to);
    for (const LineRun& run : runs)
      if (run.material == material && run.from <= entry && (!best || run.to - run.from > best->to - best->from)) best = &run;
    if (!best) return std::nullopt;
    if (best->to >= 1 && reach < most) continue;
    if (best->to >= 1 && most < across) return std::nullopt;  // it may go on
    const auto point = [&](double share) { return from + (to - from) * share; };
    // A line that begins in the material has come from another part of it, through a gap.
    return Thick{material, normal, best->from > 0 ? point(best->from) : at, point(best->to), best->cells};
  }
}

}  // namespace teracell::store

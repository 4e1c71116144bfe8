#include "store/grid/metadata.hpp"

#include <fmt/format.h>

#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

// Values of the metadata beside planes, materials, labels and channels: 32 levels, and keys with one value each.
constexpr size_t kRoomForOthers = 256;

// Of the JSON without amounts.
uint64_t values_of(const Metadata& meta) {
  uint64_t values = kRoomForOthers + 4 * meta.materials.size() + 3 * meta.labels.size() + 4 * meta.patches.size() + 7 * meta.channels.size();
  for (const LabelInfo& l : meta.labels) values += l.overlap;
  for (const Axis& a : meta.grid.axis) values += a.planes().size();
  return values;
}

}  // namespace

bool keeps_bodies(const Metadata& meta) {
  return std::ranges::any_of(meta.labels, [](const LabelInfo& label) { return !label.body.empty(); });
}

void LabelAmount::add(unsigned __int128 more, const Box& where) {
  if (cells == 0) box = where;
  for (int d = 0; d < 3; ++d) {
    box.lo[d] = std::min(box.lo[d], where.lo[d]);
    box.hi[d] = std::max(box.hi[d], where.hi[d]);
  }
  cells += more;
}

bool has_room_for_amounts(const Metadata& meta) { return values_of(meta) + 8 * meta.labels.size() <= kMostMetadataValues; }

bool amounts_fit(const Metadata& meta) {
  unsigned __int128 sum = 0, all = 1;
  for (const int64_t n : meta.grid.cells()) all *= static_cast<uint64_t>(n);
  for (const LabelAmount& a : meta.amounts) {
    if (a.cells == 0) continue;
    unsigned __int128 room = 1;
    for (size_t d = 0; d < 3; ++d) {
      if (a.box.lo[d] >= a.box.hi[d] || a.box.hi[d] > meta.grid.axis[d].cells()) return false;
      room *= static_cast<uint64_t>(a.box.hi[d] - a.box.lo[d]);
    }
    if (a.cells > room) return false;
    sum += a.cells;
  }
  return sum == all;
}

std::string beyond_bounds(const Metadata& meta) {
  std::string_view longest = meta.units;
  const auto look_at = [&](const std::string& name) {
    if (name.size() > longest.size()) longest = name;
  };
  size_t names = 0;
  for (const MaterialInfo& m : meta.materials) look_at(m.name), names += m.name.size();
  for (const LabelInfo& l : meta.labels) look_at(l.body);
  size_t patch_names = 0;
  for (const PatchInfo& p : meta.patches) look_at(p.name), look_at(p.body), patch_names += p.name.size() + p.body.size();
  if (patch_names > kMostPatchNames)
    return fmt::format("expected at most {} bytes of names of patches in all, found {}", kMostPatchNames, patch_names);
  if (meta.patches.size() > kMostPatches) return fmt::format("expected at most {} patches, found {}", kMostPatches, meta.patches.size());
  for (const Channel& c : meta.channels) look_at(c.name), look_at(c.coding);
  if (longest.size() > kMostName)
    return fmt::format("expected names of at most {} bytes, found one of {}: '{}...'", kMostName, longest.size(),
                       printable(first_bytes(longest, 48)));
  if (names > kMostMaterialNames) return fmt::format("expected at most {} bytes of names of materials in all, found {}", kMostMaterialNames, names);
  uint64_t planes = 0;
  for (const Axis& a : meta.grid.axis) planes += a.planes().size();
  if (values_of(meta) > kMostMetadataValues)
    return fmt::format("{} planes, {} materials, {} labels and {} patches are more than the {} values that a file's metadata may have", planes,
                       meta.materials.size(), meta.labels.size(), meta.patches.size(), kMostMetadataValues);
  return "";
}

std::string chunk_name(const ChunkKey& key) { return fmt::format("level {} chunk ({}, {}, {})", key.level, key.cu, key.cv, key.segment); }

LevelShape::LevelShape(const Metadata& meta, int of_level)
    : level(of_level), chunk_rays(meta.chunk_rays), chunk_cells(meta.chunk_cells), page_chunks(meta.page_chunks) {
  const Index3 n = meta.grid.cells(level);
  const RayFrame f = meta.frame();
  nu = static_cast<uint32_t>(n[f.u]);
  nv = static_cast<uint32_t>(n[f.v]);
  nw = static_cast<uint32_t>(n[f.w]);
  const auto parts = [](uint32_t whole, uint32_t part) { return static_cast<uint32_t>((uint64_t{whole} + part - 1) / part); };
  chunks_u = parts(nu, chunk_rays);
  chunks_v = parts(nv, chunk_rays);
  segments = parts(nw, chunk_cells);
  pages_u = parts(chunks_u, page_chunks);
  pages_v = parts(chunks_v, page_chunks);
}

uint32_t LevelShape::page_width(uint64_t page) const { return std::min(page_chunks, chunks_u - static_cast<uint32_t>(page % pages_u) * page_chunks); }

uint32_t LevelShape::page_height(uint64_t page) const {
  return std::min(page_chunks, chunks_v - static_cast<uint32_t>(page / pages_u % pages_v) * page_chunks);
}

ChunkKey LevelShape::key_of(uint64_t page, uint32_t slot) const {
  const uint32_t width = page_width(page);
  return {level, static_cast<uint32_t>(page % pages_u) * page_chunks + slot % width,
          static_cast<uint32_t>(page / pages_u % pages_v) * page_chunks + slot / width, static_cast<uint32_t>(page / pages_u / pages_v)};
}

}  // namespace teracell::store

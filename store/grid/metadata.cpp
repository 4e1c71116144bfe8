#include "store/grid/metadata.hpp"

#include <fmt/format.h>

#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

// Values of the metadata beside planes, materials, labels and channels: 32 levels, and keys with one value each.
constexpr size_t kRoomForOthers = 256;

}  // namespace

bool keeps_bodies(const Metadata& meta) {
  return std::ranges::any_of(meta.labels, [](const LabelInfo& label) { return !label.body.empty(); });
}

std::string beyond_bounds(const Metadata& meta) {
  std::string_view longest = meta.units;
  const auto look_at = [&](const std::string& name) {
    if (name.size() > longest.size()) longest = name;
  };
  size_t names = 0, values = kRoomForOthers + 4 * meta.materials.size() + 3 * meta.labels.size() + 4 * meta.patches.size();
  for (const MaterialInfo& m : meta.materials) look_at(m.name), names += m.name.size();
  for (const LabelInfo& l : meta.labels) look_at(l.body), values += l.overlap;
  size_t patch_names = 0;
  for (const PatchInfo& p : meta.patches) look_at(p.name), look_at(p.body), patch_names += p.name.size() + p.body.size();
  if (patch_names > kMostPatchNames)
    return fmt::format("expected at most {} bytes of names of patches in all, found {}", kMostPatchNames, patch_names);
  if (meta.patches.size() > kMostPatches) return fmt::format("expected at most {} patches, found {}", kMostPatches, meta.patches.size());
  for (const Channel& c : meta.channels) look_at(c.name), look_at(c.coding), values += 7;
  if (longest.size() > kMostName)
    return fmt::format("expected names of at most {} bytes, found one of {}: '{}...'", kMostName, longest.size(),
                       printable(first_bytes(longest, 48)));
  if (names > kMostMaterialNames) return fmt::format("expected at most {} bytes of names of materials in all, found {}", kMostMaterialNames, names);
  uint64_t planes = 0;
  for (const Axis& a : meta.grid.axis) planes += a.planes().size();
  if (planes > kMostMetadataValues || values + planes > kMostMetadataValues)
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

// Links as a list of records, for lattice Boltzmann codes and others that place walls between cells: an array of NumPy with named fields, which
// any program can read behind its header. A record says which materials lie on both sides, so that no other file is needed.
#include "store/channels/link_reader.hpp"

#include "store/base/output_file.hpp"
#include "store/text/npy_header.hpp"
#include "tools/export/format.hpp"

namespace teracell::exports {
namespace {

constexpr char kFields[] =
    "[('x', '<i4'), ('y', '<i4'), ('z', '<i4'), ('axis', '<u4'), ('end', '<u4'), ('begin', '<u4'), ('patch', '<i4'), ('lower', '<u2'), ('upper', '<u2')]";

// The materials of cells, which come in such an order that the next one mostly lies in the chunk of the one before.
class MaterialsOfCells {
 public:
  explicit MaterialsOfCells(const GridReader& reader) : reader_(reader), shape_(reader.shape(0)), frame_(reader.meta().frame()) {}
  uint32_t operator()(const Index3& c) {
    const auto u = static_cast<uint32_t>(c[frame_.u]), v = static_cast<uint32_t>(c[frame_.v]), w = static_cast<uint32_t>(c[frame_.w]);
    const ChunkKey key{0, u / shape_.chunk_rays, v / shape_.chunk_rays, w / shape_.chunk_cells};
    if (!chunk_ || key != key_) chunk_ = reader_.chunk(key, scratch_), key_ = key;
    const RayBlock& rays = chunk_->rays;
    const uint32_t ray = v % shape_.chunk_rays * rays.nu + u % shape_.chunk_rays;
    return reader_.meta().labels[rays.set_at(ray, w % shape_.chunk_cells)].material;
  }

 private:
  const GridReader& reader_;
  const LevelShape shape_;
  const RayFrame frame_;
  ChunkKey key_{};
  std::shared_ptr<const Chunk> chunk_;
  std::shared_ptr<Chunk> scratch_;
};

void write_links(const Export& e) {
  if (e.level != 0) throw UsageError("--level: links are between cells of level 0, found " + std::to_string(e.level));
  const LinkReader links(e.reader);
  e.progress(0);
  int64_t number = 0;
  for (int axis = 0; axis < 3; ++axis)
    links.for_each(axis, e.box, [&](std::span<const CellLink> found) {
      number += static_cast<int64_t>(found.size());
      e.progress(0);
    });
  OutputFile file(e.output);
  file.append(npy_header(kFields, {number}));
  MaterialsOfCells lower(e.reader), upper(e.reader);
  Bytes records;
  int64_t done = 0;
  for (int axis = 0; axis < 3; ++axis)
    links.for_each(axis, e.box, [&](std::span<const CellLink> found) {
      records.clear();
      for (const CellLink& l : found) {
        Index3 neighbour = l.cell;
        ++neighbour[axis];
        for (const int64_t i : l.cell) put_fixed(records, static_cast<int32_t>(i));
        put_fixed(records, static_cast<uint32_t>(axis));
        put_fixed(records, l.end), put_fixed(records, l.begin), put_fixed(records, static_cast<int32_t>(l.patch));  // kNoPatch is -1
        put_fixed(records, static_cast<uint16_t>(lower(l.cell))), put_fixed(records, static_cast<uint16_t>(upper(neighbour)));
      }
      file.append(records);
      done += static_cast<int64_t>(found.size());
      e.progress(static_cast<double>(done) / static_cast<double>(number));
    });
  e.progress(1);
  file.commit();
}

}  // namespace

ExportFormat links_format() {
  return {.name = "links",
          .extensions = {},
          .holds = "a NumPy array of records: where walls lie between neighbouring cells (of a grid meshed with --links)",
          .write = write_links,
          .numbers = false};
}

}  // namespace teracell::exports

// The leaves of a refined grid as a list of records, in Morton order: an array of NumPy with named fields, which any program can read behind its
// header.

#include <cstring>
#include <limits>

#include "store/base/output_file.hpp"
#include "store/text/npy_header.hpp"
#include "tools/export/refined/refined.hpp"

namespace teracell::exports {
namespace {

constexpr char kLeafFields[] = "[('level', '<i4'), ('i', '<i8'), ('j', '<i8'), ('k', '<i8'), ('label', '<u4')]";
constexpr size_t kRecord = 32;

void write_leaves(const Export& e) {
  if (!e.has("--refine")) throw UsageError("--refine: expected M,N, since the format leaves holds leaves, found none");
  const RefinedGrid grid(e, 0.5);
  OutputFile file(e.output);
  // How many there are is known at the end.
  Bytes records = npy_header(kLeafFields, {std::numeric_limits<int64_t>::max()});
  const size_t head = records.size();
  uint64_t written = 0;
  int64_t number = 0;
  const auto write = [&] {
    file.write_at(written, records);
    written += records.size();
    records.clear();
  };
  grid.leaves().for_each(
      e.box, grid.threads(), [&](double share) { e.progress((1 + share) / 2); },
      [&](std::span<const Leaf> found) {
        size_t at = records.size();
        records.resize(at + found.size() * kRecord);
        const auto put = [&](const auto& value) {
          std::memcpy(&records[at], &value, sizeof value);
          at += sizeof value;
        };
        for (const Leaf& leaf : found) put(static_cast<int32_t>(leaf.level)), put(leaf.cell), put(grid.numbers()[leaf.label]);
        number += static_cast<int64_t>(found.size());
        constexpr size_t kAtOnce = 4 << 20;
        if (records.size() > kAtOnce) write();
      });
  write();
  file.write_at(0, npy_header(kLeafFields, {number}, head));
  e.progress(1);
  file.commit();
}

}  // namespace

ExportFormat leaves_format() {
  return {.name = "leaves",
          .extensions = {},
          .holds = "a NumPy array of records: the leaves of a refined grid, in Morton order (with --refine)",
          .write = write_leaves,
          .options = refined_options()};
}

}  // namespace teracell::exports

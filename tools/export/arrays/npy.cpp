// NumPy's array of one file, which numpy.load() and numpy.memmap() read.
#include "store/read/query.hpp"
#include "store/text/npy_header.hpp"
#include "tools/export/arrays/dense.hpp"

namespace teracell::exports {
namespace {

void write_npy(const Export& e) {
  const auto& [lo, hi] = e.box;
  const size_t bytes = bytes_per_cell(e.most());
  OutputFile file(e.output);
  file.append(npy_header(bytes == 1 ? "|u1" : bytes == 2 ? "<u2" : "<u4", {hi[2] - lo[2], hi[1] - lo[1], hi[0] - lo[0]}));
  append_dense_cells(e, file);
  file.commit();
}

}  // namespace

ExportFormat npy_format() { return {"npy", {".npy"}, "a NumPy array of material ids, [z][y][x]", write_npy}; }

}  // namespace teracell::exports

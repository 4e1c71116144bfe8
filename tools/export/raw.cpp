// The bytes of the array alone, for readers that are told its shape.
#include "tools/export/dense.hpp"

namespace teracell {
namespace {

void write_raw(const Export& e) {
  OutputFile file(e.output);
  append_dense_cells(e, file);
  file.commit();
}

}  // namespace

ExportFormat raw_format() { return {"raw", {".raw"}, "the same material ids without a header", write_raw}; }

}  // namespace teracell

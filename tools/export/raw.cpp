// The bytes of the array alone, for readers that are told its shape. With --header a text beside it tells it.
#include <fmt/format.h>

#include "tools/export/dense.hpp"
#include "tools/export/two_files.hpp"

namespace teracell {
namespace {

void write_raw(const Export& e) {
  if (!e.has("--header")) {
    OutputFile file(e.output);
    append_dense_cells(e, file);
    return file.commit();
  }
  const size_t bytes = bytes_per_cell(e.most());
  TwoFiles files(e, e.output, e.output.string() + ".txt");
  append_dense_cells(e, files.array());
  files.commit(describe(e, e.output, fmt::format("uint{}{}", 8 * bytes, bytes > 1 ? " little endian" : ""), "x fastest, z slowest"));
}

}  // namespace

ExportFormat raw_format() {
  return {.name = "raw",
          .extensions = {".raw"},
          .holds = "the same material ids without a header",
          .write = write_raw,
          .options = {{"--header", "", "the type, order, sizes, planes and names as a text beside it, OUTPUT.txt"}}};
}

}  // namespace teracell

// The bytes of the array alone, for readers that are told its shape. With --header a text beside it tells it.
#include <fmt/format.h>

#include "tools/export/arrays/dense.hpp"
#include "tools/export/arrays/two_files.hpp"

namespace teracell::exports {
namespace {

void write_raw(const Export& e) {
  const size_t bytes = bytes_per_cell(e.most());
  write_array(e, fmt::format("uint{}{}", 8 * bytes, bytes > 1 ? " little endian" : ""), "x fastest, z slowest",
              [&](OutputFile& file) { append_dense_cells(e, file); });
}

}  // namespace

ExportFormat raw_format() {
  return {.name = "raw", .extensions = {".raw"}, .holds = "the same material ids without a header", .write = write_raw, .options = {header_option()}};
}

}  // namespace teracell::exports

// Integers as text with x slowest, as Palabos reads the flags of a geometry into a field. The text has no sizes.
#include <charconv>

#include "tools/export/arrays/dense.hpp"
#include "tools/export/arrays/two_files.hpp"

namespace teracell::exports {
namespace {

constexpr size_t kMostText = 1 << 20;

// One line for each row along z.
void append_numbers(const Export& e, OutputFile& file) {
  const int64_t row = e.box.hi[2] - e.box.lo[2];
  int64_t in_row = 0;
  Bytes text;
  const auto flush = [&] {
    file.append(text);
    text.clear();
  };
  for_each_slab<uint32_t>(e, kZFastest, [&](std::span<const uint32_t> slab) {
    for (const uint32_t number : slab) {
      char digits[16];
      char* end = std::to_chars(digits, std::end(digits), number).ptr;
      in_row = in_row + 1 == row ? 0 : in_row + 1;
      *end++ = in_row == 0 ? '\n' : ' ';
      text.insert(text.end(), digits, end);
      if (text.size() > kMostText) flush();
    }
  });
  flush();
}

void write_palabos(const Export& e) {
  write_array(e, "integers as text", "z fastest, x slowest", [&](OutputFile& file) { append_numbers(e, file); });
}

}  // namespace

ExportFormat palabos_format() {
  return {.name = "palabos",
          .extensions = {".dat"},
          .holds = "numbers as text with x slowest, which Palabos reads into a field",
          .write = write_palabos,
          .options = {header_option()}};
}

}  // namespace teracell::exports

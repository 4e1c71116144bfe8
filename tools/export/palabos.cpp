// Integers as text with x slowest, as Palabos reads the flags of a geometry into a field. The text has no sizes.
#include <charconv>

#include "tools/export/dense.hpp"
#include "tools/export/two_files.hpp"

namespace teracell {
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
  if (!e.has("--header")) {
    OutputFile file(e.output);
    append_numbers(e, file);
    return file.commit();
  }
  TwoFiles files(e, e.output, e.output.string() + ".txt");
  append_numbers(e, files.array());
  files.commit(describe(e, e.output, "integers as text", "z fastest, x slowest"));
}

}  // namespace

ExportFormat palabos_format() {
  return {.name = "palabos",
          .extensions = {".dat"},
          .holds = "numbers as text with x slowest, which Palabos reads into a field",
          .write = write_palabos,
          .options = {{"--header", "", "the type, order, sizes, planes and names as a text beside it, OUTPUT.txt"}}};
}

}  // namespace teracell

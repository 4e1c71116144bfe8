// OFF, the text format of Geomview: counts, then a line for each vertex and each face. Lines may go on with normals, colours and texture
// coordinates, which are skipped. "Geomview Manual", Object File Format, 1.9.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "mesher/surface/readers.hpp"
#include "mesher/surface/spill_table.hpp"
#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

// What may stand before OFF: texture coordinates, colours, normals. Four coordinates, other numbers of them, and binary files are refused.
constexpr std::array kKeywords = {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
constexpr std::array kOtherKeywords = {"4OFF", "C4OFF", "N4OFF", "nOFF", "4nOFF"};

class OffReader {
 public:
  OffReader(Input& input, FacetStream& out, const ReadOptions& options)
      : input_(input), out_(out), vertices_(options.budget), wanted_(out.wants("")) {}

  void read() {
    std::string_view line = next_line("the keyword OFF");
    const std::string keyword(next_word(line));
    if (std::ranges::count(kOtherKeywords, keyword) > 0) refuse("expected three coordinates in each vertex (OFF, COFF, NOFF, STOFF)", keyword);
    if (std::string_view rest = line; next_word(rest) == "BINARY") refuse("expected an OFF file in text", "BINARY");
    if (trimmed(line).empty()) line = next_line("the counts of vertices and faces");
    const uint64_t vertices = count(line, "the number of vertices"), faces = count(line, "the number of faces");
    for (uint64_t i = 0; i < vertices; ++i) {
      line = next_line("a vertex");
      Vec3 v;
      for (double& x : v) x = next_coordinate<double>(line, input_);
      vertices_.push_back(v);
    }
    for (uint64_t i = 0; i < faces; ++i) read_face(next_line("a face"));
    if (uint64_t more = lines_left(); more > 0)
      out_.warn(fmt::format("{} after the last face {} skipped", plural(more, "line"), more == 1 ? "was" : "were"));
  }

 private:
  // The next line that is more than a comment.
  std::string_view next_line(const char* expected) {
    if (std::string_view line; any_line(line)) return line;
    throw InputError(fmt::format("{}: cut short: expected {}, found the end of the file", input_.at_line(), expected));
  }
  bool any_line(std::string_view& line) {
    while (input_.next_line(line)) {
      line = trimmed(line.substr(0, line.find('#')));
      if (!line.empty()) return true;
    }
    return false;
  }
  uint64_t lines_left() {
    uint64_t more = 0;
    for (std::string_view line; any_line(line);) ++more;
    return more;
  }

  uint64_t count(std::string_view& line, const char* what) {
    const std::string_view word = next_word(line);
    const int64_t n = text_integer(word, what, input_);
    if (n < 0) refuse(fmt::format("expected {}", what), word);
    return static_cast<uint64_t>(n);
  }

  void read_face(std::string_view line) {
    const uint64_t corners = count(line, "the number of corners");
    Fan fan(out_, wanted_);
    for (uint64_t i = 0; i < corners; ++i) {
      const std::string_view word = next_word(line);
      const int64_t number = text_integer(word, "the number of a vertex", input_);
      if (number < 0 || static_cast<uint64_t>(number) >= vertices_.size())
        refuse(fmt::format("expected the number of a vertex, 0 to {}", static_cast<int64_t>(vertices_.size()) - 1), word);
      fan.add(vertices_[static_cast<uint64_t>(number)], static_cast<uint64_t>(number));
    }
  }

  [[noreturn]] void refuse(const std::string& expected, std::string_view found) const {
    throw InputError(fmt::format("{}: {}, found {}", input_.at_line(), expected, shown(found)));
  }

  Input& input_;
  FacetStream& out_;
  VertexTable vertices_;
  const bool wanted_;
};

Match recognises_off(const Head& head) {
  const bool known = std::ranges::count(kKeywords, head.word) > 0 || std::ranges::count(kOtherKeywords, head.word) > 0;
  return head.text && known ? Match::kSure : Match::kNo;
}

void read_off(Input& input, FacetStream& out, SurfaceFile& file, const ReadOptions& options) {
  file.format = "OFF";
  file.float32 = false;
  OffReader(input, out, options).read();
}

}  // namespace

const SurfaceReader kOffReader = {"OFF", recognises_off, read_off};

}  // namespace teracell::mesher

// Wavefront OBJ: the lines `v` and `f`, and the groups and objects that name parts. Everything else is skipped. A warning
// counts the polylines, points, free-form curves and surfaces among it, since a body may lack them.
#include <algorithm>
#include <array>
#include <atomic>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "mesher/surface/readers.hpp"
#include "mesher/surface/spill_table.hpp"
#include "store/base/background.hpp"
#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Appends the vertices of the leading lines of `text` that are exactly "v x y z"; returns how many bytes these lines take.
size_t plain_vertices(std::string_view text, std::vector<Vec3>& out) {
  const char *line = text.data(), *const end = line + text.size();
  for (;;) {
    const char* p = line;
    if (end - p < 2 || *p++ != 'v') break;
    Vec3 v;
    bool plain = true;
    for (double& x : v) {
      const char* const blank = p;
      while (p != end && is_space(*p)) ++p;
      const char* stop = plain_number(p, end, x);
      if (!stop)
        if (const auto [at, error] = std::from_chars(p, end, x); error == std::errc{}) stop = at;
      plain = p != blank && stop && is_coordinate(x);
      if (!plain) break;
      x += 0.0;  // -0 is +0
      p = stop;
    }
    while (p != end && is_space(*p)) ++p;
    if (!plain || p == end || *p != '\n') break;
    out.push_back(v);
    line = p + 1;
  }
  return static_cast<size_t>(line - text.data());
}

class ObjReader {
 public:
  ObjReader(Input& input, FacetStream& out, const ReadOptions& options)
      : input_(input), out_(out), helper_(options.helper), vertices_(options.budget), wanted_(out.wants("")) {}

  void read() {
    for (std::string_view line; next_statement(line);) {
      const std::string_view keyword = next_word(line);
      if (keyword == "v") {
        read_vertex(line);
        read_plain_vertices();
      } else if (keyword == "f" || keyword == "fo") {
        read_face(line);
        read_plain_faces();
      } else if (keyword == "g") enter_groups(line);
      else if (keyword == "o") enter_object(line);
      else count_skipped(keyword, line);
    }
    warn_of_skipped();
  }

 private:
  // One line, together with the lines that backslashes at line ends join to it. Comments are never continued: a comment may end
  // with a Windows path.
  bool next_statement(std::string_view& line) {
    if (!input_.next_line(line)) return false;
    if (!line.ends_with('\\') || trimmed(line).starts_with('#')) return true;
    joined_.clear();
    bool more = true;
    while (more && line.ends_with('\\')) {
      joined_.append(line.substr(0, line.size() - 1)) += ' ';
      if (joined_.size() > Input::kLongestLine)
        throw InputError(
            fmt::format("{}: expected at most {} bytes in lines joined by backslashes, found more", input_.at_line(), Input::kLongestLine));
      more = input_.next_line(line);
    }
    if (more) joined_.append(line);
    line = joined_;
    return true;
  }

  // x y z; a weight or colours may follow.
  void read_vertex(std::string_view line) {
    Vec3 v;
    for (double& x : v) x = next_coordinate<double>(line, input_);
    vertices_.push_back(v);
  }

  // Most files begin with all their vertices. Until facets come, the helper has nothing else to do, so both threads take blocks of a window
  // of plain vertices. (When each took one half, both waited for a fifth of this time, because a thread takes a while to begin.) What was parsed is
  // put into the table while the helper parses the next window.
  void read_plain_vertices() {
    const PlainBlocks* parsed = nullptr;
    for (size_t turn = 0; helper_ && input_.offset() >= next_plain_; ++turn) {
      PlainBlocks& blocks = plain_[turn % 2];
      const std::string_view text = input_.window(kWorthSharing).substr(0, Input::kWindow);
      if (text.size() < kWorthSharing) helper_ = nullptr;  // too little is left
      if (!helper_) break;
      if (!cut(text, blocks)) {
        next_plain_ = input_.offset() + kWorthSharing;
        break;
      }
      std::atomic<size_t> next = 0;
      const auto parse = [&] {
        for (size_t b; (b = next++) < kBlocks;) blocks[b].taken = plain_vertices(blocks[b].text, blocks[b].vertices);
      };
      helper_->run(parse);
      try {
        take(parsed);
      } catch (...) {
        helper_->finish();
        throw;
      }
      parse();
      helper_->finish();
      size_t taken = 0;
      uint64_t lines = 0;
      bool all = true;
      for (PlainBlock& block : blocks) {
        if (!all) block.vertices.clear();
        taken += all ? block.taken : 0, lines += block.vertices.size();
        all &= block.taken == block.text.size();
      }
      parsed = &blocks;
      input_.consume_lines(taken, lines);
      if (taken < text.size() / 4 * 3) next_plain_ = input_.offset() + kWorthSharing;  // other lines come first
    }
    take(parsed);
  }

  // Lines of a window, and the vertices that its leading lines are.
  struct PlainBlock {
    std::string_view text;
    std::vector<Vec3> vertices;
    size_t taken = 0;  // bytes of these lines
  };
  static constexpr size_t kBlocks = 16, kWorthSharing = Input::kWindow / 2;
  using PlainBlocks = std::array<PlainBlock, kBlocks>;

  // False if a line is longer than a block.
  static bool cut(std::string_view text, PlainBlocks& blocks) {
    constexpr size_t kShortestLine = 8;  // "v 0 0 0\n"
    size_t first = 0;
    for (size_t b = 0; b < kBlocks; ++b) {
      const size_t end = text.rfind('\n', text.size() * (b + 1) / kBlocks - 1) + 1;  // 0: there is none
      if (end <= first) return false;
      blocks[b].text = text.substr(first, end - first);
      blocks[b].vertices.clear();
      blocks[b].vertices.reserve(blocks[b].text.size() / kShortestLine);  // now, so that nothing throws while the helper works
      first = end;
    }
    return true;
  }
  void take(const PlainBlocks* blocks) {
    if (blocks == nullptr) return;
    for (const PlainBlock& block : *blocks)
      for (const Vec3& v : block.vertices) vertices_.push_back(v);
  }

  // Takes the next lines as long as they lie in the window and are exactly "f a b c" with the numbers of vertices, which textures and normals
  // may follow. Most faces are such lines.
  void read_plain_faces() {
    const std::string_view text = input_.window(0);
    const char *line = text.data(), *const end = line + text.size();
    uint64_t lines = 0;
    for (;; ++lines) {
      const char* p = line;
      if (p == end || *p++ != 'f') break;
      std::array<Vec3, 3> corners;
      std::array<uint64_t, 3> numbers;
      bool plain = true;
      for (size_t i = 0; i < 3; ++i) {
        plain = p != end && is_space(*p);
        while (p != end && is_space(*p)) ++p;
        uint64_t number = 0;
        const char* const first = p;
        p = take_digits(p, end, number);
        plain &= p - first <= 19 && number > 0 && number <= vertices_.size();
        if (!plain) break;
        numbers[i] = number - 1;
        corners[i] = vertices_[number - 1];
        if (p != end && *p == '/')
          while (p != end && (is_digit(*p) || *p == '/' || *p == '-')) ++p;
      }
      while (p != end && is_space(*p)) ++p;
      if (!plain || p == end || *p != '\n') break;
      if (wanted_) out_.add(corners[0], corners[1], corners[2], numbers);
      line = p + 1;
    }
    input_.consume_lines(static_cast<size_t>(line - text.data()), lines);
  }

  void read_face(std::string_view line) {
    Fan fan(out_, wanted_);
    for (;;) {
      if (const std::optional<uint64_t> number = plain_number_of_vertex(line)) {
        fan.add(vertices_[*number], *number);
        continue;
      }
      const std::string_view word = next_word(line);
      if (word.empty() || word[0] == '#') break;
      const uint64_t number = number_of_vertex(word);
      fan.add(vertices_[number], number);
    }
    if (fan.vertices() < 3) throw InputError(fmt::format("{}: expected a face of 3 or more vertices, found {}", input_.at_line(), fan.vertices()));
  }

  // The number of the vertex, from 0 on, that is the next word of `line`, if that word is a few digits. Otherwise none, and `line` is unchanged.
  // Nearly all words are such numbers, and number_of_vertex() takes three times as long.
  std::optional<uint64_t> plain_number_of_vertex(std::string_view& line) {
    const char* p = line.data();
    const char* const end = p + line.size();
    while (p != end && is_blank(*p)) ++p;
    uint64_t number = 0;
    for (int digits = 0; p != end && *p >= '0' && *p <= '9' && digits < 10; ++p, ++digits) number = 10 * number + static_cast<uint64_t>(*p - '0');
    if ((p != end && !is_blank(*p)) || number == 0 || number > vertices_.size()) return std::nullopt;
    line = {p, static_cast<size_t>(end - p)};
    return number - 1;
  }

  // v, v/t, v//n or v/t/n. A negative number counts back from the vertex declared last. Returns the number of the vertex from 0 on.
  uint64_t number_of_vertex(std::string_view word) {
    const size_t slash = std::min(word.find('/'), word.size());
    if (slash == 0 || word.find_first_not_of("0123456789+-/", slash) != std::string_view::npos)
      refuse_number(word, "a vertex v, v/t, v//n or v/t/n", input_);
    const int64_t number = text_integer(word.substr(0, slash), "a vertex number", input_);
    const int64_t declared = static_cast<int64_t>(vertices_.size());
    const int64_t index = number < 0 ? declared + number : number - 1;
    if (index < 0 || index >= declared)
      throw InputError(fmt::format("{}: vertex {} of a face: expected one of the {} declared so far (1 is the first, -1 the last)", input_.at_line(),
                                   number, declared));
    return static_cast<uint64_t>(index);
  }

  // A line may name several groups; the facets that follow belong to each of them.
  void enter_groups(std::string_view line) {
    grouped_ = group_wanted_ = false;
    group_.clear();
    for (std::string_view name = next_word(line); !name.empty() && name[0] != '#'; name = next_word(line)) {
      if (!std::exchange(grouped_, true)) group_ = name;
      group_wanted_ |= out_.wants(name);
    }
    choose();
  }

  void enter_object(std::string_view line) {
    const std::string_view name = trimmed(line);
    in_object_ = !name.empty();
    object_wanted_ = in_object_ && out_.wants(name);
    object_ = name;
    choose();
  }

  void count_skipped(std::string_view keyword, std::string_view line) {
    if (keyword == "l") ++polylines_;
    else if (keyword == "p")
      for (std::string_view word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line)) ++points_;
    else if (keyword == "curv" || keyword == "curv2" || keyword == "cdc") ++curves_;
    else if (keyword == "surf" || keyword == "bsp" || keyword == "bzp" || keyword == "cdp") ++surfaces_;
  }
  void warn_of_skipped() {
    const std::pair<uint64_t, const char*> counts[] = {
        {polylines_, "polyline"}, {points_, "point"}, {curves_, "free-form curve"}, {surfaces_, "free-form surface"}};
    std::string list, last;
    uint64_t sum = 0;
    for (const auto& [n, what] : counts) {
      if (n == 0) continue;
      if (!last.empty()) list += (list.empty() ? "" : ", ") + last;
      last = plural(n, what);
      sum += n;
    }
    if (sum > 0)
      out_.warn(fmt::format("{}{}{} {} skipped{}", list, list.empty() ? "" : " and ", last, sum == 1 ? "was" : "were",
                            surfaces_ > 0 ? ": convert surfaces to polygons where the body needs them" : ""));
  }

  void choose() {
    wanted_ = grouped_ || in_object_ ? group_wanted_ || object_wanted_ : out_.wants("");
    out_.enter_patch(grouped_ ? group_ : object_);
  }

  Input& input_;
  FacetStream& out_;
  Background* helper_;  // null: there is none, or the rest is not worth sharing
  VertexTable vertices_;
  std::array<PlainBlocks, 2> plain_;  // two windows, by turns
  uint64_t next_plain_ = 0;  // the offset from which to look for plain vertices again
  std::string joined_, group_, object_;
  bool grouped_ = false, group_wanted_ = false, in_object_ = false, object_wanted_ = false;
  bool wanted_;  // the facets of the current part go to the sink
  uint64_t polylines_ = 0, points_ = 0, curves_ = 0, surfaces_ = 0;  // skipped
};

Match recognises_obj(const Head& head) {
  if (!head.text) return Match::kNo;
  if (head.word.empty()) return head.bytes.find('#') != std::string_view::npos ? Match::kPerhaps : Match::kNo;  // nothing but comments so far
  for (const char* known : {"v",  "vt",  "vn",     "vp",  "f",    "fo",     "g",    "o",     "s",      "l",     "p",        "mtllib",   "usemtl",
                            "mg", "lod", "cstype", "deg", "surf", "maplib", "curv", "curv2", "usemap", "bevel", "c_interp", "d_interp", "shadow_obj"})
    if (head.word == known) return Match::kPerhaps;
  return Match::kNo;
}

void read_obj(Input& input, FacetStream& out, SurfaceFile& file, const ReadOptions& options) {
  file.format = "OBJ";
  file.float32 = false;
  ObjReader(input, out, options).read();
}

}  // namespace

const SurfaceReader kObjReader = {"OBJ", recognises_obj, read_obj};

}  // namespace teracell::mesher

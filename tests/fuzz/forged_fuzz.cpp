// Sound files whose parts are changed before their checksums are made: bodies of chunks and pages, entries of pages and directories,
// metadata as values and as text, report, footer. The input says what to change and how. Each file is then opened, verified and read in
// every way on all its levels.
#include <array>

#include <fuzzer/FuzzedDataProvider.h>

#include "tests/fuzz/read_file.hpp"
#include "tests/support/forged.hpp"

namespace teracell {
namespace {

using namespace testing;

Bytes stored_file(const Grid& grid, int ray_axis, uint32_t labels, bool tiny_chunks) {
  std::mt19937_64 random(labels);
  const Metadata meta = metadata_of(grid, ray_axis, labels);
  return stored_cells(tiny_chunks ? with_tiny_chunks(meta) : meta, random_cells(random, grid.cells(), labels));
}

// Made once: many chunks, segments and pages; a graded axis; one chunk per level; a single cell.
const std::array<Bytes, 4>& sound_files() {
  const auto axis = [](int64_t n) { return Axis::uniform(0, 1, 0, n, 0.5); };
  static const std::array<Bytes, 4> files = {stored_file(unit_grid({9, 6, 11}), 1, 3, true),
                                             stored_file({{axis(5), Axis::graded({0, 1, 2, 4}, 0.5), axis(9)}}, 2, 5, true),
                                             stored_file(unit_grid({20, 17, 40}), 0, 4, false), stored_file(unit_grid({1, 1, 1}), 2, 1, false)};
  return files;
}

class Hand {
 public:
  Hand(const uint8_t* data, size_t size) : in_(data, size) {}

  Bytes forged_file() {
    const Bytes& file = sound_files()[in_.ConsumeIntegralInRange<size_t>(0, 3)];
    const auto which = in_.ConsumeIntegral<uint8_t>();  // the kinds of lies, so that few come together
    Lies lies;
    lies.bytes = [&](FilePart part, Bytes& body) { edit(part, body); };
    if (which & 1) lies.page = [&](int, std::vector<ChunkEntry>& entries) { edit(entries); };
    if (which & 2) lies.directory = [&](int, std::vector<DirectoryEntry>& entries) { edit(entries); };
    if (which & 4) lies.metadata = [&](Metadata& meta) { edit(meta); };
    if (which & 8) lies.footer = [&](Footer& footer) { edit(footer.metadata), edit(footer.report), edit(footer.file_bytes); };
    if (which & 16) lies.cover = [&](const std::string&, std::vector<DirectoryEntry>& entries) { edit(entries); };
    if (which & 48) lies.channels = {{"unknown", {encode_text("one frame"), encode_text("and another")}}};
    return forge(file, lies);
  }

 private:
  // Whether to lie here: seldom, and never once the input is used up.
  bool here() { return in_.remaining_bytes() > 0 && in_.ConsumeIntegral<uint8_t>() % 8 == 0; }
  size_t below(size_t n) { return in_.ConsumeIntegralInRange<size_t>(0, n - 1); }
  template <class T>
  void edit(T& number) {
    if (!here()) return;
    const T some[] = {
        0, 1, static_cast<T>(number + 1), static_cast<T>(number - 1), static_cast<T>(~T{0}), static_cast<T>(~T{0} >> 1), in_.ConsumeIntegral<T>()};
    number = some[below(std::size(some))];
  }
  void edit(DirectoryEntry& e) { edit(e.offset), edit(e.size), edit(e.checksum); }

  void edit(FilePart part, Bytes& body) {
    Bytes& earlier = earlier_[static_cast<size_t>(part)];
    const Bytes honest = body;
    for (int left = 4; left > 0 && here(); --left) {
      if (body.empty()) body.push_back(0);
      const size_t at = below(body.size()), size = std::min(below(64) + 1, body.size() - at);
      const auto place = body.begin() + static_cast<ptrdiff_t>(at);
      const Bytes some(place, place + static_cast<ptrdiff_t>(size));
      switch (below(9)) {
        case 0: *place = in_.ConsumeIntegral<uint8_t>(); break;
        case 1: *place ^= static_cast<uint8_t>(1u << below(8)); break;
        case 2: body.resize(at); break;
        case 3: body.erase(place, place + static_cast<ptrdiff_t>(size)); break;
        case 4: body.insert(place, some.begin(), some.end()); break;  // twice
        case 5: body.insert(place, below(70'000), in_.ConsumeIntegral<uint8_t>()); break;
        case 6: {
          Bytes number;
          put_varint(number, in_.ConsumeIntegral<uint64_t>() >> below(64));
          body.insert(body.erase(place), number.begin(), number.end());
          break;
        }
        case 7: {
          const std::string text = in_.ConsumeRandomLengthString(40);
          body.insert(place, text.begin(), text.end());
          break;
        }
        default: body = earlier; break;
      }
    }
    earlier = honest;
  }

  void edit(std::vector<ChunkEntry>& entries) {
    for (ChunkEntry& e : entries) {
      if (!here()) continue;
      switch (below(5)) {
        case 0: e = entries[below(entries.size())]; break;
        case 1: edit(e.offset), edit(e.size), edit(e.checksum); break;
        case 2: std::swap(e, entries[below(entries.size())]); break;
        case 3: {
          e.size = 0;
          e.uniform.clear();
          Label label = 0;
          do e.uniform.push_back(label += static_cast<Label>(below(3)) + !e.uniform.empty());
          while (here());
          break;
        }
        default:
          for (LabelStats& s : e.stats) {
            edit(s.label), edit(s.cells);
            for (int d = 0; d < 3; ++d) edit(s.lo[d]), edit(s.hi[d]);
          }
      }
      if (e.size == 0 && e.uniform.empty()) e.uniform = {0};
    }
  }

  void edit(std::vector<DirectoryEntry>& entries) {
    for (DirectoryEntry& e : entries) {
      if (here()) e = entries[below(entries.size())];
      edit(e);
    }
  }

  void edit(Metadata& meta) {
    for (Axis& axis : meta.grid.axis)
      if (here()) axis = Axis::uniform(0, 1, 0, here() ? Axis::kMaxCells : in_.ConsumeIntegralInRange<int64_t>(1, 70), 0.5);
    edit(meta.chunk_rays), edit(meta.chunk_cells), edit(meta.page_chunks), edit(meta.crossings);
    if (here()) meta.ray_axis = static_cast<int>(below(3));
    if (here()) meta.labels.resize(below(8), {static_cast<uint32_t>(below(9)), "body"});
    if (here()) meta.materials.resize(below(8), {"one", "#000000", static_cast<uint32_t>(below(9))});
    for (LevelInfo& level : meta.levels()) {
      if (here()) level.level = static_cast<int>(below(9));
      edit(level.directory), edit(level.chunks), edit(level.bytes), edit(level.changes);
    }
    if (here() && !meta.levels().empty()) meta.levels().pop_back();
    for (Channel& c : std::span(meta.channels).subspan(1)) edit(c.cover), edit(c.frames);
  }

  FuzzedDataProvider in_;
  std::array<Bytes, 8> earlier_;  // the last body of each kind
};

}  // namespace
}  // namespace teracell

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace teracell;
  Bytes file;
  try {
    file = Hand(data, size).forged_file();
  } catch (const Error&) {
    return 0;  // too long to be written
  }
  testing::read_file(file);
  return 0;
}

// Reads that fail: every one of them once, in every way, while a file is opened, verified and asked. There is the right answer or an
// error that names the file; never wrong cells; and the next question, when the fault is gone, is answered.
#include "store/base/wanted.hpp"
#include "store/read/kept_chunks.hpp"
#include "store/read/query.hpp"
#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;

enum class Fault { kError, kShort, kOneBit, kOtherPlace, kShrinks, kStalls };
constexpr std::pair<Fault, const char*> kFaults[] = {{Fault::kError, "an error"},          {Fault::kShort, "too few bytes"},
                                                     {Fault::kOneBit, "a bit flipped"},    {Fault::kOtherPlace, "bytes of another place"},
                                                     {Fault::kShrinks, "a shrunken file"}, {Fault::kStalls, "a stall"}};

// What the source and the test share: the reader owns the source.
struct Faults {
  size_t reads = 0, at = ~size_t{0};  // the number of the read that fails
  Fault kind = Fault::kError;
  bool shrunken = false, stalled = false;
  void heal() { at = ~size_t{0}, shrunken = stalled = false; }
};

class FaultySource : public ByteSource {
 public:
  FaultySource(Bytes bytes, std::shared_ptr<Faults> faults) : bytes_(std::move(bytes)), faults_(std::move(faults)) {}
  uint64_t size() const override { return bytes_.size(); }
  const std::string& name() const override { return name_; }
  void read(uint64_t offset, std::span<uint8_t> out) const override {
    const bool now = faults_->reads++ == faults_->at;
    const auto fail = [&](const char* how) { throw IoError(fmt::format("{}: byte {}: {}", name_, offset, how)); };
    faults_->shrunken |= now && faults_->kind == Fault::kShrinks;
    faults_->stalled |= now && faults_->kind == Fault::kStalls;
    if (faults_->shrunken && offset + out.size() > bytes_.size() / 2) fail("end of file");
    const uint64_t from = now && faults_->kind == Fault::kOtherPlace ? (offset + 24) % (bytes_.size() - out.size() + 1) : offset;
    const size_t size = now && faults_->kind == Fault::kShort ? out.size() / 2 : out.size();
    std::copy_n(bytes_.begin() + static_cast<ptrdiff_t>(from), size, out.begin());
    if (size < out.size()) fail("end of file");
    if (now && faults_->kind == Fault::kError) fail("Input/output error");
    if (now && faults_->kind == Fault::kOneBit && !out.empty()) out[out.size() / 3] ^= 16;
  }

 private:
  const Bytes bytes_;
  const std::string name_ = "memory.tcell";
  std::shared_ptr<Faults> faults_;
};

struct Answers {
  std::vector<uint16_t> slices;
  std::vector<CellStats> stats;
  std::vector<std::vector<Mask>> boxes;
  std::string report;
};

void ask(const GridReader& reader, Answers& out, bool verified) {
  if (verified) verify_quietly(reader);
  for (int level = 0; level < 3; ++level)
    for (int axis = 0; axis < 3; ++axis)
      for_each_row(reader, whole_slice(reader.meta(), axis, 1, level), strongest_material(reader.meta()), axis == 0, 1,
                   [&](int64_t, std::span<const uint16_t> row) { out.slices.insert(out.slices.end(), row.begin(), row.end()); });
  const Index3 n = reader.meta().grid.cells();
  out.stats = read_stats(reader, {{1, 0, 1}, {n[0], n[1] - 1, n[2]}});
  out.boxes = read_everything(reader);
  out.report = reader.report();
}

bool same(const Answers& a, const Answers& b) {
  const bool same_stats = std::ranges::equal(
      a.stats, b.stats, [](const CellStats& x, const CellStats& y) { return x.cells == y.cells && x.volume == y.volume && x.box == y.box; });
  return same_stats && a.slices == b.slices && a.boxes == b.boxes && a.report == b.report;
}

TEST_CASE("Whichever read fails, and however, the answer is right or an error, and the next one is right", "[faults]") {
  const Bytes file = chunked_file(1, {5, 6, 9});
  const auto keeper = GENERATE(false, true);
  const auto open = [&](const std::shared_ptr<Faults>& faults) {
    return std::make_unique<GridReader>(std::make_unique<FaultySource>(file, faults),
                                        keeper ? std::make_shared<KeptChunks>(size_t{1} << 30) : nullptr);
  };
  Answers right;
  size_t reads = 0;
  {
    const auto faults = std::make_shared<Faults>();
    ask(*open(faults), right, true);
    reads = faults->reads;
  }
  REQUIRE(reads > 60);
  size_t answers = 0, errors = 0;
  for (const auto& [kind, name] : kFaults)
    for (size_t at = 0; at < reads; at += kStride) {
      INFO(name << " at read " << at << " of " << reads << ", keeper " << keeper);
      const auto faults = std::make_shared<Faults>(Faults{0, at, kind});
      std::unique_ptr<GridReader> reader;
      try {
        const Wanted wanted([&] {
          if (faults->stalled) throw Unwanted("nobody waits");
        });
        reader = open(faults);
        Answers found;
        ask(*reader, found, true);
        ++answers;
        if (!same(found, right)) FAIL("wrong cells");
        if (kind == Fault::kError || kind == Fault::kShort || kind == Fault::kOneBit) FAIL("nobody noticed");
      } catch (const Unwanted&) {
        ++errors;
        if (kind != Fault::kStalls) FAIL("was given up");
      } catch (const Error& e) {
        ++errors;
        const std::string message = e.what();
        INFO(message);
        if (!message.starts_with("memory.tcell: ") || message.size() < 20 || message.size() > 400) FAIL("no clear error");
        if (dynamic_cast<const FormatError*>(&e) == nullptr && dynamic_cast<const IoError*>(&e) == nullptr) FAIL("another kind of error");
      }
      faults->heal();
      if (!reader) reader = open(faults);
      Answers again;
      ask(*reader, again, false);
      if (!same(again, right)) FAIL("wrong cells after the fault");
    }
  CHECK(errors > 4 * reads / kStride);
  CHECK((kSanitized || answers > 0));  // of bytes of another place, when they are the same; of a stall behind the last chunk
}

TEST_CASE("A file that is cut short while it is open gives errors that name it, and answers again when it is whole", "[faults]") {
  const TempFolder folder;
  const Bytes file = chunked_file(2, {5, 6, 9});
  const auto path = folder / "g.tcell";
  const auto write = [&](size_t size) {
    std::ofstream(path, std::ios::binary | std::ios::in | std::ios::out)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(size));
    std::filesystem::resize_file(path, size);
  };
  std::ofstream(path).put(' ');
  write(file.size());
  const GridReader reader(path);
  Answers right;
  ask(reader, right, false);
  for (size_t size = 0; size < file.size() - kFooterBytes; size += file.size() / 20) {  // the footer was read when it was opened
    write(file.size());
    const GridReader fresh(path);
    write(size);
    INFO("cut to " << size << " bytes of " << file.size());
    REQUIRE_THROWS_WITH(verify_quietly(fresh), Catch::StartsWith(path.string() + ": "));
    REQUIRE_THROWS_AS(GridReader(path), Error);
    write(file.size());
    Answers again;
    ask(fresh, again, true);
    REQUIRE(same(again, right));
  }
}

}  // namespace
}  // namespace teracell

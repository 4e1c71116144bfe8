// Blocks of a far source in memory and on disk: always the bytes of the source, in few requests, whatever threads do.
#include "store/remote/cached_source.hpp"

#include "store/format/checked_read.hpp"
#include "tests/support/small_files.hpp"

namespace teracell {
namespace {

using namespace testing;
constexpr uint64_t kBlock = CachedSource::kBlock;

// Counts the requests of a cache, and fails when it is told to.
class Far : public ByteSource {
 public:
  explicit Far(Bytes bytes) : bytes_(std::move(bytes)) {}
  uint64_t size() const override { return bytes_.size(); }
  const std::string& name() const override { return name_; }
  bool is_far() const override { return true; }
  void read(uint64_t offset, std::span<uint8_t> out) const override {
    ++requests;
    read_bytes += out.size();
    if (failing) throw IoError("the host is away");
    if (offset > size() || out.size() > size() - offset) throw IoError("beyond the end");
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), out.size(), out.begin());
  }
  void read_many(std::span<const ByteRead> reads) const override {
    at_once = std::max<uint64_t>(at_once, reads.size());
    ByteSource::read_many(reads);
  }
  mutable std::atomic<uint64_t> requests = 0, read_bytes = 0, at_once = 0;
  std::atomic<bool> failing = false;

 private:
  const Bytes bytes_;
  const std::string name_ = "far.tcell";
};

Bytes noise(size_t n) {
  std::mt19937_64 random(n);
  Bytes out(n);
  for (uint8_t& b : out) b = static_cast<uint8_t>(random());
  return out;
}

struct CacheOf {
  explicit CacheOf(const Bytes& bytes, size_t memory = size_t{64} << 20, std::unique_ptr<BlockFolder> disk = nullptr, CachedSource::Kept kept = {}) {
    auto made = std::make_unique<Far>(bytes);
    far = made.get();
    source = std::make_unique<CachedSource>(std::move(made), std::move(disk), std::move(kept), std::make_shared<BlockCache>(memory));
  }
  Bytes read(uint64_t offset, uint64_t size) const {
    Bytes out(size);
    source->read(offset, out);
    return out;
  }
  Far* far;
  std::unique_ptr<CachedSource> source;
};

Bytes part(const Bytes& bytes, uint64_t offset, uint64_t size) {
  return {bytes.begin() + static_cast<std::ptrdiff_t>(offset), bytes.begin() + static_cast<std::ptrdiff_t>(offset + size)};
}

TEST_CASE("A cache gives the bytes of its source, wherever they are asked for") {
  const Bytes bytes = noise(40 * kBlock + 777);
  for (const size_t memory : {size_t{2} * kBlock, size_t{10} * kBlock, size_t{100} * kBlock}) {
    const CacheOf cache(bytes, memory, nullptr, {bytes.size() - 5000, part(bytes, bytes.size() - 5000, 5000)});
    std::mt19937_64 random(memory);
    for (int i = 0; i < 2000; ++i) {
      const uint64_t offset = random() % bytes.size(), size = std::min(bytes.size() - offset, random() % (i % 10 == 0 ? 20 * kBlock : 3000));
      if (i % 7 == 0) cache.source->prefetch(std::vector<ByteRange>{{offset, size}, {bytes.size() - 1, 5}, {0, 1}});
      REQUIRE(cache.read(offset, size) == part(bytes, offset, size));
    }
    REQUIRE_THROWS_AS(cache.read(bytes.size() - 1, 2), IoError);
  }
}

TEST_CASE("What is kept, or was read, is not asked for again; neighbours come in one request; reads in a row look ahead") {
  const Bytes bytes = noise(400 * kBlock);
  const CacheOf cache(bytes, size_t{64} << 20, nullptr, {bytes.size() - 5000, part(bytes, bytes.size() - 5000, 5000)});
  cache.read(bytes.size() - 100, 100);
  REQUIRE(cache.far->requests == 0);
  for (int i = 0; i < 3; ++i) cache.read(10 * kBlock + 5, 2 * kBlock);
  REQUIRE(cache.far->requests == 1);
  cache.source->prefetch(std::vector<ByteRange>{{100 * kBlock, 10}, {100 * kBlock + 20, 3 * kBlock}, {(104 + CachedSource::kGap) * kBlock, 10}});
  REQUIRE(cache.far->requests == 2);
  cache.source->prefetch(std::vector<ByteRange>{{130 * kBlock, 10}, {150 * kBlock, 10}});
  REQUIRE(cache.far->requests == 4);
  const uint64_t before = cache.far->requests;
  for (uint64_t b = 200; b < 399; ++b) cache.read(b * kBlock, kBlock);
  REQUIRE(cache.far->requests - before < 12);
}

TEST_CASE("Places that lie apart are fetched some at a time, and are right") {
  constexpr uint64_t kApart = CachedSource::kGap + 3;
  const Bytes bytes = noise(200 * kApart * kBlock);
  const CacheOf cache(bytes);
  std::vector<ByteRange> places;
  for (uint64_t i = 0; i < 200; ++i) places.push_back({i * kApart * kBlock + 7, 100});
  cache.source->prefetch(places);
  REQUIRE(cache.far->requests == 200);
  REQUIRE(cache.far->at_once == CachedSource::kTogether);
  for (const ByteRange& r : places) REQUIRE(cache.read(r.offset, r.size) == part(bytes, r.offset, r.size));
  REQUIRE(cache.far->requests == 200);
}

TEST_CASE("Sources that share their memory have blocks of their own, and no more memory") {
  const Bytes first = noise(50 * kBlock), second = noise(60 * kBlock);
  const auto memory = std::make_shared<BlockCache>(size_t{40} * kBlock);
  CachedSource a(std::make_unique<Far>(first), nullptr, {}, memory), b(std::make_unique<Far>(second), nullptr, {}, memory);
  Bytes found(100);
  for (uint64_t block = 1; block < 50; ++block) {
    a.read(block * kBlock + 3, found);
    REQUIRE(found == part(first, block * kBlock + 3, 100));
    b.read(block * kBlock + 3, found);
    REQUIRE(found == part(second, block * kBlock + 3, 100));
  }
  REQUIRE(memory->counts().bytes <= memory->counts().limit);
}

TEST_CASE("Threads that want the same blocks fetch each once", "[threads]") {
  const Bytes bytes = noise(60 * kBlock);
  const CacheOf cache(bytes);
  std::vector<std::jthread> threads;
  std::atomic<int> wrong = 0;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      std::mt19937_64 random(static_cast<uint64_t>(t));
      for (int i = 0; i < 300; ++i) {
        const uint64_t offset = random() % (bytes.size() - 9000);
        if (cache.read(offset, 9000) != part(bytes, offset, 9000)) ++wrong;
      }
    });
  threads.clear();
  REQUIRE(wrong == 0);
  REQUIRE(cache.far->read_bytes <= bytes.size() + 60 * CachedSource::kGap * kBlock);
}

TEST_CASE("A failure reaches those who asked, and the next one asks again") {
  const Bytes bytes = noise(10 * kBlock);
  const CacheOf cache(bytes);
  cache.far->failing = true;
  REQUIRE_THROWS_AS(cache.read(5, 100), IoError);
  cache.far->failing = false;
  REQUIRE(cache.read(5, 100) == part(bytes, 5, 100));
}

class Endless : public ByteSource {
 public:
  uint64_t size() const override { return uint64_t{1} << 60; }
  const std::string& name() const override { return name_; }
  bool is_far() const override { return true; }
  void read(uint64_t, std::span<uint8_t>) const override { throw IoError("asked"); }

 private:
  const std::string name_ = "endless.tcell";
};

TEST_CASE("A host that says that its file has any size gets no memory for it") {
  Bytes out;
  REQUIRE_THROWS_AS(read_checked(Endless(), {0, uint64_t{1} << 50, 0}, "metadata", out), FormatError);
  REQUIRE(out.empty());
}

TEST_CASE("Blocks on disk serve the next program; damaged ones are fetched again; another version is another object") {
  const TempFolder folder;
  const Bytes bytes = noise(70 * kBlock + 99);
  const auto disk = [&](const char* what) { return std::make_unique<BlockFolder>(folder / "kept", uint64_t{1} << 30, what); };
  const auto read_all = [&](const CacheOf& cache) {
    for (uint64_t at = 0; at < bytes.size(); at += 3000) {
      const uint64_t size = std::min<uint64_t>(3000, bytes.size() - at);
      REQUIRE(cache.read(at, size) == part(bytes, at, size));
    }
  };
  const size_t memory = 8 * kBlock;
  read_all(CacheOf(bytes, memory, disk("one")));
  const CacheOf second(bytes, memory, disk("one"));
  read_all(second);
  REQUIRE(second.far->requests == 0);
  const CacheOf other(bytes, memory, disk("two"));
  read_all(other);
  REQUIRE(other.far->read_bytes >= bytes.size());
  size_t flipped = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "kept")) {
    for (uint64_t at = 100; at < entry.file_size(); at += 2 * kBlock, ++flipped) damage(entry.path(), at);
  }
  REQUIRE(flipped > 10);
  const CacheOf damaged(bytes, memory, disk("one"));
  read_all(damaged);
  REQUIRE(damaged.far->requests > 0);
}

TEST_CASE("A folder of blocks stays within its bound and removes nothing but blocks") {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "kept");
  std::ofstream(folder / "kept" / "mine.blocks") << "mine";
  const uint64_t most = 40 * kBlock;
  for (int n = 0; n < 20; ++n) {
    const BlockFolder blocks(folder / "kept", most, std::to_string(n));
    const Bytes block = noise(kBlock);
    for (uint64_t b = 0; b < 10; ++b) blocks.add(b, block);
    REQUIRE(blocks.find(9, kBlock) == block);
  }
  uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "kept")) bytes += entry.file_size();
  REQUIRE(bytes < 2 * most);
  REQUIRE(std::filesystem::exists(folder / "kept" / "mine.blocks"));
}

}  // namespace
}  // namespace teracell

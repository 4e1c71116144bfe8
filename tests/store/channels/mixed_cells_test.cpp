// Shares of mixed cells to bytes and back; and bytes that no encoder wrote.
#include "store/channels/mixed_cells.hpp"

#include "store/format/format.hpp"
#include "tests/support/forged.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;

struct MixedShape {
  uint32_t nu, nv, length, labels, total;
};

MixedCells random_mixed_cells(std::mt19937_64& random, const MixedShape& s) {
  MixedCells cells;
  cells.reset(s.nu, s.nv, s.length, s.total);
  for (uint32_t ray = 0; ray < s.nu * s.nv; ++ray) {
    for (uint32_t at = 0; random_int(random, 0, 3) != 0;) {
      const uint32_t from = at + static_cast<uint32_t>(random_int(random, 0, 5)), to = from + static_cast<uint32_t>(random_int(random, 1, 4));
      if (to > s.length) break;
      at = to;
      std::vector<uint32_t> labels(s.labels), counts;
      std::iota(labels.begin(), labels.end(), 0u);
      std::ranges::shuffle(labels, random);
      labels.resize(static_cast<size_t>(random_int(random, 1, static_cast<int>(std::min(s.labels, s.total)))));
      std::ranges::sort(labels);
      uint32_t left = s.total;
      for (size_t i = 0; i + 1 < labels.size(); ++i) {
        const auto spare = static_cast<int>(left - (labels.size() - 1 - i));
        counts.push_back(static_cast<uint32_t>(random_int(random, 1, spare)));
        left -= counts.back();
      }
      counts.push_back(left);
      cells.add(from, to, labels, counts);
    }
    cells.end_ray();
  }
  return cells;
}

// What a program sees of it.
std::vector<std::vector<uint32_t>> seen(const MixedCells& cells) {
  std::vector<std::vector<uint32_t>> out;
  for (uint32_t ray = 0; ray < cells.nu * cells.nv; ++ray)
    for (const MixedCells::Run& run : cells.of_ray(ray)) {
      std::vector<uint32_t>& row = out.emplace_back(std::vector<uint32_t>{ray, run.from, run.to});
      row.insert(row.end(), cells.labels(run).begin(), cells.labels(run).end());
      row.insert(row.end(), cells.counts_of(run).begin(), cells.counts_of(run).end());
    }
  return out;
}

using Decode = decltype(decode_mixed_cells)*;

MixedCells decoded_mixed(std::span<const uint8_t> frame, const MixedShape& s, Decode decode = decode_mixed_cells) {
  MixedCells out;
  decode(frame, s.nu, s.nv, s.length, s.labels, s.total, out);
  return out;
}

// A FormatError, or cells that keep every promise of mixed_cells.hpp.
void expect_refused_or_sound_mixed(const Bytes& bytes, const MixedShape& s, Decode decode = decode_mixed_cells) {
  const Bytes exact(bytes.begin(), bytes.end());  // its own piece of the heap, so that ASan sees one byte too far
  MixedCells cells;
  try {
    decode(exact, s.nu, s.nv, s.length, s.labels, s.total, cells);
  } catch (const FormatError&) {
    return;
  }
  bool sound = cells.begin.size() == size_t{s.nu} * s.nv + 1;
  for (uint32_t ray = 0; sound && ray < s.nu * s.nv; ++ray) {
    uint32_t at = 0;
    for (const MixedCells::Run& run : cells.of_ray(ray)) {
      uint64_t sum = 0;
      for (const uint32_t count : cells.counts_of(run)) sum += count, sound &= count > 0;
      sound &= at <= run.from && run.from < run.to && run.to <= s.length && sum == s.total;
      for (const uint32_t label : cells.labels(run)) sound &= label < s.labels;
      at = run.to;
    }
  }
  if (!sound) FAIL("decoded cells are not sound");
}

TEST_CASE("Mixed cells come back from their bytes", "[fractions]") {
  std::mt19937_64 random(3);
  for (const MixedShape& s :
       {MixedShape{4, 4, 50, 2, 2}, MixedShape{7, 3, 200, 5, 64}, MixedShape{8, 8, 90, 3, 256}, MixedShape{2, 9, 70, 70000, 512},
        MixedShape{3, 2, 40, 4, 65536}, MixedShape{5, 5, 60, 3, 1}, MixedShape{1, 3, 100000, 2, 1024}})
    for (int i = 0; i < 10; ++i) {
      const MixedCells cells = random_mixed_cells(random, {s.nu, s.nv, s.length, std::min(s.labels, 6u), s.total});
      if (cells.empty()) continue;
      const Bytes frame = MixedCellsEncoder().encode(cells);
      const MixedCells back = decoded_mixed(frame, s);
      REQUIRE(seen(back) == seen(cells));
      REQUIRE(MixedCellsEncoder().encode(back) == frame);
      REQUIRE(seen(decoded_mixed(old_mixed_frame(cells), s, decode_shares)) == seen(cells));
    }
}

TEST_CASE("Equal shares in neighbouring cells are one run, and a cut keeps what lies in it", "[fractions]") {
  MixedCells cells;
  cells.reset(1, 1, 20, 8);
  const uint32_t labels[] = {0, 2}, counts[] = {3, 5}, others[] = {4, 4};
  cells.add(2, 3, labels, counts);
  cells.add(3, 6, labels, counts);
  cells.add(6, 7, labels, others);
  cells.add(8, 9, labels, others);
  cells.end_ray();
  REQUIRE(cells.runs == 3);
  REQUIRE(cells.stretches == decltype(cells.stretches){{2, 0}, {8, 2}});
  REQUIRE(cells.longer == std::vector<MixedCells::Longer>{{0, 4}});
  REQUIRE(seen(cut(cells, 4, 8)) == std::vector<std::vector<uint32_t>>{{0, 0, 2, 0, 2, 3, 5}, {0, 2, 3, 0, 2, 4, 4}});
  REQUIRE(cut(cells, 10, 20).empty());
}

TEST_CASE("Rays of other cells are appended as they are, and runs go on behind them", "[fractions]") {
  std::mt19937_64 random(5);
  for (int i = 0; i < 20; ++i) {
    const MixedShape s{4, 5, 60, 3, 64};
    const MixedCells lower = random_mixed_cells(random, s), upper = random_mixed_cells(random, s);
    MixedCells one_by_one, by_rays;
    one_by_one.reset(s.nu, s.nv, 2 * s.length, s.total), by_rays.reset(s.nu, s.nv, 2 * s.length, s.total);
    for (uint32_t ray = 0; ray < s.nu * s.nv; ++ray) {
      by_rays.add_ray(lower, ray);
      uint32_t end = 0;
      for (const MixedCells::Run& run : lower.of_ray(ray)) {
        one_by_one.add(run.from, run.to, lower.labels(run), lower.counts_of(run));
        end = run.to;
      }
      // Every other time the upper cells begin where the lower ones end, with equal shares or with others.
      for (const MixedCells::Run& run : upper.of_ray(ray))
        for (MixedCells* const out : {&one_by_one, &by_rays}) {
          const uint32_t shift = ray % 2 == 0 ? s.length : end;
          out->add(shift + run.from, shift + run.to, upper.labels(run), upper.counts_of(run));
        }
      one_by_one.end_ray(), by_rays.end_ray();
    }
    REQUIRE(seen(by_rays) == seen(one_by_one));
    REQUIRE(by_rays.begin == one_by_one.begin);
    REQUIRE(by_rays.stretches == one_by_one.stretches);
    if (!by_rays.empty())
      REQUIRE(seen(decoded_mixed(MixedCellsEncoder().encode(by_rays), {s.nu, s.nv, 2 * s.length, s.labels, s.total})) == seen(by_rays));
  }
}

TEST_CASE("Bytes that are no mixed cells are refused", "[fractions]") {
  const MixedShape s{2, 1, 8, 3, 4};
  const auto frame_of = [](const std::vector<uint64_t>& numbers, const Bytes& counts) {
    Bytes body;
    for (const uint64_t n : numbers) put_varint(body, n);
    return forge(MixedFrame{{body.begin(), body.end()}, counts});
  };
  const auto refused = [&](const std::vector<uint64_t>& numbers, const Bytes& counts, const std::string& words) {
    INFO(words);
    REQUIRE_THROWS_WITH(decoded_mixed(frame_of(numbers, counts), s), Catch::Contains(words));
  };
  // One set {0, 1}; a stretch in each ray: cells 3 and 4 with 2 + 2, then cell 1 with 3 + 1 and cell 2 with 1 + 3. Counts have two bits.
  const std::vector<uint64_t> sound = {1, 2, 0, 0, 1, 1, 6, 3, 0, 1, 1, 0, 0};
  REQUIRE(seen(decoded_mixed(frame_of(sound, {0b001001}), s)) ==
          std::vector<std::vector<uint32_t>>{{0, 3, 5, 0, 1, 2, 2}, {1, 1, 2, 0, 1, 3, 1}, {1, 2, 3, 0, 1, 1, 3}});
  refused({2, 2, 0, 0, 2, 0, 0, 1, 1, 6, 3, 0, 1, 1, 0, 0, 0, 0, 0}, {0b001001}, "occurs twice");
  refused({1, 2, 0, 5, 1, 1, 6, 3, 0, 1, 1, 0, 0}, {0b001001}, "label");
  refused({1, 2, 0, 0, 0, 0, 0}, {}, "no mixed cell");
  refused({1, 2, 0, 0, 1, 9, 6, 3, 0, 1, 1, 0, 0}, {0b001001}, "stretches of a ray");
  refused({1, 2, 0, 0, 2, 2, 6, 3, 0, 1, 1, 0, 0}, {0b001001}, "4 stretches, more than bytes");
  refused({1, 2, 0, 0, 1, 1, 6, 3, 0, 1, 1, 0, 4}, {0b001001}, "beyond its ray");
  refused({1, 2, 0, 0, 1, 1, 5, 3, 0, 1, 1, 0, 0}, {0b001001}, "beyond its ray");      // it begins below 0
  refused({1, 2, 0, 0, 2, 0, 6, 2, 0, 1, 1, 0, 0}, {0b001001}, "one before it ends");  // at cell 1, behind cells 3 and 4
  refused({1, 2, 0, 0, 2, 0, 6, 10, 0, 1, 1, 0, 0}, {0b001001}, "one before it ends");  // at cell 5, where they end
  refused({1, 2, 0, 0, 1, 1, 6, 3, 0, 1, 1, 3, 0}, {0b001001}, "beyond the last one");
  refused({1, 2, 0, 0, 1, 1, 6, 3, 0, 7, 0}, {0b001001}, "there are 9 runs, but at most 4");
  refused({1, 1, 0, 1, 1, 6, 3, 0, 1, 0}, {}, "there are 3 runs, but at most 2");  // of one label, so two runs side by side are alike
  refused(sound, {0b001011}, "more than the whole");
  refused(sound, {0b1001001}, "behind the last count");
  refused(sound, {0b001001, 0}, "found 2 bytes");
  refused(sound, {}, "at most 0");
  refused({1, 2, 0, 0, 1, 1, 6, 3, 0, 1, 1, 0, 0, 9}, {0b001001}, "expected the end");
  Bytes other = frame_of(sound, {0b001001});
  other[4] = 1;
  REQUIRE_THROWS_WITH(decoded_mixed(other, s), Catch::Contains("skippable frame"));
  REQUIRE_THROWS_WITH(decoded_mixed(old_mixed_frame(decoded_mixed(frame_of(sound, {0b001001}), s)), s), Catch::Contains("skippable frame"));
}

TEST_CASE("Bytes that are no mixed cells as old files have them are refused", "[fractions]") {
  const MixedShape s{2, 1, 8, 3, 4};
  const auto frame_of = [](const std::vector<uint64_t>& numbers) {
    Bytes body;
    for (const uint64_t n : numbers) put_varint(body, n);
    return encode_text({body.begin(), body.end()});
  };
  // One set {0, 1}; a run in each ray: cells 3 and 4 with 2 + 2, then cell 1 with 3 + 1.
  const std::vector<uint64_t> sound = {1, 2, 0, 0, 1, 1, 6, 3, 1, 0, 1, 2};
  REQUIRE(seen(decoded_mixed(frame_of(sound), s, decode_shares)) == std::vector<std::vector<uint32_t>>{{0, 3, 5, 0, 1, 2, 2}, {1, 1, 2, 0, 1, 3, 1}});
  const auto refused = [&](std::vector<uint64_t> numbers, const std::string& words) {
    INFO(words);
    REQUIRE_THROWS_WITH(decoded_mixed(frame_of(numbers), s, decode_shares), Catch::Contains(words));
  };
  refused({2, 2, 0, 0, 2, 0, 0, 1, 1, 6, 3, 1, 0, 0, 0, 1, 2}, "occurs twice");
  refused({1, 2, 0, 5, 1, 1, 6, 3, 1, 0, 1, 2}, "label");
  refused({1, 2, 0, 0, 0, 0}, "no mixed cell");
  refused({1, 2, 0, 0, 1, 1, 6, 3, 7, 0, 1, 2}, "beyond its ray");
  refused({1, 2, 0, 0, 1, 1, 5, 3, 1, 0, 1, 2}, "beyond its ray");  // it begins below 0
  refused({1, 2, 0, 0, 1, 1, 6, 3, 1, 0, 3, 2}, "more than the whole");
  refused({1, 2, 0, 0, 1, 1, 6, 3, 1, 0, 1, 2, 9}, "expected the end");
  refused({1, 2, 0, 0, 1, 1, 6, 3, 1, 0, 1}, "more counts than bytes");
}

TEST_CASE("Mixed cells cut at any byte are refused, and changed ones are refused or sound", "[fractions]") {
  std::mt19937_64 random(7);
  const MixedShape s{6, 5, 60, 4, 512};
  const MixedCells cells = random_mixed_cells(random, s);
  const Bytes frame = MixedCellsEncoder().encode(cells), old = old_mixed_frame(cells);
  for (size_t size = 0; size < frame.size(); ++size) REQUIRE_THROWS_AS(decoded_mixed(std::span(frame).first(size), s), FormatError);
  for (size_t size = 0; size < old.size(); ++size) REQUIRE_THROWS_AS(decoded_mixed(std::span(old).first(size), s, decode_shares), FormatError);
  const auto change = [&](auto& bytes) {
    for (int n = random_int(random, 1, 3); n > 0; --n)
      bytes[static_cast<size_t>(random_int(random, 0, static_cast<int>(bytes.size()) - 1))] = static_cast<uint8_t>(random_int(random, 0, 255));
  };
  for (size_t i = 0; i < rounds(4000); ++i) {
    MixedFrame changed = mixed_frame(frame);
    if (i % 4 == 0) change(changed.counts);
    else change(changed.body);
    expect_refused_or_sound_mixed(forge(changed), s);
    std::string changed_old = decode_text(old, "mixed cells");
    change(changed_old);
    expect_refused_or_sound_mixed(encode_text(changed_old), s, decode_shares);
  }
}

TEST_CASE("A subdivision is powers of two within its bounds", "[fractions]") {
  CHECK(beyond_bounds({4, 4, 64}).empty());
  CHECK(beyond_bounds({256, 256, 1}).empty());
  CHECK(beyond_bounds({1, 1, 1}).empty());
  for (const Subdivision& wrong : {Subdivision{0, 4, 4}, Subdivision{3, 4, 4}, Subdivision{512, 1, 1}, Subdivision{256, 256, 2}})
    CHECK_FALSE(beyond_bounds(wrong).empty());
}

}  // namespace
}  // namespace teracell

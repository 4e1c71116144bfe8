#include "tests/siege/forged_files.hpp"

#include <fmt/format.h>

#include "tests/support/assembled.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/random.hpp"

namespace teracell::testing {
namespace {

using Frames = std::vector<Bytes>;

Metadata metadata(const Index3& n, uint32_t rays, uint32_t cells, uint32_t page, uint32_t labels = 2) {
  Metadata meta;
  meta.grid = unit_grid(n);
  meta.ray_axis = 2;
  meta.chunk_rays = rays, meta.chunk_cells = cells, meta.page_chunks = page;
  meta.materials = {{"air", "#00000000", 1}, {"steel", "#8899aa", 0}};
  for (uint32_t l = 0; l < labels; ++l) meta.labels.push_back({l % 2, ""});
  return meta;
}

// With as many materials as labels.
Metadata with_materials(Metadata meta, uint32_t count, const std::string& suffix = "") {
  meta.materials.clear();
  meta.labels.clear();
  for (uint32_t m = 0; m < count; ++m)
    meta.materials.push_back({fmt::format("{}{}", m, suffix), "#000000", count - 1 - m}), meta.labels.push_back({m, ""});
  return meta;
}

// Names that take as much room as they may, in few bytes of the file.
Metadata with_long_names(Metadata meta, const std::string& unit) {
  std::string name;
  while (name.size() + unit.size() <= kMostName) name += unit;
  meta.materials.clear();
  for (uint32_t m = 0; m < kMostMaterialNames / kMostName - 1; ++m) meta.materials.push_back({name, "#000000", m == 0 ? 65535 : m});
  return meta;
}

Metadata with_graded_x(Metadata meta) {
  std::vector<double> planes;
  for (int64_t i = 0; i <= meta.grid.axis[0].cells(); ++i) planes.push_back(static_cast<double>(i));
  meta.grid.axis[0] = Axis::graded(planes, 0.5);
  return meta;
}

Bytes single_labels(uint32_t count) {
  Bytes out;
  put_varint(out, count);
  for (uint32_t l = 0; l < count; ++l) put_set(out, {l});
  return out;
}

Bytes pairs_of_labels(uint32_t count, uint32_t labels) {
  Bytes out;
  put_varint(out, count);
  for (uint32_t a = 0, b = 1; count > 0; --count) {
    put_set(out, {a, b});
    if (++b == labels) ++a, b = a + 1;
  }
  return out;
}

// All rays have the same `changes`, one after each cell; their sets go round the palette. All that is behind the pattern is zeros.
Bytes same_rays(Bytes palette, uint32_t sets, uint64_t rays, uint64_t changes) {
  Bytes out = std::move(palette), cycle;
  for (uint32_t s = 0; s < sets; ++s) put_varint(cycle, s);
  put_varint(out, 1);
  put_varint(out, changes);
  for (uint64_t i = 0; i < (changes + 1) / sets; ++i) out.insert(out.end(), cycle.begin(), cycle.end());
  for (uint64_t i = 0; i < (changes + 1) % sets; ++i) put_varint(out, i);
  put_varint(out, 0);
  out.resize(out.size() + rays * changes);
  return out;
}

// One set throughout, in a frame that says so ray by ray.
Bytes plain_rays() { return {1, 1, 0, 1, 0, 0, 0}; }

std::vector<LabelStats> vague_stats() { return {{0, 7, {0, 0, 0}, {1, 1, 1}}}; }

// A chunk at every place of the levels where `many` holds; the others have one set.
Bytes with_one_frame(Assembly& file, const Bytes& frame, const std::function<bool(const ChunkKey&)>& here) {
  const ChunkEntry entry = file.chunk(frame, vague_stats());
  return file.finish([&](const ChunkKey& key) {
    if (!here(key)) return Assembly::uniform();
    ChunkEntry e = entry;
    if (key.level > 0) e.stats.clear();
    return e;
  });
}

// One chunk of level 0.
Bytes single(Metadata meta, const Bytes& body, uint64_t ratio) {
  Assembly file(std::move(meta));
  return with_one_frame(file, squeezed(body, ratio), [](const ChunkKey& key) { return key.level == 0; });
}

struct Case {
  const char* name;
  Bytes (*make)(uint64_t most, uint64_t ratio);  // bodies of about `most` bytes
};

constexpr int64_t kFar = Axis::kMaxCells;

const Case kCases[] = {
    {"65,536 rays of as many changes as there may be",
     [](uint64_t most, uint64_t ratio) {
       return single(metadata({256, 256, 1 << 20}, 256, 1 << 20, 16), same_rays(single_labels(2), 2, 65536, most / 65536 - 1), ratio);
     }},
    {"64 rays of as many changes, side by side",
     [](uint64_t most, uint64_t ratio) {
       return single(metadata({64, 1, kFar}, 64, 1u << 31, 16), same_rays(single_labels(2), 2, 64, most / 66), ratio);
     }},
    {"a ray of as many changes along a very wide slice",
     [](uint64_t most, uint64_t ratio) {
       return single(metadata({1, 1, kFar}, 4, 1u << 31, 16), same_rays(single_labels(2), 2, 1, most / 2 - 9), ratio);
     }},
    {"a ray whose changes go round thousands of labels",
     [](uint64_t most, uint64_t ratio) {
       return single(with_materials(metadata({1, 1, kFar}, 4, 1u << 31, 16), 3000), same_rays(single_labels(3000), 3000, 1, most / 3 - 9000), ratio);
     }},
    {"a row of rays whose changes go round thousands of labels",
     [](uint64_t most, uint64_t ratio) {
       return single(with_materials(metadata({256, 1, 1 << 26}, 256, 1u << 31, 16), 3000),
                     same_rays(single_labels(3000), 3000, 256, most / 258 - 100), ratio);
     }},
    {"rays that go round thousands of sets on a coarse level",
     [](uint64_t most, uint64_t ratio) {
       Assembly file(metadata({1024, 1, 1 << 26}, 256, 1u << 31, 16, 100));
       return with_one_frame(file, squeezed(same_rays(pairs_of_labels(4000, 100), 4000, 256, most / 258 - 100), ratio),
                             [](const ChunkKey& key) { return key.level == 2; });
     }},
    {"a palette of one label, again and again",
     [](uint64_t most, uint64_t ratio) {
       Bytes body;
       put_varint(body, most / 2 - 9);
       const Bytes sets = repeated({1, 0}, most / 2 - 9), rest = {1, 0, 0, 0};
       body.insert(body.end(), sets.begin(), sets.end());
       body.insert(body.end(), rest.begin(), rest.end());
       return single(metadata({4, 4, 4}, 4, 4, 1), body, ratio);
     }},
    {"a palette of pairs",
     [](uint64_t most, uint64_t ratio) {
       Bytes body = pairs_of_labels(static_cast<uint32_t>(most / 4), 20000);
       const Bytes rest = {1, 0, 0, 0};
       body.insert(body.end(), rest.begin(), rest.end());
       return single(metadata({4, 4, 4}, 4, 4, 1, 20000), body, ratio);
     }},
    {"a palette of two sets of thousands of labels, again and again",
     [](uint64_t most, uint64_t ratio) {
       std::vector<Label> all(100'000);
       for (Label l = 0; l < all.size(); ++l) all[l] = l;
       Bytes set, body;
       put_set(set, all);
       put_varint(body, most / set.size());
       for (uint64_t i = 0; i < most / set.size(); ++i) {
         body.insert(body.end(), set.begin(), set.end());
         body.back() = static_cast<uint8_t>(i % 127);  // the last label differs
       }
       const Bytes rest = {1, 0, 0, 0};
       body.insert(body.end(), rest.begin(), rest.end());
       return single(metadata({4, 4, 4}, 4, 4, 1, 120'000), body, ratio);
     }},
    {"patterns that no ray has",
     [](uint64_t most, uint64_t ratio) {
       Bytes body = single_labels(2), patterns;
       const uint64_t length = most / 1000;
       uint64_t count = 0;
       for (; patterns.size() + length < most; ++count) {
         put_varint(patterns, length - 1 - count % length);
         const Bytes p = repeated({0, 1}, (length - count % length) / 2);
         patterns.insert(patterns.end(), p.begin(), p.end());
         if ((length - count % length) % 2 != 0) patterns.push_back(0);
       }
       put_varint(body, count);
       body.insert(body.end(), patterns.begin(), patterns.end());
       body.push_back(0);
       body.resize(body.size() + 64 * (length - 1));  // too few or too many: both are decoded to the end first
       return single(metadata({256, 256, kFar}, 256, 1u << 31, 16), body, ratio);
     }},
    {"unions of labels that are all different, on a level that is derived",
     [](uint64_t most, uint64_t ratio) {
       // Four rays go round the labels at four paces.
       Bytes body = single_labels(1200);
       const uint64_t changes = most / 12;
       put_varint(body, 4);
       for (const uint32_t period : {1193u, 1187u, 1181u, 1171u}) {
         put_varint(body, changes);
         for (uint64_t i = 0; i <= changes; ++i) put_varint(body, i % period);
       }
       put_varint(body, 3);
       for (const int b : {1, 0, 0, 1, 2, 3}) body.push_back(static_cast<uint8_t>(b));
       body.resize(body.size() + 4 * changes);
       return single(metadata({2, 2, 1 << 26}, 4, 1u << 31, 16, 1200), body, ratio);
     }},
    {"frames that millions of chunks share",
     [](uint64_t most, uint64_t ratio) {
       Assembly file(metadata({4 * 16 * 120, 4 * 16 * 10, 128}, 4, 128, 16));
       return with_one_frame(file, squeezed(same_rays(single_labels(2), 2, 16, std::min<uint64_t>(127, most / 17)), ratio),
                             [](const ChunkKey&) { return true; });
     }},
    {"a frame of many changes that thousands of chunks share",
     [](uint64_t most, uint64_t ratio) {
       Assembly file(metadata({64 * 320, 64 * 160, 1 << 12}, 64, 1 << 12, 16));
       return with_one_frame(file, squeezed(same_rays(single_labels(2), 2, 4096, std::min<uint64_t>(4095, most / 4200)), ratio),
                             [](const ChunkKey&) { return true; });
     }},
    {"the same where statistics need the rays",
     [](uint64_t most, uint64_t ratio) {
       Assembly file(with_graded_x(metadata({64 * 30, 64 * 1000, 1 << 12}, 64, 1 << 12, 16)));
       return with_one_frame(file, squeezed(same_rays(single_labels(2), 2, 4096, std::min<uint64_t>(255, most / 4200)), ratio),
                             [](const ChunkKey&) { return true; });
     }},
    {"frames of 65,536 rays that thousands of chunks share",
     [](uint64_t, uint64_t ratio) {
       Assembly file(with_graded_x(metadata({256 * 6, 256 * 1000, 4}, 256, 4, 16)));
       return with_one_frame(file, squeezed(plain_rays(), ratio), [](const ChunkKey&) { return true; });
     }},
    {"as many frames as there is room for, each of its own, as long as any frame may be",
     [](uint64_t, uint64_t) {
       Assembly file(with_graded_x(metadata({64, 64 * 900, 1 << 12}, 64, 1 << 12, 16)));
       Bytes frame = squeezed(same_rays(single_labels(2), 2, 4096, 15));
       return file.finish([&](const ChunkKey& key) { return key.level == 0 ? file.chunk(frame, vague_stats()) : Assembly::uniform(); });
     }},
    {"as many frames as there is room for, each of its own, of 65,536 rays",
     [](uint64_t, uint64_t) {
       Assembly file(with_graded_x(metadata({256, 256 * 1000, 4}, 256, 4, 16)));
       const Bytes frame = squeezed(plain_rays());
       return file.finish([&](const ChunkKey& key) { return key.level == 0 ? file.chunk(frame, vague_stats()) : Assembly::uniform(); });
     }},
    {"millions of chunks of one set in pages of 16 x 16",
     [](uint64_t, uint64_t) {
       Assembly file(metadata({4 * 16 * 400, 4 * 16 * 4, 4}, 4, 4, 16));
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); });
     }},
    {"chunks of one set in as many pages of 64 x 64 as there is room for",
     [](uint64_t, uint64_t) {
       Assembly file(metadata({4 * 64 * 180, 4 * 64 * 4, 4}, 4, 4, 64));
       file.own_pages = true;
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); });
     }},
    {"chunks of one set in as many pages of 16 x 16 as there is room for",
     [](uint64_t, uint64_t) {
       Assembly file(metadata({4 * 16 * 200, 4 * 16 * 4, 4}, 4, 4, 16));
       file.own_pages = true;
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); });
     }},
    {"pages of statistics, side by side along the rays, under a derived level",
     [](uint64_t most, uint64_t) {
       Assembly file(metadata({64 * 16, 64 * 16, 8}, 64, 4, 16, 60'000));
       file.own_pages = true;
       std::vector<LabelStats> all;
       for (Label l = 0; l < std::min<uint64_t>(most >> 12, 25'000); ++l) all.push_back({l, 1, {0, 0, 0}, {1, 1, 1}});
       const ChunkEntry entry = file.chunk(squeezed(plain_rays()), all);
       return file.finish([&](const ChunkKey& key) { return key.level == 0 ? entry : Assembly::uniform(); }, "{}",
                          most < (1 << 26) ? 250 : ~uint64_t{0});
     }},
    {"pages of large sets, side by side along the rays, under a derived level",
     [](uint64_t most, uint64_t) {
       Assembly file(metadata({64 * 16, 64 * 16, 8}, 64, 4, 16, 100'000));
       std::vector<Label> all;
       for (Label l = 0; l < std::min<uint64_t>(most >> 9, 100'000); ++l) all.push_back(l);
       return file.finish([&](const ChunkKey& key) { return key.level == 2 ? Assembly::uniform(all) : Assembly::uniform(); }, "{}",
                          most < (1 << 26) ? 250 : ~uint64_t{0});
     }},
    {"4 MB of names that become longer in JSON, on 31 levels",
     [](uint64_t, uint64_t) {
       Assembly file(with_long_names(metadata({1, 1, kFar}, 64, 1u << 31, 16), "\x01"));
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); });
     }},
    {"4 MB of names of umlauts on 31 levels",
     [](uint64_t, uint64_t) {
       Assembly file(with_long_names(metadata({1, 1, kFar}, 64, 1u << 31, 16), "\xc3\xbc"));
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); });
     }},
    {"hundreds of thousands of labels and a set of all of them",
     [](uint64_t, uint64_t) {
       Assembly file(metadata({64, 64, 64}, 4, 4, 16, 200'000));
       std::vector<Label> all(200'000);
       for (Label l = 0; l < all.size(); ++l) all[l] = l;
       return file.finish([&](const ChunkKey& key) { return key.level < 4 ? Assembly::uniform() : Assembly::uniform(all); }, "{}", 250);
     }},
    {"as many planes as there is room for",
     [](uint64_t, uint64_t) {
       Metadata meta = metadata({1, 1, 1}, 64, 1u << 31, 16);
       std::vector<double> planes;
       for (int i = 0; i < 20'000; ++i) planes.push_back(i);
       meta.grid.axis[2] = Axis::graded(planes, 0.5);
       Assembly file(meta);
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); });
     }},
    {"a report of empty objects",
     [](uint64_t, uint64_t) {
       Assembly file(metadata({64, 64, 64}, 64, 64, 16));
       const Bytes text = repeated({'{', '}', ','}, 5'000'000);
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); }, '[' + std::string(text.begin(), text.end()) + "{}]");
     }},
    {"a report of long numbers",
     [](uint64_t, uint64_t) {
       Assembly file(metadata({64, 64, 64}, 64, 64, 16));
       std::string text = "[";
       while (text.size() < 15'000'000) text += "0." + std::string(990, '7') + "e-300,";
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); }, text + "0]");
     }},
    {"a report of short numbers with exponents",
     [](uint64_t, uint64_t) {
       Assembly file(metadata({64, 64, 64}, 64, 64, 16));
       const Bytes text = repeated({'1', 'e', '9', ','}, 3'900'000);
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); }, '[' + std::string(text.begin(), text.end()) + "0]");
     }},
    {"three axes whose sample points are checked one by one",
     [](uint64_t, uint64_t) {
       Metadata meta = metadata({1, 1, 1}, 256, 1u << 31, 16);
       for (int d = 0; d < 3; ++d) meta.grid.axis[d] = Axis::uniform(0, 1, int64_t{1} << 49, d == 2 ? 1 << 24 : 1 << 12, 0.5);
       Assembly file(meta);
       return file.finish([](const ChunkKey&) { return Assembly::uniform(); });
     }},
    {"columns of noise that stand upright in a slice",
     [](uint64_t most, uint64_t ratio) {
       Assembly file(metadata({4096, 1, 1 << 14}, 64, 1 << 14, 16, 200));
       const uint64_t changes = std::min<uint64_t>((1 << 14) - 1, most / 64 / 66);
       return file.finish([&](const ChunkKey& key) {
         if (key.level > 0) return Assembly::uniform();
         return file.chunk(squeezed(same_rays(single_labels(200), 130 + key.cu, 64, changes), ratio), vague_stats());
       });
     }},
};

// ---- random files -----------------------------------------------------------------------------------------------

template <class T>
const T& one_of(std::mt19937_64& random, const std::vector<T>& all) {
  return all[random() % all.size()];
}

// Small most of the time, and at times very large.
int64_t some_size(std::mt19937_64& random, int64_t most) {
  const int bits = random_int(random, 0, 5) == 0 ? 31 : random_int(random, 1, 12);
  return std::clamp<int64_t>(static_cast<int64_t>(random() % (uint64_t{1} << random_int(random, 0, bits))) + 1, 1, most);
}

// Rays that are sound, or nearly so.
Bytes some_body(std::mt19937_64& random, uint32_t labels, uint64_t rays, uint64_t length) {
  const auto sets = static_cast<uint32_t>(1 + random() % std::min<uint64_t>(labels, 300));
  const uint64_t most = (uint64_t{1} << random_int(random, 4, 24)) / (rays + 2);
  const uint64_t changes = std::min(length - 1, sets == 1 ? 0 : random() % (most + 1));
  Bytes body = same_rays(random() % 3 != 0 ? single_labels(sets) : pairs_of_labels(sets, std::max(labels, 40u)), sets, rays, changes);
  for (int edits = random_int(random, 0, 3) == 0 ? random_int(random, 1, 6) : 0; edits > 0; --edits) {
    const auto at = body.begin() + static_cast<ptrdiff_t>(random() % std::min<size_t>(body.size(), random() % 2 == 0 ? 64 : ~size_t{0}));
    switch (random_int(random, 0, 3)) {
      case 0: *at = static_cast<uint8_t>(random()); break;
      case 1: body.insert(at, random() % 1000, static_cast<uint8_t>(random())); break;
      case 2: body.erase(at); break;
      default: *at ^= static_cast<uint8_t>(1u << random() % 8);
    }
    if (body.empty()) body.push_back(0);
  }
  return body;
}

std::vector<Label> some_set(std::mt19937_64& random, uint32_t labels) {
  std::vector<Label> set;
  const auto step = static_cast<uint32_t>(1 + random() % labels);
  for (Label l = static_cast<Label>(random() % labels); l < labels; l += step) set.push_back(l);
  return set;
}

}  // namespace

size_t hand_made_files() { return 3 * std::size(kCases); }

std::string hand_made_name(size_t number) {
  return fmt::format("{}, {}", kCases[number / 3].name, number % 3 == 0 ? "beyond bounds" : number % 3 == 1 ? "large" : "small");
}

std::optional<ForgedFile> hand_made_file(size_t number) {
  // As large as a chunk's body may be at all; then as large as one of such a frame may be (FORMAT.md, "Bounds").
  const Case& c = kCases[number / 3];
  const uint64_t most[] = {(uint64_t{1} << 28) - 4096, 11'000'000, 1 << 16};
  ForgedFile file{hand_made_name(number), {}};
  try {
    file.bytes = c.make(most[number % 3], number % 3 == 0 ? ~uint64_t{0} : 250);
  } catch (const InputError&) {
    return std::nullopt;  // too long to be written
  }
  return file.bytes.size() <= kForgedBytes ? std::optional(file) : std::nullopt;
}

std::optional<ForgedFile> random_file(uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto rays = one_of<uint32_t>(random, {4, 4, 8, 64, 64, 256}), page = one_of<uint32_t>(random, {1, 2, 16, 16, 16, 16});
  const auto cells = static_cast<uint32_t>(4 * some_size(random, 1 << 29));
  Index3 n;
  for (int64_t& size : n) size = some_size(random, kFar);
  Metadata meta = metadata(n, rays, cells, page, static_cast<uint32_t>(some_size(random, 3000)));
  if (random_int(random, 0, 3) == 0) meta = with_materials(meta, static_cast<uint32_t>(some_size(random, 3000)), std::string(random() % 100, 'n'));
  if (random_int(random, 0, 3) == 0 && n[0] < 10'000) meta = with_graded_x(meta);
  meta.ray_axis = random_int(random, 0, 2);
  meta.units = one_of<std::string>(random, {"m", "mm", "parsec"});
  const auto labels = static_cast<uint32_t>(meta.labels.size());
  double index = 0;
  for (int level = 0; level < meta.grid.levels(); level += 2) index += 24.0 * static_cast<double>(LevelShape(meta, level).pages());
  if (index > 40'000) return std::nullopt;

  Assembly file(meta);
  const LevelShape s(meta, 0);
  std::vector<ChunkEntry> entries;
  Frames frames;  // of the entries; empty ones of those without
  for (int i = random_int(random, 1, 12); i > 0; --i) {
    if (random_int(random, 0, 3) == 0) {
      entries.push_back(Assembly::uniform(random() % 2 == 0 ? some_set(random, labels) : std::vector<Label>{0}));
      frames.emplace_back();
      continue;
    }
    const int level = random() % 3 == 0 ? 2 * random_int(random, 0, (meta.grid.levels() - 1) / 2) : 0;
    const LevelShape of(meta, level);
    std::vector<LabelStats> stats;
    for (const Label l : some_set(random, std::min(labels, 50u)))
      stats.push_back({l, random() % 1000, {0, 0, 0}, {of.rays_u(0), of.rays_v(0), static_cast<uint32_t>(random() % of.length(0)) + 1}});
    const Bytes body = some_body(random, labels, uint64_t{of.rays_u(0)} * of.rays_v(0), of.length(0));
    frames.push_back(squeezed(body, random() % 4 != 0 ? 250 : ~uint64_t{0}));
    entries.push_back(file.chunk(frames.back(), stats));
  }
  const uint64_t pace = random() % 5;
  const bool own = random() % 4 != 0;  // each chunk has a frame of its own, as long as there is room
  file.own_pages = own;
  size_t next = 0, room = 40'000 - static_cast<size_t>(index);
  ForgedFile out{fmt::format("random {}", seed), {}};
  out.bytes = file.finish([&](const ChunkKey& key) {
    const size_t i = (next++ / (pace * pace * 7 + 1)) % entries.size();
    ChunkEntry e = entries[i];
    if (own && e.size != 0) {
      if (room < e.size + 20) e = Assembly::uniform();
      else room -= e.size + 20, e = file.chunk(frames[i], e.stats);
    }
    if (key.level > 0) e.stats.clear();
    else if (e.size == 0) e.uniform.resize(1);
    return e;
  });
  return out.bytes.size() <= kForgedBytes ? std::optional(out) : std::nullopt;
}

}  // namespace teracell::testing

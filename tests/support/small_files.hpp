// Small sound files, and what must become of damaged and of hostile ones.
#pragma once
#include "store/read/slice.hpp"
#include "store/read/stats.hpp"
#include "store/whole/verify.hpp"
#include "tests/support/forged.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::testing {

using Levels = std::vector<std::vector<Mask>>;

// As a user would make one: one chunk per level, three materials, a report.
inline Bytes meshed_file() {
  const TempFolder folder;
  mesh_quietly(
      scene_of(folder,
               {{shapes::box({1, 1, 1}, {9, 7, 6})}, {shapes::tetrahedron({2, 2, 2}, {11, 3, 2}, {3, 8, 3}, {4, 4, 7}), oracle::Rule::kNonzero, 2}},
               unit_grid({12, 9, 8})),
      folder / "g.tcell", {.axis = 2, .threads = 1});
  return file_bytes(folder / "g.tcell");
}

// Many chunks, segments and pages on several levels.
inline Bytes chunked_file(int ray_axis = 1, const Index3& n = {5, 6, 9}) {
  std::mt19937_64 random(7);
  return stored_cells(with_tiny_chunks(metadata_of(unit_grid(n), ray_axis, 3)), random_cells(random, n, 3));
}

// With a channel that no reader knows: its frames stand between the chunks and the directories.
inline Bytes with_channel(const Bytes& file, Lies lies = {}) {
  lies.channels.push_back({"fractions", {encode_text("half"), encode_text("a quarter"), encode_text("all of it")}});
  return forge(file, lies);
}

inline void verify_quietly(const GridReader& reader, int threads = 1) {
  verify(reader, threads, [](double) {});
}

inline Levels read_everything(const GridReader& reader) {
  Levels all;
  for (int level = 0; level < reader.levels(); ++level) all.push_back(level_as_read(reader, level));
  return all;
}

// Damage: verify must object; what can still be read must be the undamaged cells.
inline void expect_noticed(const Bytes& damaged, const Levels& undamaged, const char* how, size_t where) {
  INFO(how << " " << where);
  bool refused = false;
  try {
    const GridReader reader = reader_of(damaged);
    try {
      verify_quietly(reader);
    } catch (const FormatError&) {
      refused = true;
    } catch (const IoError&) {
      refused = true;
    }
    bool same = true;
    for (size_t level = 0; level < undamaged.size(); ++level) {
      try {
        same &= level_as_read(reader, static_cast<int>(level)) == undamaged[level];
      } catch (const FormatError&) {
      } catch (const IoError&) {
      }
    }
    if (!same) FAIL("wrong cells");
  } catch (const FormatError&) {
    return;
  }
  if (!refused) FAIL("verify passes");
}

// A hostile file: any Error, or anything at all that is no crash.
inline void read_hostile(const Bytes& file) {
  try {
    const GridReader reader = reader_of(file);
    try {
      verify_quietly(reader);
    } catch (const Error&) {
    }
    for (int level = 0; level < std::min(reader.levels(), 8); ++level) {
      const Index3 n = reader.meta().grid.cells(level);
      try {
        for (int axis = 0; axis < 3; ++axis) {
          SliceView view = whole_slice(reader.meta(), axis, n[axis] / 2, level);
          view.u1 = std::min<int64_t>(view.u1, 20), view.v1 = std::min<int64_t>(view.v1, 20);
          for_each_row(reader, view, strongest_material(reader.meta()), true, 1, [](int64_t, std::span<const uint16_t>) {});
        }
      } catch (const Error&) {
      }
    }
    try {
      read_stats(reader, {{0, 0, 0}, {1, 1, 1}});
      reader.report();
    } catch (const Error&) {
    }
  } catch (const Error&) {
  }
}

inline void expect_verify_refuses(const Bytes& file, const std::string& because) {
  const GridReader reader = reader_of(file);
  REQUIRE_THROWS_AS(verify_quietly(reader), FormatError);
  REQUIRE_THROWS_WITH(verify_quietly(reader), Catch::Contains(because) && Catch::StartsWith("memory.tcell: "));
}

}  // namespace teracell::testing

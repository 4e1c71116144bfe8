// The store's readers over any bytes: an Error or sound cells, never anything else; and a file that verify passes can
// be read throughout, the same in every way.
//
// An input that starts like a .tcell file is taken as one. Checksums stop nearly all of its mutants, so the first byte
// of any other input selects a structure to hand it to, or edits of a sound file's plain bodies under right checksums.
#include <cstdlib>

#include <unistd.h>

#include <nlohmann/json.hpp>

#include "store/chunk_codec.hpp"
#include "store/info.hpp"
#include "store/metadata_json.hpp"
#include "store/query.hpp"
#include "store/slice.hpp"
#include "store/stats.hpp"
#include "store/verify.hpp"
#include "tests/support/forged.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

// Hostile metadata may describe grids that take hours to walk: no fault of the reader's.
bool affordable(const GridReader& reader) {
  double rays = 0, chunks = 0;
  for (const LevelInfo& l : reader.meta().levels()) {
    const LevelShape s = reader.shape(l.level);
    rays += double{1} * s.nu * s.nv * s.segments;
    chunks += double{1} * s.chunks_u * s.chunks_v * s.segments;
  }
  return rays < 1 << 18 && chunks < 1 << 10;
}

// Up to 8 cells a side at the lower corner, in the middle, at the upper corner and across it.
std::vector<Box> some_boxes(const Index3& n) {
  std::vector<Box> boxes(4);
  for (int d = 0; d < 3; ++d) {
    const int64_t size = std::min<int64_t>(n[d], 8), middle = (n[d] - size) / 2;
    boxes[0].hi[d] = size;
    boxes[1].lo[d] = middle, boxes[1].hi[d] = middle + size;
    boxes[2].lo[d] = n[d] - size, boxes[2].hi[d] = n[d];
    boxes[3].lo[d] = n[d] - 1, boxes[3].hi[d] = n[d] + 3;
  }
  return boxes;
}

void read_some(const GridReader& reader, int level) {
  const SetValue value = strongest_material(reader.meta());
  const Index3 n = reader.meta().grid.cells(level);
  for (const Box& box : some_boxes(n)) {
    const int64_t nx = box.hi[0] - box.lo[0], ny = box.hi[1] - box.lo[1], nz = box.hi[2] - box.lo[2];
    std::vector<uint16_t> cells(static_cast<size_t>(nx * ny * nz));
    read_box<uint16_t>(reader, level, box, value, 0, cells.data(), {1, nx, nx * ny});
    if (box.hi[0] > n[0]) continue;
    uint64_t covered = 0;
    for_each_run(reader, level, box, [&](const BoxRun& run) { covered += static_cast<uint64_t>(run.length); });
    if (covered != cells.size()) std::abort();
    if (level == 0) read_stats(reader, box);
    SliceView view{2, box.lo[2], level, box.lo[0], box.lo[1], box.hi[0], box.hi[1]};
    for_each_row(reader, view, value, true, 1, [&](int64_t v, std::span<const uint16_t> row) {
      if (!std::equal(row.begin(), row.end(), cells.begin() + (v - box.lo[1]) * nx)) std::abort();
    });
    view = {0, box.lo[0], level, box.lo[1], box.lo[2], box.hi[1], box.hi[2]};
    for_each_row(reader, view, value, false, 1, [](int64_t, std::span<const uint16_t>) {});
  }
  if (level != 0) return;
  for (int axis = 0; axis < 3; ++axis)
    if (n[axis] < 4096) read_column(reader, axis, 0, 0);
}

void read_file(const Bytes& bytes) {
  bool sound = false;
  try {
    const GridReader reader = reader_of(bytes);
    if (!affordable(reader)) return;
    try {
      verify(reader, 1, [](double) {});
      sound = true;
    } catch (const FormatError&) {
    }
    for (int level = 0; level < std::min(reader.levels(), 6); ++level) {
      try {
        read_some(reader, level);
      } catch (const FormatError&) {
        if (sound) std::abort();
      } catch (const IoError&) {
        if (sound) std::abort();
      }
    }
    if (!nlohmann::json::accept(info_json(reader))) std::abort();
  } catch (const FormatError&) {
    if (sound) std::abort();
  } catch (const IoError&) {
    if (sound) std::abort();
  }
}

// A sound file of many chunks, made once.
const Bytes& sound_file() {
  static const Bytes file = [] {
    std::mt19937_64 random(1);
    const auto axis = [](int64_t n) { return Axis::uniform(0, 1, 0, n, 0.5); };
    const auto path = std::filesystem::temp_directory_path() / ("store_fuzz." + std::to_string(::getpid()));
    store_cells(path, with_tiny_chunks(metadata_of({{axis(5), Axis::graded({0, 1, 2, 4}, 0.5), axis(9)}}, 2, 3)), random_cells(random, {5, 3, 9}, 3));
    const Bytes bytes = file_bytes(path);
    std::filesystem::remove(path);
    return bytes;
  }();
  return file;
}

// Edits of four bytes each: which body, where (14 bits), what to do there (2 bits), a byte to do it with.
Bytes edited_file(std::span<const uint8_t> edits) {
  uint32_t index = 0;
  return forge(sound_file(), {.bytes =
                                  [&](Part, Bytes& body) {
                                    for (size_t i = 0; i + 4 <= edits.size(); i += 4) {
                                      if (edits[i] != index % 256 || body.empty()) continue;
                                      const size_t at = (edits[i + 1] | edits[i + 2] << 8) % (1 << 14) % body.size();
                                      switch (edits[i + 2] >> 6) {
                                        case 0: body[at] = edits[i + 3]; break;
                                        case 1: body[at] ^= edits[i + 3]; break;
                                        case 2: body.resize(at); break;
                                        default: body.insert(body.begin() + static_cast<ptrdiff_t>(at), edits[i + 3]);
                                      }
                                    }
                                    ++index;
                                  },
                              .channels = {{"unknown", {encode_text("one frame"), encode_text("and another")}}}});
}

Bytes signed_again(std::span<const uint8_t> input, size_t covered, const Bytes& behind) {
  Bytes bytes(input.begin(), input.end());
  bytes.resize(covered);
  put_fixed(bytes, checksum(bytes));
  bytes.insert(bytes.end(), behind.begin(), behind.end());
  return bytes;
}

void decode_chunk(std::span<const uint8_t> shape, const Bytes& frame) {
  const uint32_t nu = shape[0] % 16 + 1, nv = shape[1] % 16 + 1, length = (shape[2] | shape[3] << 8) + 1, labels = shape[4] + 1;
  ChunkDecoder decoder;
  Chunk out;
  decoder.decode(frame, nu, nv, length, labels, out);
  if (!broken_invariant(out, nu, nv, length, labels).empty()) std::abort();
  Chunk again;
  decoder.decode(ChunkEncoder().encode(out.rays, out.sets), nu, nv, length, labels, again);
  if (!same_runs(out, again)) std::abort();
}

void decode_structure(uint8_t which, std::span<const uint8_t> input) {
  const Bytes raw(input.begin(), input.end());
  const std::string text(input.begin(), input.end());
  switch (which % 8) {
    case 0: return read_file(edited_file(input));
    case 1: return input.size() < 5 ? void() : decode_chunk(input, Bytes(raw.begin() + 5, raw.end()));
    case 2: return input.size() < 5 ? void() : decode_chunk(input, encode_text(text.substr(5)));
    case 3: decode_page(encode_text(text), 1 + input.size() % 5, input.size() % 2 == 0, 4); return;
    case 4: decode_page(raw, 4, true, 4); return;
    case 5: {
      const Metadata meta = decode_metadata(encode_text(text));
      if (!(decode_metadata(encode_metadata(meta)) == meta)) std::abort();
      return;
    }
    case 6: decode_footer(signed_again(input, kFooterBytes - 16, {'t', 'c', 'e', 'l', 'l', 'e', 'n', 'd'})); return;
    default: check_header(signed_again(input, kHeaderBytes - 8, {})); decode_directory_block(signed_again(input, input.size(), {}));
  }
}

}  // namespace
}  // namespace teracell

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace teracell;
  if (size == 0) return 0;
  try {
    if (data[0] == 0x5E) read_file({data, data + size});
    else decode_structure(data[0], {data + 1, size - 1});
  } catch (const FormatError&) {
  }
  return 0;
}

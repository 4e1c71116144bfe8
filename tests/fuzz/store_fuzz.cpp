// The store's readers over any bytes: an Error or sound cells, never anything else; and a file that verify passes can
// be read throughout, the same in every way.
//
// An input that starts like a .tcell file is taken as one. Checksums stop nearly all of its mutants, so the first byte
// of any other input selects a structure to hand it to, or edits of a sound file's plain bodies under right checksums.
#include <cstdlib>

#include "store/format/metadata_json.hpp"
#include "store/runs/chunk_codec.hpp"
#include "tests/fuzz/read_file.hpp"
#include "tests/support/forged.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

// A sound file of many chunks, made once.
const Bytes& sound_file() {
  static const Bytes file = [] {
    std::mt19937_64 random(1);
    Grid grid = unit_grid({5, 3, 9});
    grid.axis[1] = Axis::graded({0, 1, 2, 4}, 0.5);
    return stored_cells(with_tiny_chunks(metadata_of(grid, 2, 3)), random_cells(random, {5, 3, 9}, 3));
  }();
  return file;
}

// Edits of four bytes each: which body, where (14 bits), what to do there (2 bits), a byte to do it with.
Bytes edited_file(std::span<const uint8_t> edits) {
  uint32_t index = 0;
  return forge(sound_file(), {.bytes =
                                  [&](FilePart, Bytes& body) {
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

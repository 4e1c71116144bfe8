// A block of rays <-> bytes (FORMAT.md, "Chunk"). Pure: no I/O.
//
// A crossing costs about one bit. Rays are stored as patterns and changes (run.hpp). The pattern of a ray is predicted
// from its left and upper neighbours, and only exceptions are written. A change is predicted by the plane through the same
// change of the left, upper and upper left rays. On a smooth surface the residual is -1, 0 or 1. Five of them that lie side by side on one
// surface make a byte, so zstd's entropy stage sees how residuals follow each other and has a fifth of the bytes to do: 0.99 bits per crossing
// of a bust in 10^12 cells, where a byte each took 1.51, and less time for both directions. The order matters: bytes of several surfaces' residuals
// in turn took 1.13. Tried and rejected: predicting from ten neighbours (2 %), lines where there is no plane (1 %), byte planes (no gain on data of
// this kind), one varint stream for all residuals (the wide ones spoil the Huffman table of the narrow ones).
#pragma once
#include <memory>
#include <span>

#include "store/base/bytes.hpp"
#include "store/runs/run.hpp"

namespace teracell::inline store {

// Bounds of the format. A hostile chunk can't ask for more memory than a sound one.
inline constexpr uint64_t kMaxChunkRays = 1 << 16;
inline constexpr uint64_t kMaxChunkBytes = uint64_t{1} << 28;    // of the body before compression
inline constexpr uint64_t kMaxChunkChanges = uint64_t{1} << 28;
inline constexpr uint64_t kChunkBytesOfAnyFrame = 1 << 16;  // of that, however small the frame is (zstd_frame.hpp, BodyBound)

// Keeps scratch memory between calls: each thread has its own.
class ChunkEncoder {
 public:
  ChunkEncoder();
  ~ChunkEncoder();
  // The chunk's zstd frame. Throws InputError when the block is too complex for one chunk (kMaxChunkBytes, kMaxChunkChanges).
  Bytes encode(const RayBlock& block, const SetTable& sets);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> s_;
};

// Keeps scratch memory between calls: each thread has its own.
class ChunkDecoder {
 public:
  ChunkDecoder();
  ~ChunkDecoder();
  // Throws FormatError unless `frame` is a valid chunk of nu x nv rays of `length` cells with labels below `labels`.
  void decode(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, Chunk& out);

 private:
  struct Scratch;
  std::unique_ptr<Scratch> s_;
};

}  // namespace teracell::store

#include "server/picture/run_deflate.hpp"

#include <algorithm>
#include <bit>

namespace teracell::server {
namespace {

constexpr size_t kPiece = 1 << 16;
constexpr uint32_t kEnd = 256, kSymbols = 286;  // of the code for literals and lengths

// The lengths of Huffman codes, at most `limit` bits, for symbols that occur `counts` times; 0 for symbols that don't occur.
// REQUIRES: at least two symbols occur.
template <size_t N>
std::array<uint8_t, N> code_lengths(const std::array<uint32_t, N>& counts, uint32_t limit) {
  std::array<uint64_t, N> leaves;  // count and symbol, the rarest first
  uint32_t n = 0;
  for (uint32_t s = 0; s < N; ++s)
    if (counts[s] > 0) leaves[n++] = uint64_t{counts[s]} << 32 | s;
  std::ranges::sort(std::span(leaves).first(n));
  std::array<uint32_t, 2 * N> weight, parent, depth;
  for (uint32_t i = 0; i < n; ++i) weight[i] = static_cast<uint32_t>(leaves[i] >> 32);
  for (;;) {
    // Leaves ascend, and so do the inner nodes as they are made. So the two least are at the heads of two queues.
    uint32_t leaf = 0, inner = n;
    for (uint32_t node = n; node < 2 * n - 1; ++node) {
      weight[node] = 0;
      for (int child = 0; child < 2; ++child) {
        const uint32_t least = leaf < n && (inner == node || weight[leaf] <= weight[inner]) ? leaf++ : inner++;
        weight[node] += weight[least];
        parent[least] = node;
      }
    }
    uint32_t deepest = 0;
    depth[2 * n - 2] = 0;
    for (uint32_t i = 2 * n - 2; i-- > 0;) depth[i] = depth[parent[i]] + 1, deepest = std::max(deepest, depth[i]);
    if (deepest <= limit) break;
    for (uint32_t i = 0; i < n; ++i) weight[i] = (weight[i] + 1) / 2;  // a flatter tree, with the symbols in the same order
  }
  std::array<uint8_t, N> lengths{};
  for (uint32_t i = 0; i < n; ++i) lengths[static_cast<uint32_t>(leaves[i])] = static_cast<uint8_t>(depth[i]);
  return lengths;
}

// The codes with these lengths (RFC 1951, 3.2.2). The first bit of a code is the lowest one, as it is written.
template <size_t N>
std::array<uint16_t, N> codes_of(const std::array<uint8_t, N>& lengths) {
  std::array<uint32_t, 16> count{}, next{};
  for (const uint8_t l : lengths) ++count[l];
  count[0] = 0;
  for (uint32_t l = 1; l < 16; ++l) next[l] = (next[l - 1] + count[l - 1]) << 1;
  std::array<uint16_t, N> codes{};
  for (size_t s = 0; s < N; ++s) {
    uint32_t code = lengths[s] ? next[lengths[s]]++ : 0;
    for (uint32_t i = 0; i < lengths[s]; ++i, code >>= 1) codes[s] = static_cast<uint16_t>(codes[s] << 1 | (code & 1));
  }
  return codes;
}

// A match length as a symbol and extra bits. The index is the length minus 3.
struct Length {
  uint16_t symbol;
  uint8_t bits, extra;
};
constexpr std::array<Length, 256> kLengths = [] {
  std::array<Length, 256> all{};
  for (uint32_t n = 0; n < 255; ++n) {
    const uint32_t bits = n < 8 ? 0 : static_cast<uint32_t>(std::bit_width(n)) - 3;
    all[n] = {static_cast<uint16_t>(257 + 4 * bits + (n >> bits)), static_cast<uint8_t>(bits), static_cast<uint8_t>(n & ((1u << bits) - 1))};
  }
  all[255] = {285, 0, 0};
  return all;
}();

}  // namespace

RunDeflate::Distance::Distance(uint32_t distance) {
  const uint32_t n = distance - 1;
  bits = n < 4 ? 0 : static_cast<uint32_t>(std::bit_width(n)) - 2;
  symbol = 2 * bits + (n >> bits);
  extra = n & ((1u << bits) - 1);
}

RunDeflate::RunDeflate(uint32_t near, uint32_t far, Sink sink)
    : distance_{Distance(near), Distance(far)}, sink_(std::move(sink)), tokens_(new uint16_t[kBlock]), out_{0x78, 0x01} {}

void RunDeflate::match(Back back, uint64_t length) {
  constexpr uint64_t kMost = 258;
  const uint32_t base = 256 * (1 + back);
  while (length > kMost) {
    const uint64_t take = length - kMost < kLeastMatch ? length - kLeastMatch : kMost;  // the rest must be long enough for a match
    put(base + static_cast<uint32_t>(take - kLeastMatch));
    length -= take;
  }
  put(base + static_cast<uint32_t>(length - kLeastMatch));
}

void RunDeflate::put_bits(uint64_t value, uint32_t count) {
  bits_ |= value << pending_;
  for (pending_ += count; pending_ >= 8; pending_ -= 8, bits_ >>= 8) out_.push_back(static_cast<uint8_t>(bits_));
}

// The head of a block: the lengths of both codes, run-length encoded and written with a third code (RFC 1951, 3.2.7).
void RunDeflate::put_codes(std::span<const uint8_t> literals) {
  const uint32_t distances = distance_[kFar].symbol + 1;
  Bytes lengths(literals.begin(), literals.end());
  lengths.resize(literals.size() + distances);
  for (const Distance& d : distance_) lengths[literals.size() + d.symbol] = 1;

  struct Item {
    uint8_t symbol, bits, extra;
  };
  std::vector<Item> items;
  std::array<uint32_t, 19> counts{};
  const auto add = [&](size_t symbol, uint8_t bits, size_t extra) {
    items.push_back({static_cast<uint8_t>(symbol), bits, static_cast<uint8_t>(extra)});
    ++counts[symbol];
  };
  for (size_t i = 0; i < lengths.size();) {
    size_t end = i + 1;
    while (end < lengths.size() && lengths[end] == lengths[i]) ++end;
    if (lengths[i] != 0) add(lengths[i++], 0, 0);  // 16 repeats the one before
    while (end - i >= 3) {
      const size_t take = std::min<size_t>(end - i, lengths[i] != 0 ? 6 : 138);
      if (lengths[i] != 0) add(16, 2, take - 3);
      else if (take <= 10) add(17, 3, take - 3);
      else add(18, 7, take - 11);
      i += take;
    }
    while (i < end) add(lengths[i++], 0, 0);
  }

  constexpr uint8_t kOrder[] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  const auto item_lengths = code_lengths(counts, 7);
  const auto item_codes = codes_of(item_lengths);
  uint32_t listed = 19;
  while (listed > 4 && item_lengths[kOrder[listed - 1]] == 0) --listed;
  put_bits(literals.size() - 257, 5);
  put_bits(distances - 1, 5);
  put_bits(listed - 4, 4);
  for (uint32_t i = 0; i < listed; ++i) put_bits(item_lengths[kOrder[i]], 3);
  for (const Item& item : items) {
    put_bits(item_codes[item.symbol], item_lengths[item.symbol]);
    put_bits(item.extra, item.bits);
  }
}

void RunDeflate::write_block(bool last) {
  const std::span<const uint16_t> tokens(tokens_.get(), filled_);
  std::array<uint32_t, kTokens> times{};
  for (const uint16_t t : tokens) ++times[t];
  std::array<uint32_t, kSymbols> counts{};
  std::copy_n(times.begin(), 256, counts.begin());
  counts[kEnd] = 1;
  for (uint32_t i = 0; i < 256; ++i) counts[kLengths[i].symbol] += times[256 + i] + times[512 + i];
  const auto lengths = code_lengths(counts, 15);
  const auto codes = codes_of(lengths);
  uint32_t used = kSymbols;
  while (lengths[used - 1] == 0) --used;

  put_bits(last, 1);
  put_bits(2, 2);
  put_codes({lengths.data(), used});

  // All bits of each token: its code, the length's extra bits, the distance's code (0 is the near one), the distance's extra bits.
  // At most 34.
  std::array<uint64_t, kTokens> value;
  std::array<uint8_t, kTokens> size;
  uint64_t total = 0;
  for (uint32_t t = 0; t < kTokens; ++t) {
    if (times[t] == 0) continue;
    const uint32_t symbol = t < 256 ? t : kLengths[t % 256].symbol;
    uint64_t v = codes[symbol];
    uint32_t n = lengths[symbol];
    if (t >= 256) {
      const uint32_t back = t / 256 - 1;
      const Distance& d = distance_[back];
      v |= uint64_t{kLengths[t % 256].extra} << n, n += kLengths[t % 256].bits;
      v |= uint64_t{back} << n, ++n;
      v |= uint64_t{d.extra} << n, n += d.bits;
    }
    value[t] = v;
    size[t] = static_cast<uint8_t>(n);
    total += uint64_t{n} * times[t];
  }
  const size_t before = out_.size();
  out_.resize(before + total / 8 + 16);
  uint8_t* out = out_.data() + before;
  uint64_t bits = bits_;
  uint32_t pending = pending_;
  for (const uint16_t t : tokens) {
    bits |= value[t] << pending;
    pending += size[t];
    for (int i = 0; i < 8; ++i) out[i] = static_cast<uint8_t>(bits >> (8 * i));
    out += pending / 8;
    bits >>= pending & ~7u;
    pending %= 8;
  }
  out_.resize(static_cast<size_t>(out - out_.data()));
  bits_ = bits, pending_ = pending;
  put_bits(codes[kEnd], lengths[kEnd]);
  filled_ = 0;
  if (out_.size() >= kPiece && !last) {
    sink_(out_);
    out_.clear();
  }
}

void RunDeflate::finish(uint32_t adler) {
  write_block(true);
  put_bits(0, 7);  // fills the last byte
  for (int shift = 24; shift >= 0; shift -= 8) out_.push_back(static_cast<uint8_t>(adler >> shift));
  sink_(out_);
}

}  // namespace teracell::server

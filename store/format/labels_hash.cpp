#include "store/format/labels_hash.hpp"

#include <algorithm>
#include <bit>

#include "store/base/bytes.hpp"
#include "store/format/format.hpp"

namespace teracell::inline store {
namespace {

using Product = unsigned __int128;

constexpr uint64_t kPrime = (uint64_t{1} << 61) - 1;
constexpr std::array<uint64_t, 3> kBases = {314159265358979323, 271828182845904523, 141421356237309504};  // x, y, z: digits of pi, e and sqrt(2)
constexpr int kLowBits = 18;

constexpr uint64_t reduced(uint64_t n) { return n >= kPrime ? n - kPrime : n; }
constexpr uint64_t reduced(Product n) {
  const uint64_t once = (static_cast<uint64_t>(n) & kPrime) + static_cast<uint64_t>(n >> 61 & kPrime) + static_cast<uint64_t>(n >> 122);
  return reduced((once & kPrime) + (once >> 61));
}
constexpr uint64_t plus(uint64_t a, uint64_t b) { return reduced(a + b); }
constexpr uint64_t minus(uint64_t a, uint64_t b) { return a >= b ? a - b : a + kPrime - b; }
constexpr uint64_t times(uint64_t a, uint64_t b) { return reduced(Product{a} * b); }
constexpr uint64_t inverse(uint64_t a) {  // a^(p - 2), by Fermat
  uint64_t out = 1;
  for (uint64_t exponent = kPrime - 2; exponent > 0; exponent >>= 1, a = times(a, a))
    if (exponent & 1) out = times(out, a);
  return out;
}

// The same modulo p, below 2^68.
constexpr Product folded(Product n) { return (n & kPrime) + (n >> 61); }

// The sum over i of factors[i] * powers[x[n * i]] for `count` numbers, below 2^68. A sum of 32 products, which are below 2^122 each, and of what
// folded() left fits into 128 bits. Two sums take turns, since each addition waits for the carry of the one before.
Product sum_of_products(const uint64_t* factors, const uint64_t* powers, const uint32_t* x, size_t n, uint32_t count) {
  constexpr uint32_t kMost = 64;
  Product even = 0, odd = 0;
  for (uint32_t i = 0; i < count;) {
    even = folded(even), odd = folded(odd);
    const uint32_t end = std::min(count, i + kMost);
    for (; i + 1 < end; i += 2, x += 2 * n) {
      even += Product{factors[i]} * powers[x[0]];
      odd += Product{factors[i + 1]} * powers[x[n]];
    }
    if (i < end) even += Product{factors[i++]} * powers[*x], x += n;
  }
  return folded(even) + folded(odd);
}

std::vector<uint64_t> powers_of(uint64_t base, size_t count) {
  std::vector<uint64_t> out(count, 1);
  for (size_t i = 1; i < count; ++i) out[i] = times(out[i - 1], base);
  return out;
}

uint64_t key_of(const Metadata& meta, const LabelInfo& label) {
  const std::string name = meta.materials[label.material].name + '\0' + label.body;
  return checksum({reinterpret_cast<const uint8_t*>(name.data()), name.size()}) % kPrime;
}

}  // namespace

LabelsSum& LabelsSum::operator+=(LabelsSum other) {
  value = plus(value, other.value);
  return *this;
}

LabelsAdder::LabelsAdder(const Metadata& meta) : chunk_rays_(meta.chunk_rays), chunk_cells_(meta.chunk_cells) {
  const RayFrame f = meta.frame();
  for (size_t i = 0; const int axis : {f.u, f.v, f.w}) {
    const uint64_t base = kBases[static_cast<size_t>(axis)];
    const auto exponents = static_cast<uint64_t>(meta.grid.axis[axis].cells()) + 1;
    Powers& p = powers_[i++];
    p.low = powers_of(base, std::min(exponents, uint64_t{1} << kLowBits));
    p.high = powers_of(times(p.low.back(), base), (exponents >> kLowBits) + 1);
    p.of_sums = inverse(base - 1);
  }
  for (const LabelInfo& label : meta.labels) keys_.push_back(key_of(meta, label));
}

uint64_t LabelsAdder::Powers::at(int64_t exponent) const {
  const auto e = static_cast<uint64_t>(exponent);
  return e < low.size() ? low[e] : times(low[e % low.size()], high[e >> kLowBits]);
}

uint64_t LabelsAdder::Powers::sum(int64_t from, int64_t to) const { return times(minus(at(to), at(from)), of_sums); }

namespace {

// Rays [u, stop) of a row that have one pattern, and what the ends of their runs add.
struct Stretch {
  uint32_t pattern = 0, u = 0, stop = 0;
  uint64_t ends = 0;
};

}  // namespace

// The run of key k from `from` to `to` along a ray adds k (g^to - g^from) / (g - 1) times the ray's own powers. So the change from k to k' at x
// adds (k - k') g^x, and the ends of the ray the rest.
LabelsSum LabelsAdder::sum(const Index3& first, const RayBlock& b) const {
  const auto& [along_u, along_v, along_w] = powers_;
  if (b.uniform()) {  // most of a large grid
    const uint64_t area = times(along_u.sum(first[0], first[0] + b.nu), along_v.sum(first[1], first[1] + b.nv));
    return {times(keys_[b.patterns.sets(0)[0]], times(area, along_w.sum(first[2], first[2] + b.length)))};
  }
  const auto from_w = static_cast<uint64_t>(first[2]);
  const uint64_t begin = along_w.at(first[2]), end = along_w.at(first[2] + b.length);
  const bool small = from_w + b.length <= along_w.low.size();
  std::vector<uint64_t> of_u(b.nu);
  for (uint32_t u = 0; u < b.nu; ++u) of_u[u] = along_u.at(first[0] + u);
  Stretch last;  // mostly, one row has the same stretches as the one before
  uint64_t total = 0;
  for (uint32_t v = 0; v < b.nv; ++v) {
    Product row = 0;
    const uint32_t* pattern = b.pattern.data() + size_t{v} * b.nu;
    for (uint32_t u = 0; u < b.nu;) {  // a stretch of one pattern
      const uint32_t n = b.patterns.changes(pattern[u]);
      uint32_t stop = u + 1;
      while (stop < b.nu && pattern[stop] == pattern[u]) ++stop;
      const auto sets = b.patterns.sets(pattern[u]);
      const uint32_t* at = b.at.data() + b.begin[size_t{v} * b.nu + u];
      for (uint32_t i = 0; i < n; ++i) {
        Product products = 0;
        if (small) products = sum_of_products(of_u.data() + u, along_w.low.data() + from_w, at + i, n, stop - u);
        else
          for (uint32_t ray = u; ray < stop; ++ray)
            products = folded(products + Product{of_u[ray]} * along_w.at(static_cast<int64_t>(from_w + at[(ray - u) * n + i])));
        row = folded(row + Product{minus(keys_[sets[i]], keys_[sets[i + 1]])} * reduced(products));
      }
      if (last.pattern != pattern[u] || last.u != u || last.stop != stop) {
        const uint64_t ends = minus(times(keys_[sets[n]], end), times(keys_[sets[0]], begin));
        last = {pattern[u], u, stop, times(ends, along_u.sum(first[0] + u, first[0] + stop))};
      }
      row += last.ends;
      u = stop;
    }
    total = plus(total, times(reduced(row), along_v.at(first[1] + v)));
  }
  return {times(total, along_w.of_sums)};
}

LabelsSum LabelsAdder::sum(const ChunkKey& key, const RayBlock& rays) const {
  return sum(Index3{int64_t{key.cu} * chunk_rays_, int64_t{key.cv} * chunk_rays_, int64_t{key.segment} * chunk_cells_}, rays);
}

std::string labels_hash(const Metadata& meta, LabelsSum sum) {
  Bytes text;
  const auto put = [&](double d) { put_fixed(text, std::bit_cast<uint64_t>(d)); };
  for (const Axis& axis : meta.grid.axis) {
    put_fixed(text, static_cast<uint64_t>(axis.cells()));
    if (axis.is_graded()) {
      for (const double plane : axis.planes()) put(plane);
    } else {
      put_fixed(text, static_cast<uint64_t>(axis.first()));
      put(axis.origin()), put(axis.step());
    }
  }
  put_fixed(text, sum.value);
  ContentHash hash;
  hash.add(text);
  return hex(hash.digest());
}

}  // namespace teracell::store

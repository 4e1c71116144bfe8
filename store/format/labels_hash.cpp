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
constexpr int kLowBits = 16;
constexpr uint32_t kMostProducts = 32;  // below 2^122 each, so that many add up without overflow

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
  const bool small = from_w + b.length < along_w.low.size();
  std::vector<uint64_t> of_u(b.nu);
  for (uint32_t u = 0; u < b.nu; ++u) of_u[u] = along_u.at(first[0] + u);
  uint64_t total = 0;
  for (uint32_t v = 0; v < b.nv; ++v) {
    uint64_t row = 0;
    const uint32_t* pattern = b.pattern.data() + size_t{v} * b.nu;
    for (uint32_t u = 0; u < b.nu;) {  // a stretch of one pattern
      const uint32_t n = b.patterns.changes(pattern[u]);
      uint32_t stop = u + 1;
      while (stop < b.nu && pattern[stop] == pattern[u]) ++stop;
      const auto sets = b.patterns.sets(pattern[u]);
      const uint32_t* at = b.at.data() + b.begin[size_t{v} * b.nu + u];
      for (uint32_t i = 0; i < n; ++i) {
        Product products = 0;
        const uint32_t* x = at + i;
        for (uint32_t ray = u; ray < stop;) {
          const uint32_t some = std::min(stop, ray + kMostProducts);
          products = reduced(products);
          if (small)
            for (const uint64_t* low = along_w.low.data() + from_w; ray < some; ++ray, x += n) products += Product{of_u[ray]} * low[*x];
          else
            for (; ray < some; ++ray, x += n) products += Product{of_u[ray]} * along_w.at(static_cast<int64_t>(from_w + *x));
        }
        row = plus(row, times(minus(keys_[sets[i]], keys_[sets[i + 1]]), reduced(products)));
      }
      const uint64_t ends = minus(times(keys_[sets[n]], end), times(keys_[sets[0]], begin));
      row = plus(row, times(ends, along_u.sum(first[0] + u, first[0] + stop)));
      u = stop;
    }
    total = plus(total, times(row, along_v.at(first[1] + v)));
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

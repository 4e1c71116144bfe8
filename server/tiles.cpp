#include "server/tiles.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "server/picture.hpp"
#include "server/tile_png.hpp"
#include "store/error.hpp"

namespace teracell {
namespace {

// Numbers for the sets of a picture, in the order in which they turn up. Not thread-safe.
class SetNumbers {
 public:
  explicit SetNumbers(const Metadata& meta) : meta_(meta) {}
  SetValue value() {
    return [this](const std::vector<Label>& set) { return number(set); };
  }
  // Material ids of each set, ascending.
  const std::vector<std::vector<uint32_t>>& sets() const { return sets_; }

 private:
  uint32_t number(const std::vector<Label>& labels) {
    std::vector<uint32_t> materials;
    for (const Label label : labels) materials.push_back(meta_.labels[label].material);
    std::ranges::sort(materials);
    materials.erase(std::unique(materials.begin(), materials.end()), materials.end());
    const auto [it, fresh] = numbers_.try_emplace(materials, static_cast<uint32_t>(sets_.size()));
    if (fresh) {
      if (sets_.size() == 65535) throw Error("the picture has more than 65535 different sets of materials: ask for a smaller part of it");
      sets_.push_back(materials);
    }
    return it->second;
  }
  const Metadata& meta_;
  std::map<std::vector<uint32_t>, uint32_t> numbers_;
  std::vector<std::vector<uint32_t>> sets_;
};

Rgba color_of(const std::vector<uint32_t>& materials, const Metadata& meta, const Look& look) {
  std::vector<Rgba> members;
  for (const uint32_t m : materials)
    if (look.shown.empty() || look.shown[m]) members.push_back(parse_color(meta.materials[m].color).value());
  return members.empty() ? Rgba{0, 0, 0, 0} : blend(members);
}

constexpr Rgba kOutline = {24, 24, 24, 255};

// The numbers of the sets of a view, its highest v first.
std::vector<uint16_t> numbers_of(const GridReader& reader, const SliceView& view, SetNumbers& sets) {
  std::vector<uint16_t> out;
  out.reserve(static_cast<size_t>((view.u1 - view.u0) * (view.v1 - view.v0)));
  for_each_row(reader, view, sets.value(), true, 1, [&](int64_t, std::span<const uint16_t> row) { out.insert(out.end(), row.begin(), row.end()); });
  return out;
}

// Gives the cells of `view` that differ from the one above or on the right the number `outline`. The view is looked at
// with a margin of one cell there, so that neighbouring pictures fit together.
std::vector<uint16_t> outlined(const GridReader& reader, const SliceView& view, SetNumbers& sets, std::vector<uint16_t> numbers, uint16_t& outline) {
  SliceView wider = view;
  const Index3 n = reader.meta().grid.cells(view.level);
  const Frame f = Frame::along(view.axis);
  wider.u1 = std::min(n[f.u], view.u1 + 1);
  wider.v1 = std::min(n[f.v], view.v1 + 1);
  const std::vector<uint16_t> all = numbers_of(reader, wider, sets);
  outline = static_cast<uint16_t>(sets.sets().size());
  const auto width = static_cast<size_t>(view.u1 - view.u0), wide = static_cast<size_t>(wider.u1 - wider.u0);
  const auto top = static_cast<size_t>(wider.v1 - view.v1);  // rows of margin
  for (size_t r = 0; r < static_cast<size_t>(view.v1 - view.v0); ++r)
    for (size_t c = 0; c < width; ++c) {
      const uint16_t here = all[(r + top) * wide + c];
      const bool right = c + 1 < wide && all[(r + top) * wide + c + 1] != here;
      const bool above = r + top > 0 && all[(r + top - 1) * wide + c] != here;
      if (right || above) numbers[r * width + c] = outline;
    }
  return numbers;
}

void put16(std::string& out, uint32_t v) {
  out += static_cast<char>(v);
  out += static_cast<char>(v >> 8);
}

// Row by row: a picture larger than this is never in memory as numbers.
constexpr int64_t kMostInMemory = int64_t{1} << 22;

std::string streamed_png(const GridReader& reader, const SliceView& view, const Look& look) {
  if (look.outline) throw UsageError(fmt::format("outline: expected a picture of at most {} pixels: ask for a part of it, or for a coarser level", kMostInMemory));
  std::string out;
  SetColors colors(reader.meta(), view.level, look.shown);
  PngWriter png(static_cast<uint32_t>(view.u1 - view.u0), static_cast<uint32_t>(view.v1 - view.v0), colors,
                [&](std::span<const uint8_t> bytes) { out.append(bytes.begin(), bytes.end()); });
  for_each_row(reader, view, colors.value(), true, 1, [&](int64_t, std::span<const uint16_t> row) { png.row(row); });
  png.finish();
  return out;
}

}  // namespace

std::string picture_png(const GridReader& reader, const SliceView& view, const Look& look) {
  if ((view.u1 - view.u0) * (view.v1 - view.v0) > kMostInMemory) return streamed_png(reader, view, look);
  SetNumbers sets(reader.meta());
  std::vector<uint16_t> numbers = numbers_of(reader, view, sets);
  uint16_t outline = 0;
  if (look.outline) numbers = outlined(reader, view, sets, std::move(numbers), outline);
  std::vector<Rgba> colors;
  for (const auto& set : sets.sets()) colors.push_back(color_of(set, reader.meta(), look));
  if (look.outline) colors.push_back(kOutline);
  return encode_png(static_cast<uint32_t>(view.u1 - view.u0), static_cast<uint32_t>(view.v1 - view.v0), numbers, colors);
}

std::string raw_labels(const GridReader& reader, const SliceView& view) {
  const bool wide = reader.meta().materials.size() > 256;
  std::string out;
  out.reserve(static_cast<size_t>((view.u1 - view.u0) * (view.v1 - view.v0)) * (wide ? 2 : 1));
  for_each_row(reader, view, strongest_material(reader.meta()), false, 1, [&](int64_t, std::span<const uint16_t> row) {
    for (const uint16_t id : row) {
      out += static_cast<char>(id);
      if (wide) out += static_cast<char>(id >> 8);
    }
  });
  return out;
}

std::string raw_sets(const GridReader& reader, const SliceView& view) {
  SetNumbers sets(reader.meta());
  std::vector<uint16_t> numbers;
  for_each_row(reader, view, sets.value(), false, 1, [&](int64_t, std::span<const uint16_t> row) { numbers.insert(numbers.end(), row.begin(), row.end()); });
  const bool wide = sets.sets().size() > 256;
  std::string out;
  put16(out, static_cast<uint32_t>(sets.sets().size()));
  put16(out, 0);
  for (const auto& set : sets.sets()) {
    put16(out, static_cast<uint32_t>(set.size()));
    for (const uint32_t material : set) put16(out, material);
  }
  for (const uint16_t n : numbers) {
    out += static_cast<char>(n);
    if (wide) out += static_cast<char>(n >> 8);
  }
  return out;
}

}  // namespace teracell

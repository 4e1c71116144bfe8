#include "server/parts/slice_picture.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "server/picture/picture.hpp"
#include "server/picture/tile_png.hpp"
#include "store/base/error.hpp"
#include "store/channels/fraction_reader.hpp"

namespace teracell::server {
namespace {

// A picture has more different sets than numbers.
struct TooManySets : UsageError {
  using UsageError::UsageError;
};

// Numbers the sets of a picture in the order in which they occur. For one thread.
class SetNumbers {
 public:
  using Members = std::function<std::vector<uint32_t>(const std::vector<Label>&)>;
  explicit SetNumbers(const Metadata& meta) : SetNumbers([&meta](const std::vector<Label>& set) { return materials_of(meta, set); }) {}
  // `members`: what counts of a set, ascending. `most`: members of all sets together.
  explicit SetNumbers(Members members, size_t most = std::numeric_limits<size_t>::max()) : members_(std::move(members)), left_(most) {}
  SetValue value() {
    return [this](const std::vector<Label>& set) { return number(set); };
  }
  uint32_t number_of(std::vector<uint32_t> members) {
    const auto [it, fresh] = numbers_.try_emplace(std::move(members), static_cast<uint32_t>(sets_.size()));
    if (fresh) {
      if (sets_.size() == kMostSets || it->first.size() > left_)
        throw TooManySets(fmt::format("the picture has more than {} different sets of materials: ask for a smaller part of it", kMostSets));
      left_ -= it->first.size();
      sets_.push_back(it->first);
    }
    return it->second;
  }
  // The one that counts for a label.
  uint32_t member(Label label) const { return members_({label})[0]; }
  // Members of each set.
  const std::vector<std::vector<uint32_t>>& sets() const { return sets_; }

 private:
  static constexpr size_t kMostSets = 65535;  // the outline has the next number
  uint32_t number(const std::vector<Label>& set) { return number_of(members_(set)); }
  const Members members_;
  std::map<std::vector<uint32_t>, uint32_t> numbers_;
  std::vector<std::vector<uint32_t>> sets_;
  size_t left_;
};

constexpr Rgba kOutline = {24, 24, 24, 255};

size_t width_of(const SliceView& view) { return static_cast<size_t>(view.u1 - view.u0); }
size_t height_of(const SliceView& view) { return static_cast<size_t>(view.v1 - view.v0); }
size_t width_of(const PlaneView& view) { return static_cast<size_t>(view.i1 - view.i0); }
size_t height_of(const PlaneView& view) { return static_cast<size_t>(view.j1 - view.j0); }

// The numbers of the sets of a view. `damage`: what can't be read has that of a set without members.
std::vector<uint16_t> numbers_of(const GridReader& reader, const SliceView& view, SetNumbers& sets, bool top_down, bool damage = false) {
  std::vector<uint16_t> out;
  out.reserve(width_of(view) * height_of(view));
  const auto unreadable = damage ? std::optional(static_cast<uint16_t>(sets.number_of({}))) : std::nullopt;
  for_each_row(
      reader, view, sets.value(), top_down, 1, [&](int64_t, std::span<const uint16_t> row) { out.insert(out.end(), row.begin(), row.end()); },
      kHeldCells, unreadable);
  return out;
}

std::vector<uint16_t> numbers_of(const GridReader& reader, const PlaneView& view, SetNumbers& sets, bool top_down) {
  std::vector<uint16_t> out;
  out.reserve(width_of(view) * height_of(view));
  const auto outside = static_cast<uint16_t>(sets.number_of({}));
  for_each_plane_row(reader, view, sets.value(), outside, top_down, 1,
                     [&](int64_t, std::span<const uint16_t> row) { out.insert(out.end(), row.begin(), row.end()); });
  return out;
}

// The same from the top. Cells that differ from the one above or on the right get the number of the outline, which follows those
// of the sets. The view is read with a margin of one cell on these two sides, so that neighbouring pictures fit together.
std::vector<uint16_t> outlined_numbers_of(const GridReader& reader, const SliceView& view, SetNumbers& sets) {
  SliceView wider = view;
  const Index3 n = reader.meta().grid.cells(view.level);
  const RayFrame f = RayFrame::along(view.axis);
  wider.u1 = std::min(n[f.u], view.u1 + 1);
  wider.v1 = std::min(n[f.v], view.v1 + 1);
  std::vector<uint16_t> numbers = numbers_of(reader, wider, sets, true);
  const auto outline = static_cast<uint16_t>(sets.sets().size());
  const size_t width = width_of(view), wide = width_of(wider), margin = height_of(wider) - height_of(view);  // margin in rows
  const size_t inner = std::min(width, wide - 1);  // at the grid's edge the last cell has no neighbour on its right
  for (size_t r = height_of(wider); r-- > margin;) {  // upwards, since the row above must not have changed yet
    uint16_t* here = &numbers[r * wide];
    const uint16_t* above = r > 0 ? here - wide : here;
    for (size_t c = 0; c < inner; ++c) here[c] = ((here[c + 1] != here[c]) | (above[c] != here[c])) ? outline : here[c];
    if (inner < width) here[inner] = above[inner] != here[inner] ? outline : here[inner];
  }
  for (size_t r = 0; r < height_of(view); ++r) std::copy_n(&numbers[(r + margin) * wide], width, &numbers[r * width]);
  numbers.resize(width * height_of(view));
  return numbers;
}

constexpr uint32_t kParts = 16;  // of a mixed cell, which are counted out to its members

// The members of a mixed cell, as often as their shares of kParts say, `own` first (at least once) and then in ascending order. The largest
// remainders are rounded up (A. Hamilton's method, 1792), those of lower members first where they are equal.
std::vector<uint32_t> counted_out(const std::map<uint32_t, uint32_t>& counts, uint32_t own) {
  uint64_t total = 0;
  for (const auto& [member, count] : counts) total += count;
  std::vector<std::pair<uint64_t, uint32_t>> remainders;  // of kParts * count / total, and whose they are
  std::map<uint32_t, uint32_t> parts;
  uint32_t left = kParts;
  for (const auto& [member, count] : counts) {
    const uint64_t product = uint64_t{count} * kParts;
    left -= parts[member] = static_cast<uint32_t>(product / total);
    remainders.emplace_back(product % total, member);
  }
  std::ranges::stable_sort(remainders, std::greater(), &std::pair<uint64_t, uint32_t>::first);
  for (uint32_t i = 0; i < left; ++i) ++parts[remainders[i].second];
  if (parts[own] == 0) --std::ranges::max_element(parts, {}, &std::pair<const uint32_t, uint32_t>::second)->second, ++parts[own];
  std::vector<uint32_t> out(parts[own], own);
  for (const auto& [member, n] : parts)
    if (member != own) out.insert(out.end(), n, member);
  return out;
}

// Gives mixed cells of a view other numbers: place(column, row) in `numbers` is that of a cell, rows counted from v0. Cells that have the
// number `keep` keep it.
template <class Place>
void shade(const GridReader& reader, const FractionReader& shares, const SliceView& view, SetNumbers& sets, std::vector<uint16_t>& numbers,
           std::optional<uint16_t> keep, const Place& place) {
  if (view.level > 0) return;
  const RayFrame f = RayFrame::along(view.axis);
  const Box box = f.box({view.u0, view.v0, view.index}, {view.u1, view.v1, view.index + 1});
  const int along = reader.meta().frame().w;
  shares.for_each_mixed(box, [&](const Index3& first, int64_t length, std::span<const Label> labels, std::span<const uint32_t> counts) {
    std::map<uint32_t, uint32_t> by_member;
    for (size_t i = 0; i < labels.size(); ++i) by_member[sets.member(labels[i])] += counts[i];
    Index3 cell = first;
    for (; cell[along] < first[along] + length; ++cell[along]) {
      uint16_t& number = numbers[place(static_cast<size_t>(cell[f.u] - view.u0), static_cast<size_t>(cell[f.v] - view.v0))];
      if (number == keep) continue;
      const uint32_t own = sets.sets()[number][0];
      if (by_member.size() > 1 && by_member.contains(own)) number = static_cast<uint16_t>(sets.number_of(counted_out(by_member, own)));
    }
  });
}

std::vector<uint16_t> numbers_from_below(const GridReader& reader, const SliceView& view, SetNumbers& sets, const FractionReader* shares,
                                         bool damage) {
  std::vector<uint16_t> numbers = numbers_of(reader, view, sets, false, damage);
  if (shares) shade(reader, *shares, view, sets, numbers, {}, [&](size_t u, size_t v) { return v * width_of(view) + u; });
  return numbers;
}

std::vector<uint16_t> numbers_from_below(const GridReader& reader, const PlaneView& view, SetNumbers& sets, const FractionReader*, bool) {
  return numbers_of(reader, view, sets, false);
}

constexpr size_t kMostMembers = size_t{1} << 20;           // of sets of labels
constexpr uint16_t kWideMembers = 1, kBodiesNotApart = 2;  // flags
uint16_t width_flag(const Metadata& meta) { return meta.labels.size() > 65536 ? kWideMembers : 0; }

std::string sets_text(const SetNumbers& sets, std::span<const uint16_t> numbers, uint16_t flags) {
  std::vector<uint16_t> table = {static_cast<uint16_t>(sets.sets().size()), flags};
  const auto put = [&](size_t number) {
    table.push_back(static_cast<uint16_t>(number));
    if (flags & kWideMembers) table.push_back(static_cast<uint16_t>(number >> 16));
  };
  for (const auto& set : sets.sets()) {
    put(set.size());
    for (const uint32_t member : set) put(member);
  }
  std::string out;
  put_labels(out, table, true);
  put_labels(out, numbers, sets.sets().size() > 256);
  return out;
}

template <class View>
std::string sets_of(const GridReader& reader, const View& view, const FractionReader* shares, bool damage = false) {
  SetNumbers sets(reader.meta());
  const std::vector<uint16_t> numbers = numbers_from_below(reader, view, sets, shares, damage);
  return sets_text(sets, numbers, 0);
}

template <class View>
std::string label_sets_of(const GridReader& reader, const View& view, const FractionReader* shares, bool damage = false) try {
  SetNumbers sets([](const std::vector<Label>& set) { return set; }, kMostMembers);
  const std::vector<uint16_t> numbers = numbers_from_below(reader, view, sets, shares, damage);
  return sets_text(sets, numbers, width_flag(reader.meta()));
} catch (const TooManySets&) {
  const std::vector<LabelInfo>& labels = reader.meta().labels;
  std::vector<Label> first_of(reader.meta().materials.size());
  for (size_t label = labels.size(); label-- > 0;) first_of[labels[label].material] = static_cast<Label>(label);
  SetNumbers sets([&](const std::vector<Label>& set) {
    std::vector<uint32_t> firsts = materials_of(reader.meta(), set);
    for (uint32_t& m : firsts) m = first_of[m];
    std::ranges::sort(firsts);
    return firsts;
  });
  const std::vector<uint16_t> numbers = numbers_from_below(reader, view, sets, shares, damage);
  return sets_text(sets, numbers, width_flag(reader.meta()) | kBodiesNotApart);
}

template <class View>
std::string png_of(const View& view, std::span<const uint16_t> numbers, const SetNumbers& sets, const Metadata& meta, const PictureStyle& style) {
  const MaterialColors of_materials(meta, style.shown);
  std::vector<Rgba> colors;
  for (const auto& set : sets.sets()) colors.push_back(of_materials.of(set));
  if (style.outline) colors.push_back(kOutline);
  return encode_png(static_cast<uint32_t>(width_of(view)), static_cast<uint32_t>(height_of(view)), numbers, colors);
}

}  // namespace

std::string picture_png(const GridReader& reader, const SliceView& view, const PictureStyle& style) {
  SetNumbers sets(reader.meta());
  std::vector<uint16_t> numbers = style.outline ? outlined_numbers_of(reader, view, sets) : numbers_of(reader, view, sets, true);
  if (style.shares) {
    // The outline's number follows those of the sets, of which there may now be more.
    constexpr uint16_t kOutlined = 65535;
    const size_t outlined = sets.sets().size();
    if (style.outline)
      for (uint16_t& n : numbers) n = n == outlined ? kOutlined : n;
    shade(reader, *style.shares, view, sets, numbers, style.outline ? std::optional(kOutlined) : std::nullopt,
          [&](size_t u, size_t v) { return (height_of(view) - 1 - v) * width_of(view) + u; });
    if (style.outline)
      for (uint16_t& n : numbers) n = n == kOutlined ? static_cast<uint16_t>(sets.sets().size()) : n;
  }
  return png_of(view, numbers, sets, reader.meta(), style);
}

std::string picture_png(const GridReader& reader, const PlaneView& view, const PictureStyle& style) {
  SetNumbers sets(reader.meta());
  const std::vector<uint16_t> numbers = numbers_of(reader, view, sets, true);
  return png_of(view, numbers, sets, reader.meta(), style);
}

std::string raw_labels(const GridReader& reader, const SliceView& view) {
  const bool wide = wide_labels(reader.meta());
  std::string out;
  out.reserve(width_of(view) * height_of(view) * (wide ? 2 : 1));
  for_each_row(reader, view, strongest_material(reader.meta()), false, 1,
               [&](int64_t, std::span<const uint16_t> row) { put_labels(out, row, wide); });
  return out;
}

std::string raw_sets(const GridReader& reader, const SliceView& view, const FractionReader* shares, bool damage) {
  return sets_of(reader, view, shares, damage);
}
std::string raw_sets(const GridReader& reader, const PlaneView& view) { return sets_of(reader, view, nullptr); }
std::string raw_label_sets(const GridReader& reader, const SliceView& view, const FractionReader* shares, bool damage) {
  return label_sets_of(reader, view, shares, damage);
}
std::string raw_label_sets(const GridReader& reader, const PlaneView& view) { return label_sets_of(reader, view, nullptr); }

}  // namespace teracell::server

#include "server/service/slice_picture.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "server/picture/picture.hpp"
#include "server/picture/tile_png.hpp"
#include "store/error.hpp"

namespace teracell {
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
  // Members of each set.
  const std::vector<std::vector<uint32_t>>& sets() const { return sets_; }

 private:
  static constexpr size_t kMostSets = 65535;  // the outline has the next number
  uint32_t number(const std::vector<Label>& set) {
    const auto [it, fresh] = numbers_.try_emplace(members_(set), static_cast<uint32_t>(sets_.size()));
    if (fresh) {
      if (sets_.size() == kMostSets || it->first.size() > left_)
        throw TooManySets(fmt::format("the picture has more than {} different sets of materials: ask for a smaller part of it", kMostSets));
      left_ -= it->first.size();
      sets_.push_back(it->first);
    }
    return it->second;
  }
  const Members members_;
  std::map<std::vector<uint32_t>, uint32_t> numbers_;
  std::vector<std::vector<uint32_t>> sets_;
  size_t left_;
};

constexpr Rgba kOutline = {24, 24, 24, 255};

size_t width_of(const SliceView& view) { return static_cast<size_t>(view.u1 - view.u0); }
size_t height_of(const SliceView& view) { return static_cast<size_t>(view.v1 - view.v0); }

// The numbers of the sets of a view.
std::vector<uint16_t> numbers_of(const GridReader& reader, const SliceView& view, SetNumbers& sets, bool top_down) {
  std::vector<uint16_t> out;
  out.reserve(width_of(view) * height_of(view));
  for_each_row(reader, view, sets.value(), top_down, 1,
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

}  // namespace

std::string picture_png(const GridReader& reader, const SliceView& view, const PictureStyle& style) {
  SetNumbers sets(reader.meta());
  const std::vector<uint16_t> numbers = style.outline ? outlined_numbers_of(reader, view, sets) : numbers_of(reader, view, sets, true);
  const MaterialColors of_materials(reader.meta(), style.shown);
  std::vector<Rgba> colors;
  for (const auto& set : sets.sets()) colors.push_back(of_materials.of(set));
  if (style.outline) colors.push_back(kOutline);
  return encode_png(static_cast<uint32_t>(width_of(view)), static_cast<uint32_t>(height_of(view)), numbers, colors);
}

std::string raw_labels(const GridReader& reader, const SliceView& view) {
  const bool wide = wide_labels(reader.meta());
  std::string out;
  out.reserve(width_of(view) * height_of(view) * (wide ? 2 : 1));
  for_each_row(reader, view, strongest_material(reader.meta()), false, 1,
               [&](int64_t, std::span<const uint16_t> row) { put_labels(out, row, wide); });
  return out;
}

std::string raw_sets(const GridReader& reader, const SliceView& view) {
  SetNumbers sets(reader.meta());
  const std::vector<uint16_t> numbers = numbers_of(reader, view, sets, false);
  return sets_text(sets, numbers, 0);
}

std::string raw_label_sets(const GridReader& reader, const SliceView& view) try {
  SetNumbers sets([](const std::vector<Label>& set) { return set; }, kMostMembers);
  const std::vector<uint16_t> numbers = numbers_of(reader, view, sets, false);
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
  const std::vector<uint16_t> numbers = numbers_of(reader, view, sets, false);
  return sets_text(sets, numbers, width_flag(reader.meta()) | kBodiesNotApart);
}

}  // namespace teracell

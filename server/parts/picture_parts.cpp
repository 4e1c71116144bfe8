#include "server/parts/picture_parts.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/picture/picture.hpp"
#include "store/base/error.hpp"

namespace teracell::server {
namespace {

constexpr int64_t kMostCells = int64_t{1} << 24;  // read at once
constexpr size_t kPiece = size_t{1} << 16;        // pixels of a row that are encoded at once
constexpr size_t kEncoder = size_t{1} << 18;      // bytes that the encoder keeps whatever the width

class PictureParts final : public Parts {
 public:
  PictureParts(const GridReader& reader, const SliceView& view, const PictureStyle& style)
      : reader_(reader),
        left_(view),
        width_(view.u1 - view.u0),
        rows_(most_rows()),
        colors_(reader.meta(), view.level, style.shown),
        png_(static_cast<uint32_t>(width_), static_cast<uint32_t>(view.v1 - view.v0), colors_,
             [this](std::span<const uint8_t> bytes) { made_.append(bytes.begin(), bytes.end()); }) {}

  bool append(std::string& out) override {
    while (made_.size() < kEnough && left_.v0 < left_.v1) read_band();
    const bool more = left_.v0 < left_.v1;
    if (!more) png_.finish();
    out += made_;
    made_ = {};
    return more;
  }

  size_t memory() const override {
    // A row as numbers, twice when it comes in parts, and as pixels. The rows of longer pictures are not kept.
    constexpr size_t kPerPixel = 2 * sizeof(uint16_t) + sizeof(uint32_t);
    return kEncoder + (width_ <= PngWriter::kLongest ? kPerPixel * static_cast<size_t>(width_) : 0);
  }

 private:
  struct Enough {};
  int64_t most_rows() const { return std::max<int64_t>(1, kMostCells / width_); }

  // Reads rows until the part is large enough. Rows that don't fit into it are read again for the next part, so few more are asked for
  // than fitted into the last one.
  void read_band() {
    SliceView band = left_;
    if (at_ > 0) band.u0 += at_, band.v0 = band.v1 - 1;
    else band.v0 = std::max(band.v0, band.v1 - rows_);
    const int64_t from = left_.v1;
    bool full = false;
    try {
      for_each_row(reader_, band, colors_.value(), true, 1, [&](int64_t, std::span<const uint16_t> row) {
        for (; !row.empty(); row = row.subspan(std::min(row.size(), kPiece))) {
          if (made_.size() >= kEnough) throw Enough();
          const auto piece = row.first(std::min(row.size(), kPiece));
          png_.append(piece);
          at_ += static_cast<int64_t>(piece.size());
          if (at_ == width_) --left_.v1, at_ = 0;
        }
      });
    } catch (const Enough&) {
      full = true;
    }
    const int64_t rows = from - left_.v1;
    rows_ = std::clamp<int64_t>(full ? rows + rows / 8 : 2 * rows, 1, most_rows());
  }

  const GridReader& reader_;
  SliceView left_;   // the rows that are not finished; the topmost is the next
  const int64_t width_;
  int64_t at_ = 0;   // pixels of the topmost row that were read: rows that are very long come in pieces
  int64_t rows_;     // to be asked for at once
  SetColors colors_;
  std::string made_;
  PngWriter png_;
};

}  // namespace

std::unique_ptr<Parts> picture_parts(const GridReader& reader, const SliceView& view, const PictureStyle& style) {
  if (style.outline || style.shares)
    throw UsageError(fmt::format("{}: expected a picture of at most {} pixels, found {} x {}: ask for a part of it or for a coarser level",
                                 style.outline ? "outline" : "shares", kMostOutlined, view.u1 - view.u0, view.v1 - view.v0));
  return std::make_unique<PictureParts>(reader, view, style);
}

Service::Recipe picture_recipe(const GridReader& reader, const SliceView& view, const PictureStyle& style) {
  Service::Recipe recipe{.content_type = "image/png"};
  const auto width = static_cast<uint64_t>(view.u1 - view.u0), height = static_cast<uint64_t>(view.v1 - view.v0);
  if (height > kMostOutlined / width) recipe.parts = [&reader, view, style] { return picture_parts(reader, view, style); };
  else recipe.make = [&reader, view, style] { return picture_png(reader, view, style); };
  return recipe;
}

}  // namespace teracell::server

#include "server/render/options.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/read/stats.hpp"
#include "store/text/name_list.hpp"
#include "store/text/words.hpp"

namespace teracell::server {
namespace {

constexpr RenderOption kOptions[] = {
    {"from", "X,Y,Z", "where the eye is; default: (1, -1.4, 0.9) times the diagonal of the box of what is shown, from its middle"},
    {"at", "X,Y,Z", "what it looks at; default: the middle of this box"},
    {"domain", "", "the box is the whole grid"},
    {"up", "AXIS", "x, y or z; default: z"},
    {"fov", "DEGREES", "the field of view from bottom to top; default: 30"},
    {"view", "DIRECTION", "x, y, z, -x, -y or -z: look along it, without perspective"},
    {"size", "W,H", "pixels; default: 1280,960"},
    {"level", "L", "draw the cells of this level; default: those that take at most a quarter of a pixel"},
    {"cut", "x=X,y=Y,z=Z", "keep what is below these coordinates; one or more of them"},
    {"open", "X,Y,Z", "cut away the corner in front of this point, as the eye sees it"},
    {"open-from", "X,Y,Z", "where the eye of --open is; default: where that of the picture is"},
    {"plane", "NX,NY,NZ,D", "cut away the points p with (NX, NY, NZ) . p >= D"},
    {"materials", "NAME,...", "show these alone; default: all but the background"},
    {"bodies", "NAME,...", "show these bodies alone, where the file keeps bodies apart"},
    {"labels", "RANGES", "show the labels with these numbers alone, as in 1-4,7: materials, or bodies where the file keeps them apart"},
    {"background", "#rrggbbaa", "the colour where nothing is; default: #ffffff"},
    {"flat", "", "the materials' colours alone: no shading, no smoothing"},
};

class Options : OptionWords {
 public:
  Options(const OptionText& text, const GridReader& reader, std::string_view dashes)
      : OptionWords(dashes), text_(text), reader_(reader), meta_(reader.meta()) {}

  RenderOptions parse() const {
    RenderOptions out;
    const PictureSize size = picture_size();
    out.shown = shown();
    if (const std::string* text = text_("level")) out.aim.level = level(*text);
    const std::string* const domain = text_("domain");
    out.aim.camera = camera(size, out, domain != nullptr && flag("domain", *domain));
    if (const std::string* text = text_("cut")) out.aim.cuts = cut(*text);
    const std::string *const open = text_("open"), *const open_from = text_("open-from");
    if (open_from && !open) throw UsageError(fmt::format("{0}open-from: expected with {0}open, found without it", dashes()));
    if (open)
      out.aim.cuts.push_back(corner(out.aim.camera, point("open", *open), open_from ? std::optional(point("open-from", *open_from)) : std::nullopt));
    if (const std::string* text = text_("plane")) out.aim.cuts.push_back({plane(*text)});
    if (const std::string* text = text_("background")) out.ground = color(*text);
    if (const std::string* text = text_("flat")) out.flat = flag("flat", *text);
    return out;
  }

 private:
  PictureSize picture_size() const {
    const std::string* const text = text_("size");
    if (!text) return {};
    const std::string expected =
        fmt::format("width and height from 1 to {} pixels, at most {} in all, as in 1280,960", kLongestPictureSide, kMostPicturePixels);
    const auto n = numbers_in<uint64_t>(*text, 2);
    const auto is_side = [](uint64_t side) { return side >= 1 && side <= kLongestPictureSide; };
    if (!n || !is_side((*n)[0]) || !is_side((*n)[1]) || (*n)[0] * (*n)[1] > kMostPicturePixels) refuse("size", expected, *text);
    return {static_cast<uint32_t>((*n)[0]), static_cast<uint32_t>((*n)[1])};
  }

  // The box around the cells of the level that are shown, in cells of level 0; all of the grid where none is shown.
  Box box_shown(const RenderOptions& options) const {
    const Box all = meta_.grid.box(0);
    Box out = read_box_of(reader_, shown_labels(meta_, options));
    if (out.empty()) return all;
    const int level = options.aim.level.value_or(0);
    for (size_t d = 0; d < 3; ++d) {
      out.lo[d] = out.lo[d] >> level << level;
      out.hi[d] = std::min(all.hi[d], ceil_shift(out.hi[d], level) << level);
    }
    return out;
  }

  Camera camera(PictureSize size, const RenderOptions& options, bool domain) const {
    int up = 2;
    if (const std::string* text = text_("up")) {
      const auto axis = axis_named(*text);
      if (!axis) refuse("up", "x, y or z", *text);
      up = *axis;
    }
    if (const std::string* view = text_("view")) {
      for (const char* other : {"from", "at", "fov"})
        if (text_(other)) throw UsageError(fmt::format("{0}view: expected alone, found with {0}{1}", dashes(), other));
      if (domain) throw UsageError(fmt::format("{0}view: expected alone, found with {0}domain: it shows the whole grid", dashes()));
      const bool positive = !view->starts_with('-');
      const auto axis = axis_named(std::string_view(*view).substr(positive ? 0 : 1));
      if (!axis) refuse("view", "x, y, z, -x, -y or -z", *view);
      return axis_camera(meta_.grid, *axis, positive, up, size);
    }
    double fov = 30;
    if (const std::string* text = text_("fov")) {
      fov = number("fov", *text, "degrees");
      if (!(fov >= 1e-6 && fov <= 179)) refuse("fov", "0.000001 to 179 degrees", *text);
    }
    const std::string *from = text_("from"), *at = text_("at");
    if (domain && from && at)
      throw UsageError(fmt::format("{0}domain: expected without {0}from or without {0}at, which it gives, found with both", dashes()));
    const DefaultView usual = from && at ? DefaultView{} : default_view(meta_.grid, domain ? meta_.grid.box(0) : box_shown(options));
    const Vec3 eye = from ? point("from", *from) : usual.from, target = at ? point("at", *at) : usual.at;
    if (eye == target)
      throw UsageError(fmt::format("{0}from, {0}at: expected two points, found ({1}, {2}, {3}) twice", dashes(), eye[0], eye[1], eye[2]));
    return perspective_camera(eye, target, up, fov, size);
  }

  int level(const std::string& text) const {
    const auto out = number_in<int>(text);
    if (!out || *out < 0 || *out >= meta_.grid.levels()) refuse("level", fmt::format("0 to {}", meta_.grid.levels() - 1), text);
    return *out;
  }

  Cuts cut(const std::string& text) const {
    constexpr const char* kExpected = "one coordinate per axis at most, as in x=1.5,z=20";
    Cuts out;
    std::array<bool, 3> given{};
    for (const std::string_view word : split(text, ',')) {
      const auto axis = word.size() > 2 && word[1] == '=' ? axis_named(word.substr(0, 1)) : std::nullopt;
      if (!axis || std::exchange(given[static_cast<size_t>(*axis)], true)) refuse("cut", kExpected, text);
      HalfSpace half{{}, number("cut", word.substr(2), kExpected)};
      half.normal[static_cast<size_t>(*axis)] = 1;
      out.push_back({half});
    }
    return out;
  }

  static Cut corner(const Camera& camera, const Vec3& at, const std::optional<Vec3>& seen_from) {
    const std::optional<Vec3> eye = seen_from ? seen_from : camera.perspective ? std::optional(camera.from) : std::nullopt;
    Cut out;
    for (size_t d = 0; d < 3; ++d) {
      const bool above = eye ? (*eye)[d] >= at[d] : camera.forward[d] <= 0;
      HalfSpace half{{}, above ? at[d] : -at[d]};
      half.normal[d] = above ? 1 : -1;
      out.push_back(half);
    }
    return out;
  }

  HalfSpace plane(const std::string& text) const {
    constexpr const char* kExpected = "four numbers up to 1e75, the first three not all 0, as in 1,1,0,25";
    const auto words = split(text, ',');
    if (words.size() != 4) refuse("plane", kExpected, text);
    HalfSpace out{};
    for (size_t d = 0; d < 3; ++d) out.normal[d] = number("plane", words[d], kExpected);
    out.offset = number("plane", words[3], kExpected);
    const double longest = std::max({std::abs(out.normal[0]), std::abs(out.normal[1]), std::abs(out.normal[2])});
    if (longest == 0) refuse("plane", kExpected, text);
    return {out.normal * (1 / longest), out.offset / longest};
  }

  // Of each label; empty when nothing is chosen.
  std::vector<bool> shown() const {
    const char* const chosen[] = {"materials", "bodies", "labels"};
    std::vector<const char*> given;
    for (const char* name : chosen)
      if (text_(name)) given.push_back(name);
    if (given.size() > 1) throw UsageError(fmt::format("{0}{1}: expected alone, found with {0}{2}", dashes(), given[0], given[1]));
    if (const std::string* text = text_("materials"))
      return of_names("materials", *text, "materials of this grid",
                      [](const Metadata& meta, const LabelInfo& label) -> const std::string& { return meta.materials[label.material].name; });
    if (const std::string* text = text_("bodies"))
      return of_names("bodies", *text, "bodies that this grid keeps apart",
                      [](const Metadata&, const LabelInfo& label) -> const std::string& { return label.body; });
    if (const std::string* text = text_("labels")) return ranges(*text);
    return {};
  }

  template <class NameOf>
  std::vector<bool> of_names(std::string_view option, const std::string& text, const char* what, NameOf name_of) const {
    std::vector<bool> out(meta_.labels.size());
    for (const std::string& name : names_in(text, fmt::format("{}{}", dashes(), option))) {
      bool found = false;
      for (size_t i = 0; i < out.size(); ++i)
        if (name_of(meta_, meta_.labels[i]) == name) out[i] = found = true;
      if (!found) refuse(option, fmt::format("names of {} ({})", what, all_names(name_of)), name);
    }
    return out;
  }

  template <class NameOf>
  std::string all_names(NameOf name_of) const {
    std::set<std::string> known = {""};
    std::vector<std::string> out;
    for (const LabelInfo& label : meta_.labels)
      if (known.insert(name_of(meta_, label)).second) out.push_back(name_of(meta_, label));
    return out.empty() ? "none" : listed(out);
  }

  std::vector<bool> ranges(const std::string& text) const {
    if (text.empty()) return std::vector<bool>(meta_.labels.size());  // nothing is shown
    const auto out = ranges_in(text, meta_.labels.size());
    if (!out) refuse("labels", fmt::format("numbers from 0 to {} and ranges of them, as in 1-4,7", meta_.labels.size() - 1), text);
    return *out;
  }

  Rgba color(const std::string& text) const {
    const auto out = parse_color(text);
    if (!out) refuse("background", "#rrggbb or #rrggbbaa", text);
    return *out;
  }

  bool flag(std::string_view name, const std::string& text) const {
    if (text.empty() || text == "1" || text == "true") return true;
    if (text != "0" && text != "false") refuse(name, "0 or 1", text);
    return false;
  }

  const OptionText& text_;
  const GridReader& reader_;
  const Metadata& meta_;
};

}  // namespace

std::span<const RenderOption> render_options() { return kOptions; }

void OptionWords::refuse(std::string_view name, std::string_view expected, std::string_view found) const {
  throw UsageError(fmt::format("{}{}: expected {}, found '{}'", dashes_, name, expected, found));
}

double OptionWords::number(std::string_view name, std::string_view text, const char* expected) const {
  const auto value = number_in<double>(text);
  if (!value || !(std::abs(*value) <= 1e75)) refuse(name, expected, text);
  return *value;
}

Vec3 OptionWords::point(std::string_view name, const std::string& text) const {
  const auto words = split(text, ',');
  constexpr const char* kExpected = "three numbers up to 1e75, as in 1,2,3";
  if (words.size() != 3) refuse(name, kExpected, text);
  Vec3 out;
  for (size_t d = 0; d < 3; ++d) out[d] = number(name, words[d], kExpected);
  return out;
}

RenderOptions parse_render_options(const OptionText& text, const GridReader& reader, std::string_view dashes) {
  return Options(text, reader, dashes).parse();
}

}  // namespace teracell::server

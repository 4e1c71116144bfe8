// Pictures in three dimensions of a grid: view.png; what their pixels show, as numbers: view.bin; and what is seen at one point: view.json.
#include "server/answers/answers.hpp"

#include <charconv>

#include <fmt/format.h>

#include "server/render/encode.hpp"
#include "server/render/options.hpp"
#include "server/render/sights.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::server {
namespace {

constexpr double kMostSeenPixels = 524288;           // 2^19: larger pictures are dear
constexpr uint64_t kMostPixels = uint64_t{1} << 23;  // others wait meanwhile, so there are fewer than in a slice
const auto kQuietly = [](double) {};

RenderOptions options_of(const ServedGrid& grid, const Target& target, std::initializer_list<std::string_view> more) {
  std::vector<std::string_view> known = {"v"};
  for (const RenderOption& option : render_options()) known.push_back(option.name);
  known.insert(known.end(), more);
  target.allow(known);
  return parse_render_options([&](std::string_view name) { return target.find(name); }, grid.reader(), "");
}

// "?against={id}": null without it.
std::shared_ptr<const ServedGrid> other_of(const GridRequest& r) {
  const std::string* const id = r.target.find("against");
  if (!id) return nullptr;
  for (const char* name : {"labels", "materials", "bodies"})
    if (r.target.find(name)) throw bad_request(fmt::format("{}: expected none beside against: all that differs is seen", name));
  return r.service.grids().find(*id);
}

// The answer is kept for the grids of this moment.
void expect_still(const GridRequest& r, const std::shared_ptr<const ServedGrid>& other) {
  if (other && r.service.grids().find(other->id)->number != other->number) throw Replaced("grid '" + other->id + "' was replaced");
}

Viewed viewed_of(const GridRequest& r, const std::shared_ptr<const ServedGrid>& other) { return {r.reader(), other ? &other->reader() : nullptr}; }

// "?damage=1": whether what can't be read is seen.
std::shared_ptr<const Prepared> prepared_for(const GridRequest& r, const RenderOptions& options, bool damage = false,
                                             const std::shared_ptr<const ServedGrid>& other = nullptr) {
  if (other) {
    const int level = options.aim.level.value_or(0);
    return r.service.prepared().get(fmt::format("{} against {} {} {}", r.grid->number, other->number, level, damage), [&] {
      auto prepared = std::make_shared<const Prepared>(r.reader(), other->reader(), level, damage);
      const size_t bytes = prepared->memory();
      return std::pair(std::move(prepared), bytes);
    });
  }
  const std::vector<bool> shown = shown_labels(r.meta(), options);
  const int level = options.aim.level.value_or(0);
  std::string key = fmt::format("{} {} {} ", r.grid->number, level, damage);
  for (const bool one : shown) key += one ? '1' : '0';
  return r.service.prepared().get(key, [&] {
    auto prepared = std::make_shared<const Prepared>(r.reader(), shown, level, 1, damage);
    const size_t bytes = prepared->memory();
    return std::pair(std::move(prepared), bytes);
  });
}

void check_size(const Service& service, const char* what, uint64_t width, uint64_t height) {
  if (const uint64_t most = std::min(service.options().max_pixels, kMostPixels); width * height > most)
    throw bad_request(fmt::format("{}: expected at most {} pixels, found {} x {}", what, most, width, height));
}

Response answer_view_png(const GridRequest& r) {
  const RenderOptions options = options_of(*r.grid, r.target, {});
  check_size(r.service, "size", options.aim.camera.size.width, options.aim.camera.size.height);
  const auto make = [&r, options] { return encode_picture(render(r.reader(), *prepared_for(r, options), options, 1, kQuietly), "png"); };
  return r.answer({.route = "view", .content_type = "image/png", .make = make});
}

Response answer_view_bin(const GridRequest& r) {
  const RenderOptions options = options_of(*r.grid, r.target, {"window", "quick", "damage", "against"});
  const PictureSize size = options.aim.camera.size;
  const PixelWindow asked = window_of(r.target, size.width, size.height);
  const Window window{asked.x0, asked.y0, asked.x1, asked.y1};
  check_size(r.service, "window", static_cast<uint64_t>(window.width()), static_cast<uint64_t>(window.height()));
  const std::shared_ptr<const ServedGrid> other = other_of(r);
  const auto make = [&r, other, options, window, is_quick = switched_on(r.target, "quick"), damage = switched_on(r.target, "damage")] {
    expect_still(r, other);
    return encode_sights(viewed_of(r, other), *prepared_for(r, options, damage, other), options.aim, window, is_quick, 1, kQuietly);
  };
  return r.answer(
      {.route = "view_bin", .content_type = "application/octet-stream", .compress = true, .make = make, .address = other ? other->hash : ""});
}

// {"x,y"} in pixels.
std::pair<double, double> pixel_of(const Target& target) {
  const auto refuse = [](std::string_view found) -> HttpError {
    return bad_request(fmt::format("pixel: expected two numbers, as in 320.5,240.5, found '{}'", found.substr(0, 48)));
  };
  const std::string* text = target.find("pixel");
  if (!text) throw refuse("");
  double out[2];
  const char *at = text->data(), *const end = at + text->size();
  for (int i = 0; i < 2; ++i) {
    const auto [next, error] = std::from_chars(at, end, out[i]);
    if (error != std::errc{} || !(std::abs(out[i]) < 1e9) || (i == 0 ? next == end || *next != ',' : next != end)) throw refuse(*text);
    at = next + 1;
  }
  return {out[0], out[1]};
}

std::string point_json(const Viewed& viewed, const Prepared& prepared, const RenderOptions& options, double x, double y) {
  const Metadata& meta = viewed.reader.meta();
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).key("seen");
  if (const auto hit = seen_at(viewed, prepared, options.aim, x, y)) {
    const Sight sight = options.aim.camera.sight(x, y);
    out.begin_object().field("at", sight.from + sight.along * hit->t).field("cell", hit->cell).field("level", hit->level).field("distance", hit->t);
    if (hit->label == prepared.visible.damage()) {
      out.key("label").value(nullptr).key("material").value(nullptr).key("body").value(nullptr);
    } else if (viewed.against) {
      out.field("label", hit->label).key("material").value(nullptr).key("body").value(nullptr);
      if (hit->level == 0) {
        const auto [from, to] = Differing(viewed.reader, *viewed.against, true).names(hit->cell);
        for (const auto& [key, names] : {std::pair("from", &from), std::pair("to", &to)}) {
          out.key(key).begin_array();
          for (const std::string& name : *names) out.value(name);
          out.end_array();
        }
      }
    } else {
      const LabelInfo& label = meta.labels[hit->label];
      out.field("label", hit->label).field("material", label.material).key("body");
      if (label.body.empty()) out.value(nullptr);
      else out.value(label.body);
    }
    out.end_object();
  } else {
    out.value(nullptr);
  }
  out.end_object();
  return text;
}

Response answer_view_json(const GridRequest& r) {
  const RenderOptions options = options_of(*r.grid, r.target, {"pixel", "damage", "against"});
  const std::shared_ptr<const ServedGrid> other = other_of(r);
  const auto make = [&r, other, options, pixel = pixel_of(r.target), damage = switched_on(r.target, "damage")] {
    expect_still(r, other);
    return point_json(viewed_of(r, other), *prepared_for(r, options, damage, other), options, pixel.first, pixel.second);
  };
  return r.answer({.route = "view_json", .content_type = kJsonType, .make = make, .address = other ? other->hash : ""});
}

Cost cost_of_numbers(const Target& target) { return pixels_asked_for(target) <= kMostSeenPixels ? Cost::kSeen : Cost::kDear; }

}  // namespace

const Answer kViewPngAnswer = {"view.png", 1, Cost::kDear, answer_view_png};
const Answer kViewBinAnswer = {"view.bin", 1, Cost::kDear, answer_view_bin, cost_of_numbers};
const Answer kViewJsonAnswer = {"view.json", 1, Cost::kSeen, answer_view_json};

}  // namespace teracell::server

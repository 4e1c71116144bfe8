// One answer about a grid: where it is found, what it may cost and how it is made. Its file defines one; answers.hpp lists all.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/service/handler.hpp"
#include "server/service/service.hpp"
#include "store/read/slice.hpp"

namespace teracell::server {

inline constexpr const char* kJsonType = "application/json";

// A request below /api/v1/grids/{id}/: the grid, and the segments after the id. It is valid during the call.
struct GridRequest {
  Service& service;
  const Request& request;
  const Target& target;
  std::shared_ptr<const ServedGrid> grid;
  std::vector<std::string> rest;
  const GridReader& reader() const { return grid->reader(); }
  const Metadata& meta() const { return grid->meta(); }
  Response answer(const Service::Recipe& recipe) const { return service.answer(request, target, grid, recipe); }
};

struct Answer {
  std::string_view name;  // the first segment after the id; with a dot at its end, all that begin so: "box." of "box.npy"
  size_t segments;        // the address has after the id
  Cost cost;
  Response (*make)(const GridRequest& r);  // throws HttpError, and what reading throws; threads call it at once
  Cost (*cost_of)(const Target& target) = nullptr;  // in place of `cost`, where it depends on more than the name
};

// ---- What several answers ask for.

int axis_of(const std::string& name);
int level_of(const std::string* text, const GridReader& reader);  // 0 for null
std::pair<std::string, std::string> split_name(const std::string& name);  // "12.png" -> "12", ".png"
std::pair<std::string, std::string> split_pair(const std::string& text, const char* what);  // "a_b" -> "a", "b"
// The tile at .../{axis}/{index}/{level}/{col}_{row}.png, and ".png".
std::pair<SliceView, std::string> tile_of(const GridRequest& r);
bool switched_on(const Target& target, const char* name);  // "?outline=1"
const FractionReader* asks_for_shares(const Target& target, const ServedGrid& grid);  // "?shares=1"; null for 0
bool asks_for_bodies(const GridRequest& r);                                            // "?bodies=1"
// "?window=X0,Y0,X1,Y1", in pixels from the upper left corner of a picture; the whole of it without it.
struct PixelWindow {
  int64_t x0, y0, x1, y1;
  uint64_t width() const { return static_cast<uint64_t>(x1 - x0); }
  uint64_t height() const { return static_cast<uint64_t>(y1 - y0); }
};
PixelWindow window_of(const Target& target, int64_t width, int64_t height);
// Of a picture or the part of it, as far as "?window=" or "?size=" says, otherwise infinitely many; the answer refuses what makes no sense.
double pixels_asked_for(const Target& target);
Index3 cell_asked_for(const GridRequest& r);  // "?cell=I,J,K": of level 0
Box region_of(const GridRequest& r);  // "?region=X0,Y0,Z0,X1,Y1,Z1"; the whole grid without it

// make() returns JSON.
Response json_answer(const GridRequest& r, const char* route, std::function<std::string()> make);
std::vector<bool> materials_asked_for(const GridRequest& r);  // "?materials=1,3": by material; empty: all
// "?materials=1,3", "?outline=1" and "?shares=1".
Response picture_answer(const GridRequest& r, const char* route, const SliceView& view);

}  // namespace teracell::server

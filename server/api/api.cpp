#include "server/api/api.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "server/api/diff.hpp"
#include "server/api/view.hpp"
#include "server/parts/box_parts.hpp"
#include "server/parts/column_parts.hpp"
#include "server/parts/file_parts.hpp"
#include "server/parts/picture_parts.hpp"
#include "store/base/wanted.hpp"
#include "store/channels/cut_plane.hpp"
#include "store/check/kept.hpp"
#include "store/grid/vtk_header.hpp"
#include "store/text/json_writer.hpp"
#include "store/whole/info.hpp"

namespace teracell::server {
namespace {

constexpr const char* kJson = "application/json";
constexpr double kMostBoxCells = 4294967296.0;  // 2^32
constexpr double kMostLineCells = 1048576;      // 2^20, which take about a second
constexpr double kMostSeenPixels = 524288;      // 2^19: larger pictures are dear
constexpr double kFarthestEnd = 1e6;            // of a line, as a multiple of the grid's largest coordinate

int axis_of(const std::string& name) {
  if (const auto axis = axis_named(name)) return *axis;
  throw bad_request(fmt::format("axis: expected x, y or z, found '{}'", name.substr(0, 48)));
}

// "12.png" -> "12", ".png"
std::pair<std::string, std::string> split_name(const std::string& name) {
  const size_t dot = std::min(name.find('.'), name.size());
  return {name.substr(0, dot), name.substr(dot)};
}

// The two numbers of "a_b".
std::pair<std::string, std::string> split_pair(const std::string& text, const char* what) {
  const size_t sign = text.find('_');
  if (sign == std::string::npos) throw bad_request(fmt::format("{}: expected two whole numbers joined by '_', found '{}'", what, text.substr(0, 48)));
  return {text.substr(0, sign), text.substr(sign + 1)};
}

int level_of(const std::string* text, const GridReader& reader) {
  return text ? static_cast<int>(integer_in(*text, "level", 0, reader.levels() - 1)) : 0;
}

// "?outline=1".
bool switched_on(const Target& target, const char* name) {
  const std::string* text = target.find(name);
  return text && integer_in(*text, name, 0, 1) == 1;
}

// "?shares=1"; null for 0.
const FractionReader* asks_for_shares(const Target& target, const ServedGrid& grid) {
  if (!switched_on(target, "shares")) return nullptr;
  if (!grid.fractions) throw UsageError("shares: the grid has none: it was meshed without fractions");
  return grid.fractions.get();
}

// "?materials=1,3", "?outline=1" and "?shares=1".
PictureStyle style_of(const Target& target, const ServedGrid& grid) {
  const Metadata& meta = grid.meta();
  PictureStyle style;
  style.shares = asks_for_shares(target, grid);
  style.outline = switched_on(target, "outline");
  if (const std::string* list = target.find("materials")) {
    const size_t n = meta.materials.size();
    style.shown.assign(n, false);
    if (!list->empty())
      for (const std::string_view text : split(*list, ',')) {
        const auto id = plain_integer(text);
        if (!id || static_cast<size_t>(*id) >= n)
          throw bad_request(fmt::format("materials: expected ids from 0 to {} separated by commas, as the grid's description lists them, found '{}'",
                                        n - 1, text.substr(0, 48)));
        style.shown[static_cast<size_t>(*id)] = true;
      }
  }
  return style;
}

// A request below /api/v1/grids/{id}/: the grid, and the segments after the id.
struct GridRequest {
  Service& service;
  const Request& request;
  const Target& target;
  std::shared_ptr<const ServedGrid> grid;
  std::vector<std::string> rest;
  const GridReader& reader() const { return grid->reader(); }
  const Metadata& meta() const { return grid->meta(); }
};

bool asks_for_bodies(const GridRequest& r) {
  const bool asks = switched_on(r.target, "bodies");
  if (asks && !keeps_bodies(r.meta())) throw bad_request(fmt::format("bodies: grid '{}' keeps materials, not bodies", r.grid->id));
  return asks;
}

// make() returns JSON.
Response json_answer(const GridRequest& r, const char* route, std::function<std::string()> make) {
  return r.service.answer(r.request, r.target, r.grid, {.route = route, .content_type = kJson, .compress = true, .make = std::move(make)});
}

Response picture_answer(const GridRequest& r, const char* route, const SliceView& view) {
  Service::Recipe recipe = picture_recipe(r.reader(), view, style_of(r.target, *r.grid));
  recipe.route = route;
  return r.service.answer(r.request, r.target, r.grid, recipe);
}

Response info(const GridRequest& r) {
  r.target.allow({"v"});
  return json_answer(r, "info", [&] { return info_json(r.reader(), r.grid->id); });
}

Response slice(const GridRequest& r) {
  r.target.allow({"v", "level", "region", "materials", "outline", "shares"});
  const int axis = axis_of(r.rest[1]), level = level_of(r.target.find("level"), r.reader());
  const auto [index, extension] = split_name(r.rest[2]);
  if (extension != ".png") throw not_found(fmt::format("slices are .png, found '{}'", extension.substr(0, 48)));
  const Index3 n = r.meta().grid.cells(level);
  SliceView view = whole_slice(r.meta(), axis, integer_in(index, "index", 0, n[axis] - 1), level);
  if (const std::string* region = r.target.find("region")) {
    const auto c = integers(*region, 4, "region");
    view.u0 = c[0], view.v0 = c[1], view.u1 = c[2], view.v1 = c[3];
    check_view(r.meta(), view);
  }
  const auto width = static_cast<uint64_t>(view.u1 - view.u0), height = static_cast<uint64_t>(view.v1 - view.v0);
  if (const uint64_t most = r.service.options().max_pixels; height > most / width)
    throw bad_request(
        fmt::format("region: expected at most {} pixels, found {} x {}: ask for a part with region= or for a coarser level", most, width, height));
  return picture_answer(r, "slice", view);
}

Response tile(const GridRequest& r) {
  const int axis = axis_of(r.rest[1]), level = level_of(&r.rest[3], r.reader());
  const Index3 n = r.meta().grid.cells(level);
  SliceView view = whole_slice(r.meta(), axis, integer_in(r.rest[2], "index", 0, n[axis] - 1), level);
  const auto [place, extension] = split_name(r.rest[4]);
  const auto [col, row] = split_pair(place, "tile");
  const int64_t u = integer_in(col, "column", 0, Axis::kMaxCells), v = integer_in(row, "row", 0, Axis::kMaxCells);
  const auto tiles = [](int64_t cells) { return (cells + kTilePixels - 1) / kTilePixels; };
  if (u >= tiles(view.u1) || v >= tiles(view.v1))
    throw not_found(
        fmt::format("there is no tile {}_{}: level {} has columns 0 to {} and rows 0 to {}", u, v, level, tiles(view.u1) - 1, tiles(view.v1) - 1));
  view.u0 = u * kTilePixels, view.v0 = v * kTilePixels;
  view.u1 = std::min(view.u1, view.u0 + kTilePixels), view.v1 = std::min(view.v1, view.v0 + kTilePixels);
  if (extension == ".bin") {
    r.target.allow({"v", "sets", "bodies", "shares"});
    const bool sets = switched_on(r.target, "sets"), bodies = asks_for_bodies(r);
    const FractionReader* const shares = asks_for_shares(r.target, *r.grid);
    if (bodies && !sets) throw bad_request("bodies: expected sets=1 beside it");
    if (shares && !sets) throw bad_request("shares: expected sets=1 beside it");
    return r.service.answer(
        r.request, r.target, r.grid,
        {.route = "tile_bin", .content_type = "application/octet-stream", .compress = true, .make = [&] {
           return bodies ? raw_label_sets(r.reader(), view, shares) : sets ? raw_sets(r.reader(), view, shares) : raw_labels(r.reader(), view);
         }});
  }
  if (extension != ".png") throw not_found(fmt::format("tiles are .png or .bin, found '{}'", extension.substr(0, 48)));
  r.target.allow({"v", "materials", "outline", "shares"});
  return picture_answer(r, "tile", view);
}

// Of a list.
void write_material(JsonWriter& out, const Metadata& meta, uint32_t id) { out.begin_object().field("id", id).field("name", meta.materials[id].name); }

// What a cell of level 0 is made of, by material, and if it is mixed the plane of one: of `own`, its material, or of the one with the largest
// share where a sheet owns the cell.
void write_shares(JsonWriter& out, const Metadata& meta, const FractionReader& fractions, const Index3& cell, uint32_t own) {
  const uint32_t total = sub_samples(fractions.samples());
  std::map<uint32_t, uint32_t> counts;
  for (const auto& [label, count] : fractions.cell(cell)) counts[meta.labels[label].material] += count;
  if (counts.empty()) counts[own] = total;
  out.key("shares").begin_array();
  for (const auto& [id, count] : counts) {
    write_material(out, meta, id);
    out.field("share", static_cast<double>(count) / total).end_object();
  }
  out.end_array();
  if (counts.size() == 1) return;
  if (!counts.contains(own)) own = std::ranges::max_element(counts, {}, &std::pair<const uint32_t, uint32_t>::second)->first;
  if (const auto plane = cut_plane(fractions, meta.grid, cell, own)) {
    out.key("plane");
    write_material(out, meta, own);
    out.field("normal", plane->normal).field("offset", plane->offset).end_object();
  }
}

Response cell(const GridRequest& r) {
  r.target.allow({"v", "i", "j", "k", "level"});
  const int level = level_of(r.target.find("level"), r.reader());
  const Metadata& meta = r.meta();
  const Index3 n = meta.grid.cells(level);
  Box box;
  for (int d = 0; d < 3; ++d) {
    const std::string name(1, "ijk"[d]);
    const std::string* text = r.target.find(name);
    if (!text) throw bad_request(fmt::format("missing {}: expected a whole number from 0 to {}", name, n[d] - 1));
    box.lo[d] = integer_in(*text, name, 0, n[d] - 1);
    box.hi[d] = box.lo[d] + 1;
  }
  return json_answer(r, "cell", [&, box] {
    std::string text;
    JsonWriter out(text);
    out.begin_object().field("schema", 1).field("index", box.lo).field("level", level).key("centre").begin_array();
    for (int d = 0; d < 3; ++d) {
      const Axis& a = meta.grid.axis[d];
      const int64_t first = box.lo[d] << level, last = std::min(a.cells(), box.hi[d] << level);
      out.value(level == 0 ? a.centre(first) : (a.plane(first) + a.plane(last)) / 2);
    }
    out.end_array();
    for_each_run(r.reader(), level, box, [&](const BoxRun& run) {  // the cell is a single run
      const auto materials = materials_of(meta, *run.set);
      out.key("materials").begin_array();
      for (const uint32_t m : materials) {
        write_material(out, meta, m);
        out.end_object();
      }
      out.end_array();
      if (keeps_bodies(meta)) {
        out.key("bodies").begin_array();
        for (const Label label : *run.set) {
          const LabelInfo& info = meta.labels[label];
          out.begin_object().field("label", label).field("name", info.body).field("material", info.material).end_object();
        }
        out.end_array();
      }
      if (level == 0 && r.grid->fractions) write_shares(out, meta, *r.grid->fractions, box.lo, materials[0]);
    });
    out.end_object();
    return text;
  });
}

Response column(const GridRequest& r) {
  r.target.allow({"v", "from", "to"});
  const int axis = axis_of(r.rest[1]);
  const RayFrame f = RayFrame::along(axis);
  const Index3 n = r.meta().grid.cells();
  const auto [a_text, b_text] = split_pair(r.rest[2], "column");
  const int64_t a = integer_in(a_text, axis_name(f.u), 0, n[f.u] - 1), b = integer_in(b_text, axis_name(f.v), 0, n[f.v] - 1);
  int64_t from = 0, to = n[axis];
  if (const std::string* text = r.target.find("from")) from = integer_in(*text, "from", 0, n[axis] - 1);
  if (const std::string* text = r.target.find("to")) to = integer_in(*text, "to", from + 1, n[axis]);
  return r.service.answer(r.request, r.target, r.grid, {.route = "column", .content_type = kJson, .compress = true, .parts = [&] {
                                                          return column_parts(r.reader(), axis, a, b, from, to);
                                                        }});
}

// "?region=X0,Y0,Z0,X1,Y1,Z1"; the whole grid without it.
Box region_of(const GridRequest& r) {
  Box box = r.meta().grid.box(0);
  if (const std::string* region = r.target.find("region")) {
    const auto c = integers(*region, 6, "region");
    const Index3 n = r.meta().grid.cells();
    for (int d = 0; d < 3; ++d) {
      box.lo[d] = c[d], box.hi[d] = c[d + 3];
      if (box.lo[d] < 0 || box.hi[d] > n[d] || box.lo[d] >= box.hi[d])
        throw bad_request(
            fmt::format("region: expected a part of 0 to {} along {} (half open, not empty), found {} to {}", n[d], axis_name(d), c[d], c[d + 3]));
    }
  }
  return box;
}

// The materials along a straight line.
Response line(const GridRequest& r) {
  r.target.allow({"v", "from", "to"});
  std::array<Vec3, 2> ends;
  // Where along a line it passes from cell to cell is computed in doubles: its ends may not be so far away that these lose the cells.
  double reach = 0;
  for (const Axis& axis : r.meta().grid.axis) reach = std::max({reach, kFarthestEnd * std::abs(axis.min()), kFarthestEnd * std::abs(axis.max())});
  for (const int i : {0, 1}) {
    const char* name = i == 0 ? "from" : "to";
    const std::string* text = r.target.find(name);
    if (!text) throw bad_request(fmt::format("missing {}: expected X,Y,Z, coordinates in {}", name, r.meta().units));
    const auto c = reals(*text, 3, name);
    if (std::ranges::any_of(c, [&](double x) { return !(std::abs(x) <= reach); }))
      throw bad_request(fmt::format("{}: expected three numbers up to {:.6g}, found '{}'", name, reach, *text));
    ends[static_cast<size_t>(i)] = {c[0], c[1], c[2]};
  }
  if (ends[0] == ends[1]) throw bad_request("to: expected another point than from");
  double cells = 1;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = r.meta().grid.axis[d];
    const auto cell = [&](double x) { return static_cast<double>(axis.cell_at(std::clamp(x, axis.min(), axis.max()))); };
    cells += std::abs(cell(ends[1][static_cast<size_t>(d)]) - cell(ends[0][static_cast<size_t>(d)]));
  }
  if (cells > kMostLineCells) throw bad_request(fmt::format("to: expected a line through at most {:.0f} cells, found {:.0f}", kMostLineCells, cells));
  return json_answer(r, "line", [&, ends] { return line_json(r.meta(), ends[0], ends[1], read_line(r.reader(), ends[0], ends[1])); });
}

// "box.npy", "box.vti" and "box.vtr".
Response box_file(const GridRequest& r, const std::string& ending) {
  r.target.allow({"v", "region"});
  if (ending != ".npy" && ending != ".vti" && ending != ".vtr")
    throw not_found(fmt::format("boxes are .npy, .vti or .vtr, found '{}'", ending.substr(0, 48)));
  if (ending == ".vti" && std::ranges::any_of(r.meta().grid.axis, &Axis::is_graded))
    throw not_found(fmt::format("an axis of grid '{}' is graded: ask for box.vtr", r.grid->id));
  const BoxFormat format = ending == ".npy" ? BoxFormat::kNpy : ending == ".vti" ? BoxFormat::kVti : BoxFormat::kVtr;
  const Box box = region_of(r);
  double cells = 1;
  for (int d = 0; d < 3; ++d) cells *= static_cast<double>(box.hi[d] - box.lo[d]);
  if (cells > kMostBoxCells)
    throw bad_request(
        fmt::format("region: expected at most {} cells, found {}: `teracell export {}.tcell -o box{} --region {},{},{},{},{},{}` writes them",
                    static_cast<int64_t>(kMostBoxCells), static_cast<int64_t>(cells), r.grid->id, ending, box.lo[0], box.lo[1], box.lo[2], box.hi[0],
                    box.hi[1], box.hi[2]));
  if (format == BoxFormat::kVtr) expect_few_planes({box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]});
  const char* type = format == BoxFormat::kNpy ? "application/octet-stream" : "application/xml";
  return r.service.answer(r.request, r.target, r.grid, {.route = "box", .content_type = type, .compress = true, .parts = [&, box, format] {
                                                          return box_parts(r.reader(), box, format);
                                                        }});
}

// The grid's file as it is.
Response file(const GridRequest& r) {
  r.target.allow({"v"});
  return r.service.answer(r.request, r.target, r.grid,
                          {.route = "file", .content_type = "application/octet-stream", .parts = [&] { return file_parts(r.reader().source()); }});
}

Response stats(const GridRequest& r) {
  r.target.allow({"v", "region", "bodies"});
  const bool bodies = asks_for_bodies(r);
  const Box box = region_of(r);
  return json_answer(r, "stats", [&, box, bodies] {
    const auto stats = read_label_stats(r.reader(), box);
    return bodies ? body_stats_json(r.meta(), box, stats) : stats_json(r.meta(), box, stats_by_material(r.meta(), stats));
  });
}

// What `teracell check` has found. It is kept beside the file, and may come or change while the grid stays the same.
Response findings(const GridRequest& r) {
  r.target.allow({});
  std::string text = r.grid->path.empty() ? "" : read_kept_findings(r.grid->path, r.grid->hash);
  if (text.empty()) throw not_found(fmt::format("nobody has looked through this version of grid '{}' yet: `teracell check` does", r.grid->id));
  Service::Recipe recipe{.route = "check", .content_type = kJson, .cacheable = false, .compress = true, .make = [&text] { return text; }};
  recipe.address = text;
  return r.service.answer(r.request, r.target, r.grid, recipe);
}

Response list(Service& service, const Target& target, std::span<const Protocol> protocols) {
  target.allow({});
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).key("grids").begin_array();
  for (const auto& grid : service.grids().all()) {
    out.begin_object().field("id", grid->id).field("name", grid->id).field("cells", grid->meta().grid.cells());
    out.field("bytes", grid->reader().file_bytes()).field("hash", grid->hash).field("units", grid->meta().units).key("modified");
    if (grid->modified) out.value(*grid->modified);
    else out.value(nullptr);
    out.field("checked", !grid->path.empty() && has_kept_findings(grid->path, grid->hash)).key("protocols").begin_array();
    for (const Protocol& p : protocols) out.begin_object().field("title", p.title).field("path", address_of(p, *grid)).end_object();
    out.end_array().end_object();
  }
  out.end_array().key("unreadable").begin_array();
  for (const auto& [id, error] : service.grids().unreadable()) out.begin_object().field("id", id).field("error", error).end_object();
  out.end_array().end_object();
  Response r;
  r.route = "grids";
  r.content_type = kJson;
  r.cache_control = "no-cache";
  r.body = body_of(std::move(text));
  return r;
}

// Of the picture or the part of it that "view.bin" is asked for, as far as the target says; the route refuses what makes no sense.
double pixels_asked_for(const Target& target) {
  const std::string *window = target.find("window"), *size = target.find("size");
  if (window) {
    const auto n = integers(*window, 4, "window");
    // The differences of any whole numbers fit into doubles, not into integers.
    return (static_cast<double>(n[2]) - static_cast<double>(n[0])) * (static_cast<double>(n[3]) - static_cast<double>(n[1]));
  }
  if (!size) return kMostSeenPixels + 1;
  const auto n = integers(*size, 2, "size");
  return static_cast<double>(n[0]) * static_cast<double>(n[1]);
}

}  // namespace

HttpError no_such_address(const Request& request) {
  return not_found(fmt::format("there is nothing at this address: {}/openapi.json lists the addresses", request.prefix));
}

Response answer_api(Service& service, const Request& request, const Target& target, std::span<const Protocol> protocols) {
  const auto& path = target.path;  // "api", "v1", "grids", id, what, ...
  if (path.size() < 3 || path[1] != "v1" || path[2] != "grids") throw no_such_address(request);
  if (path.size() == 3) return list(service, target, protocols);
  const GridRequest r{service, request, target, service.grids().find(path[3]), {path.begin() + 4, path.end()}};
  const auto is = [&](const char* name, size_t segments) { return r.rest.size() == segments && r.rest[0] == name; };
  if (r.rest.empty()) return info(r);
  if (is("slice", 3)) return slice(r);
  if (is("tile", 5)) return tile(r);
  if (is("cell", 1)) return cell(r);
  if (is("column", 3)) return column(r);
  if (is("line", 1)) return line(r);
  if (is("stats", 1)) return stats(r);
  if (is("check", 1)) return findings(r);
  if (is("file.tcell", 1)) return file(r);
  if (is("diff", 1)) return service.answer(request, target, r.grid, diff_recipe(service, *r.grid, target));
  const auto [name, ending] = split_name(r.rest[0]);
  if (name == "box" && r.rest.size() == 1) return box_file(r, ending);
  if (name == "view" && r.rest.size() == 1)
    if (const auto recipe = view_recipe(service, *r.grid, target, ending)) return service.answer(request, target, r.grid, *recipe);
  throw no_such_address(request);
}

Cost cost_of_api(const Target& target) {
  const std::vector<std::string>& path = target.path;
  if (path.size() <= 4) return Cost::kCheap;
  const std::string& what = path[4];
  if (what == "view.json" || what == "line" || what == "column") return Cost::kSeen;
  if (what == "view.bin" && pixels_asked_for(target) <= kMostSeenPixels) return Cost::kSeen;
  const bool dear =
      what == "stats" || what == "slice" || what == "diff" || what == "file.tcell" || what.starts_with("box.") || what.starts_with("view.");
  return dear ? Cost::kDear : Cost::kCheap;
}

Response answered(Service& service, const std::function<Response()>& answer) {
  try {
    try {
      return answer();
    } catch (const Replaced&) {  // a file that was replaced while it was closed is looked at now, instead of within half a second
      service.grids().recheck();
      return answer();
    }
  } catch (const Unwanted&) {
    throw;  // there is nobody to answer
  } catch (const Replaced& e) {
    return try_again("replaced", e.what());
  } catch (const HttpError& e) {
    if (e.status == 500) service.unreadable();
    return error_response(e.status, e.code, e.what());
  } catch (const UsageError& e) {
    return error_response(400, "bad_request", e.what());
  } catch (const FormatError& e) {
    service.damaged(e.what());
    return error_response(500, "damaged", e.what());
  } catch (const IoError& e) {
    service.damaged(e.what());
    return error_response(500, "unreadable", e.what());
  } catch (const std::bad_alloc&) {
    return try_again("out_of_memory", "the server is out of memory: ask for less, or try again later");
  } catch (const std::exception& e) {
    return error_response(500, "failed", e.what());
  }
}

}  // namespace teracell::server

// teracell slice: one slice as a picture or an array.
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "server/picture/leaf_lines.hpp"
#include "server/picture/picture.hpp"
#include "server/picture/to_scale.hpp"
#include "server/render/plane.hpp"
#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "store/text/npy_header.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {
namespace {

constexpr int64_t kLongerSide = 1024, kLongestSide = 1 << 20;  // pixels of a picture to scale

struct SliceArguments {
  GridArgument grid;
  std::string output, axis, region;
  std::optional<int64_t> index;
  std::optional<double> at;
  bool to_scale = false;
  std::optional<int64_t> pixels;
  std::optional<int> given_level;
  int level = 0, threads = 0;
  std::optional<std::string> refine, want;
  std::map<std::string, std::string, std::less<>> plane;  // those of plane_options() that slices across an axis don't have
};

SliceView view_of(const SliceArguments& o, const Metadata& meta) {
  const int axis = parse_axis(o.axis);
  if (o.index.has_value() == o.at.has_value())
    throw UsageError(fmt::format("--index, --at: expected one of them, found {}", o.at ? "both" : "neither"));
  check_level(meta.grid, o.level);
  int64_t index = o.index.value_or(0);
  if (o.at) index = cell_of(*o.at, meta, axis, "--at") >> o.level;
  if (const int64_t cells = meta.grid.cells(o.level)[axis]; index < 0 || index >= cells)
    throw UsageError(fmt::format("--index: expected 0 to {} along {} on level {}, found {}", cells - 1, o.axis, o.level, index));
  SliceView view = whole_slice(meta, axis, index, o.level);
  if (!o.region.empty()) {
    const auto n = parse_integers(o.region, 4, "--region");
    view.u0 = n[0], view.v0 = n[1], view.u1 = n[2], view.v1 = n[3];
    check_region(meta.grid, o.level, RayFrame::along(axis).u, view.u0, view.u1);
    check_region(meta.grid, o.level, RayFrame::along(axis).v, view.v0, view.v1);
  }
  return view;
}

// The columns and the rows of the picture: which cell each shows, from the lowest. None: it has a pixel per cell.
struct Pixels {
  std::vector<int64_t> u, v;
};

Pixels pixels_of(const SliceArguments& o, const SliceView& view, const Grid& grid) {
  if (!o.to_scale) return {};
  const RayFrame frame = RayFrame::along(view.axis);
  const Axis &u = grid.axis[frame.u], &v = grid.axis[frame.v];
  const double shape = server::length_of(v, view.level, view.v0, view.v1) / server::length_of(u, view.level, view.u0, view.u1);
  const bool upright = !o.pixels && shape > 1;
  const int64_t width = upright ? std::max<int64_t>(1, std::llround(kLongerSide / shape)) : o.pixels.value_or(kLongerSide);
  const double height = upright ? kLongerSide : std::max(1.0, std::round(static_cast<double>(width) * shape));
  if (width < 1 || width > kLongestSide) throw UsageError(fmt::format("--pixels: expected 1 to {}, found {}", kLongestSide, width));
  if (height > kLongestSide)
    throw UsageError(fmt::format("--pixels: expected a picture that is at most {} pixels high, found {}, with which it is {:.0f} high", kLongestSide,
                                 width, height));
  return {server::cells_to_scale(u, view.level, view.u0, view.u1, width),
          server::cells_to_scale(v, view.level, view.v0, view.v1, static_cast<int64_t>(height))};
}

void write_png(const GridReader& reader, const SliceView& view, const SliceArguments& o, OutputFile& file) {
  const Pixels pixels = pixels_of(o, view, reader.meta().grid);
  const int64_t width = o.to_scale ? std::ssize(pixels.u) : view.u1 - view.u0, height = o.to_scale ? std::ssize(pixels.v) : view.v1 - view.v0;
  server::SetColors colors(reader.meta(), view.level);
  const int threads = threads_or_all(o.threads);
  std::optional<Leaves> leaves;
  std::optional<server::LeafLines> lines;
  if (o.refine) {
    leaves.emplace(reader, parse_refinement(reader.meta(), *o.refine, o.want.value_or(""), "--refine", "--want"), temporary_folder());
    leaves->prepare(cells_below(view), threads, [](double) { Wanted::stop_if_not(); });
    const auto all = [](int64_t from, int64_t to) {
      std::vector<int64_t> out(static_cast<size_t>(to - from));
      std::iota(out.begin(), out.end(), from);
      return out;
    };
    lines.emplace(*leaves, view, o.to_scale ? pixels.u : all(view.u0, view.u1), o.to_scale ? pixels.v : all(view.v0, view.v1), threads, colors);
  }
  server::PngWriter png(static_cast<uint32_t>(width), static_cast<uint32_t>(height), colors,
                        [&](std::span<const uint8_t> bytes) { file.append(bytes); });
  int64_t number = height;  // of the row of pixels that was written last
  std::vector<uint16_t> drawn;
  const auto append = [&](std::span<const uint16_t> row) {  // a whole row where there are lines
    --number;
    if (!lines) return png.append(row);
    drawn.assign(row.begin(), row.end());
    lines->draw(number, drawn);
    png.append(drawn);
  };
  std::vector<uint16_t> line(lines ? static_cast<size_t>(width) : pixels.u.size());
  size_t column = 0, rows = pixels.v.size();  // the next one, and how many are left
  int64_t u = view.u0;
  for_each_row(reader, view, colors.value(), true, threads, [&](int64_t v, std::span<const uint16_t> row) {
    Wanted::stop_if_not();
    if (!o.to_scale && lines) {  // rows may come in parts
      std::ranges::copy(row, line.begin() + (u - view.u0));
      u += std::ssize(row);
      if (u < view.u1) return;
      u = view.u0;
      return append(line);
    }
    if (!o.to_scale) return png.append(row);
    for (; column < line.size() && pixels.u[column] < u + std::ssize(row); ++column) line[column] = row[static_cast<size_t>(pixels.u[column] - u)];
    u += std::ssize(row);
    if (u < view.u1) return;
    for (; rows > 0 && pixels.v[rows - 1] == v; --rows) append(line);
    u = view.u0, column = 0;
  });
  png.finish();
}

// Row 0 is v = v0, in the order of the indices. A picture has its highest v on top.
void write_npy(const GridReader& reader, const SliceView& view, const SliceArguments& o, OutputFile& file) {
  const bool wide = wide_labels(reader.meta());
  file.append(npy_header(wide ? "<u2" : "|u1", {view.v1 - view.v0, view.u1 - view.u0}));
  Bytes bytes;
  for_each_row(reader, view, strongest_material(reader.meta()), false, threads_or_all(o.threads), [&](int64_t, std::span<const uint16_t> row) {
    Wanted::stop_if_not();
    bytes.clear();
    put_labels(bytes, row, wide);
    file.append(bytes);
  });
}

PlaneView plane_of(const SliceArguments& o, const Grid& grid) {
  auto words = o.plane;
  if (o.pixels) words["pixels"] = std::to_string(*o.pixels);
  if (o.given_level) words["level"] = std::to_string(*o.given_level);
  const auto given = [&](std::string_view name) -> const std::string* {
    const auto it = words.find(name);
    return it == words.end() ? nullptr : &it->second;
  };
  return server::parse_plane_view(given, grid, "--");
}

void write_plane_png(const GridReader& reader, const PlaneView& view, int threads, OutputFile& file) {
  server::SetColors colors(reader.meta(), view.level);
  const uint16_t outside = colors.number_of({0, 0, 0, 0});
  server::PngWriter png(static_cast<uint32_t>(view.i1), static_cast<uint32_t>(view.j1), colors,
                        [&](std::span<const uint8_t> bytes) { file.append(bytes); });
  for_each_plane_row(reader, view, colors.value(), outside, true, threads, [&](int64_t, std::span<const uint16_t> row) { png.append(row); });
  png.finish();
}

// Material 0 outside the grid.
void write_plane_npy(const GridReader& reader, const PlaneView& view, int threads, OutputFile& file) {
  const bool wide = wide_labels(reader.meta());
  file.append(npy_header(wide ? "<u2" : "|u1", {view.j1, view.i1}));
  Bytes bytes;
  for_each_plane_row(reader, view, strongest_material(reader.meta()), 0, false, threads, [&](int64_t, std::span<const uint16_t> row) {
    bytes.clear();
    put_labels(bytes, row, wide);
    file.append(bytes);
  });
}

// What a picture of a plane can't have, and what only it can.
void check_options(const SliceArguments& o) {
  const bool is_plane = o.plane.contains("plane");
  if (is_plane != o.axis.empty()) throw UsageError(fmt::format("--axis, --plane: expected one of them, found {}", is_plane ? "both" : "neither"));
  const auto refuse = [&](bool given, std::string_view option) {
    if (given)
      throw UsageError(
          fmt::format("--{}: expected {}", option, is_plane ? "a slice across an axis, found --plane" : "--plane too, found a slice across an axis"));
  };
  if (is_plane) {
    refuse(o.index.has_value(), "index");
    refuse(o.at.has_value(), "at");
    refuse(!o.region.empty(), "region");
    refuse(o.refine.has_value(), "refine");
    refuse(o.to_scale, "true");
  } else {
    for (const char* name : {"size", "centre", "pixel"}) refuse(o.plane.contains(name), name);
  }
}

void run(const SliceArguments& o) {
  const std::string extension = std::filesystem::path(o.output).extension();
  if (extension != ".png" && extension != ".npy")
    throw UsageError(fmt::format("--output: expected a name that ends in .png or .npy, found '{}'", o.output));
  if (o.refine && (extension == ".npy" || o.level != 0))
    throw UsageError(fmt::format("--refine: expected a picture of level 0, on which leaves are drawn, found {}",
                                 o.level != 0 ? fmt::format("level {}", o.level) : "an array"));
  if (o.want && !o.refine) throw UsageError("--want: expected --refine M,N with it, found none");
  if (o.to_scale && extension == ".npy") throw UsageError("--true: expected a picture, found an array: its cells have no widths");
  check_options(o);
  const bool is_plane = o.axis.empty();
  if (o.pixels && !o.to_scale && !is_plane) throw UsageError("--pixels: expected --true or --plane too: other pictures have a pixel per cell");
  check_output({o.grid.name}, o.output);
  const GridReader reader = open_grid(o.grid);
  if (is_plane) {
    const PlaneView view = plane_of(o, reader.meta().grid);
    const Wanted wanted = until_interrupted(o.output);
    OutputFile file(o.output);
    (extension == ".png" ? write_plane_png : write_plane_npy)(reader, view, threads_or_all(o.threads), file);
    return file.commit();
  }
  const SliceView view = view_of(o, reader.meta());
  const Wanted wanted = until_interrupted(o.output);
  OutputFile file(o.output);
  if (extension == ".png") write_png(reader, view, o, file);
  else write_npy(reader, view, o, file);
  file.commit();
}

}  // namespace

Run setup_slice(CLI::App& app) {
  const auto o = std::make_shared<SliceArguments>();
  add_grid(app, o->grid);
  app.add_option("--axis", o->axis, "the axis that the slice is across: x, y or z");
  app.add_option("--index", o->index, "which slice, counted in cells of the level");
  app.add_option("--at", o->at, "the coordinate that the slice holds, instead of --index");
  app.add_option("-o,--output", o->output, "a .png (v points up) or an .npy (material ids, shape [v][u], row 0 is v = 0)")->required();
  app.add_option_function<int>(
      "--level", [o](int level) { o->given_level = o->level = level; },
      "the level of the pyramid: its cells are 2^level times as wide (default 0; of a plane, the highest whose cells are at most as wide as a pixel)");
  app.add_option("--region", o->region, "U0,V0,U1,V1: half open, in cells of the level; z-slices have u = x, v = y; y-slices x, z; x-slices y, z");
  app.add_option("--refine", o->refine, "M,N: with lines between the leaves of the grid refined so, as for export");
  app.add_option("--want", o->want, "what is to be how fine, as for export");
  app.add_flag("--true", o->to_scale, "a picture to scale, where an axis is graded; otherwise a pixel is a cell");
  app.add_option("--pixels", o->pixels, fmt::format("its width (default: its longer side has {})", kLongerSide));
  for (const server::RenderOption& option : server::plane_options()) {
    const std::string name(option.name);
    if (app.get_option_no_throw("--" + name) == nullptr)
      add_word(app, "--" + name, std::string(option.value), std::string(option.help), [o, name](const std::string& text) { o->plane[name] = text; });
  }
  add_threads(app, o->threads);
  app.footer(
      "Examples:\n  teracell slice g.tcell --axis z --index 500 -o z.png\n  teracell slice g.tcell --axis x --at 12.5 --level 2 -o x.npy\n  teracell slice g.tcell --plane 45,30,0,0,0 -o cut.png");
  return [o] { run(*o); };
}

}  // namespace teracell::cli

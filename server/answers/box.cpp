// The material ids of a box as a file: "box.npy", "box.vti" and "box.vtr".
#include "server/answers/answers.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/parts/box_parts.hpp"
#include "store/grid/vtk_header.hpp"

namespace teracell::server {
namespace {

constexpr double kMostBoxCells = 4294967296.0;  // 2^32

Response answer_box(const GridRequest& r) {
  r.target.allow({"v", "region"});
  const std::string ending = split_name(r.rest[0]).second;
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
  return r.answer({.route = "box", .content_type = type, .compress = true, .parts = [&, box, format] { return box_parts(r.reader(), box, format); }});
}

}  // namespace

const Answer kBoxAnswer = {"box.", 1, Cost::kDear, answer_box};

}  // namespace teracell::server

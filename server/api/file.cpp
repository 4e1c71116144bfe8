// The grid's file as it is.
#include "server/api/answers.hpp"

#include "server/parts/file_parts.hpp"

namespace teracell::server {
namespace {

Response answer_file(const GridRequest& r) {
  r.target.allow({"v"});
  return r.answer({.route = "file", .content_type = "application/octet-stream", .parts = [&] { return file_parts(r.reader().source()); }});
}

}  // namespace

const Answer kFileAnswer = {"file.tcell", 1, Cost::kDear, answer_file};

}  // namespace teracell::server

// The cell nearest to another one that has some material, and another material in a second grid: where to look for a change.
#include "server/answers/answers.hpp"

#include <fmt/format.h>

#include "server/render/cells/differing.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::server {
namespace {

Response answer_changed(const GridRequest& r) {
  r.target.allow({"v", "with", "from", "to", "cell", "region"});
  const auto text = [&](const char* name, const char* expected) -> const std::string& {
    const std::string* const out = r.target.find(name);
    if (!out) throw bad_request(fmt::format("missing {}: expected {}", name, expected));
    return *out;
  };
  const std::shared_ptr<const ServedGrid> other = r.service.grids().find(text("with", "the id of a second grid"));
  const std::string &from = text("from", "the name of a material of this grid"), &to = text("to", "the name of a material of the second grid");
  const auto make = [&r, other, from, to, box = region_of(r), cell = cell_asked_for(r)] {
    // The answer is kept for the grids of this moment.
    if (r.service.grids().find(other->id)->number != other->number) throw Replaced("grid '" + other->id + "' was replaced");
    std::string out;
    Differing differing(r.reader(), other->reader(), true);
    JsonWriter(out).begin_object().field("schema", 1).field("cell", differing.nearest(from, to, cell, box)).end_object();
    return out;
  };
  return r.answer({.route = "changed", .content_type = kJsonType, .make = make, .address = other->hash});
}

}  // namespace

const Answer kChangedAnswer = {"changed", 1, Cost::kSeen, answer_changed};

}  // namespace teracell::server

// Which cells of two served grids have different materials: what `teracell diff --json` prints.
#include "server/answers/answers.hpp"

#include "store/base/wanted.hpp"
#include "store/compare/difference_counts.hpp"
#include "store/compare/equal_cells.hpp"
#include "store/whole/info.hpp"

namespace teracell::server {
namespace {

// Several clients may ask at the same time.
constexpr size_t kMemory = size_t{64} << 20;  // for runs of the second grid
constexpr size_t kMostChanges = size_t{1} << 16;

// Throws bad_request for what f() throws of grids that can't be compared.
template <class F>
auto refused_in_words(F&& f) try {
  return f();
} catch (const InputError& e) {
  throw bad_request(e.what());
}

Response answer_diff(const GridRequest& r) {
  r.target.allow({"with"});
  const std::string* with = r.target.find("with");
  if (!with) throw bad_request("missing with: expected the id of the grid to compare with, as /api/v1/grids lists it");
  const std::shared_ptr<const ServedGrid> other = r.service.grids().find(*with);
  refused_in_words([&] { expect_equal_cells(r.reader(), other->reader()); });
  const auto make = [&r, other] {
    // The answer is kept for the grids of this moment.
    if (r.service.grids().find(other->id)->number != other->number) throw Replaced("grid '" + other->id + "' was replaced");
    DifferenceOptions options;
    options.memory = kMemory;
    options.most_changes = kMostChanges;
    const auto go_on = [](double) { Wanted::stop_if_not(); };
    return difference_json(refused_in_words([&] { return count_difference(r.reader(), other->reader(), options, go_on); }));
  };
  // The address names neither version, so a client asks each time, and the ETag tells both.
  return r.answer({.route = "diff", .content_type = kJsonType, .compress = true, .make = make, .address = other->hash});
}

}  // namespace

const Answer kDiffAnswer = {"diff", 1, Cost::kDear, answer_diff};

}  // namespace teracell::server

// Planes between candidates: as few cells as there can be, no wider than allowed, of which neighbours differ by at most a factor.
#pragma once
#include <vector>

#include "mesher/planes/segments.hpp"
#include "mesher/planes/widths.hpp"

namespace teracell::mesher {

// Planes that ascend and hold all of `kept` bit for bit, by these rules: no cell is narrower than `finest` where no gap is; none is wider than
// `widths` says where whole cells can be less; neighbours differ by at most `growth` where cells beside a short gap (segments.hpp) can do so.
// Where `kept` and `widths` are symmetric, to 1e-12 of the extent, so are the planes. `most` cells are a UsageError.
// REQUIRES: `kept` ascends, and has two or more; 0 < finest; growth > 1.
std::vector<double> fill_between(const std::vector<double>& kept, const Widths& widths, double finest, double growth, int64_t most);

}  // namespace teracell::mesher

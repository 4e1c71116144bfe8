// What the report in the file tells: what only the mesher could know.
#pragma once
#include "store/check/finding.hpp"
#include "store/grid/metadata.hpp"

namespace teracell::inline store {

// Adds to the findings. `report`: the JSON of the file, which is read body by body, so that a million bodies take no memory; `meta`: of
// the file. Returns of each label whether sheets alone have it. Throws FormatError when it is no such report.
std::vector<bool> add_reported(Findings& findings, const std::string& report, const Metadata& meta);

// Adds a finding; those beyond kMostFindings of a kind are only counted.
void add_finding(Findings& findings, Finding finding);

}  // namespace teracell::store

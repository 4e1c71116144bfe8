// The report as JSON: the only place that knows its keys (REPORT.md). A file holds 64 MiB of it at most (store/FORMAT.md), so the
// lists of very many bodies, holes or flips are cut, and the report says how many items are left out.
#pragma once
#include <string>

#include "mesher/report/report.hpp"
#include "mesher/run/run_report.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell::mesher {

std::string report_json(const Report& report, const Scene& scene);
// The same with the keys of one run beside it, and with these warnings instead of the report's.
std::string report_json(const Report& report, const Scene& scene, const RunReport& run, const std::vector<std::string>& warnings);
// The keys that are missing leave their defaults: reports of earlier versions are read. Throws FormatError for what is no report.
Report parse_report(const std::string& json);

}  // namespace teracell::mesher

// The report of a run as JSON (store/format/report_json.hpp), with its scene.
#pragma once
#include <string>

#include "mesher/run/run_report.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell::mesher {

std::string report_json(const Report& report, const Scene& scene);
// The same with the keys of one run beside it, and with these warnings instead of the report's.
std::string report_json(const Report& report, const Scene& scene, const RunReport& run, const std::vector<std::string>& warnings);

}  // namespace teracell::mesher

// The report as JSON: the only place that knows its keys (mesher/REPORT.md). A file holds 64 MiB of it at most (FORMAT.md), so the
// lists of very many bodies, holes or flips are cut, and the report says how many items are left out.
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "store/grid/report.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::inline store {

inline constexpr size_t kMostOfScene = size_t{15} << 20;  // bytes

// With these warnings instead of the report's. `scene`: the scene as JSON, of at most kMostOfScene bytes; if it is longer, it may be left out.
std::string write_report(const Report& report, const std::vector<std::string>& warnings, const std::string& scene);

// The list of breaches.
void write_breaches(JsonWriter& out, const PlanesReport& planes);

// Keys that are missing leave their defaults: reports of earlier versions are read. `take` gets the bodies one by one, and of the rest of
// the text no more is in memory at a time than one item of a list; the report that is returned has no bodies. Nothing is returned where
// the JSON has no list of bodies. Throws FormatError for what is no report.
std::optional<Report> read_report(const std::string& text, const std::function<void(BodyReport&&)>& take);
// The whole report. A text without a list of bodies is a FormatError, too.
Report parse_report(const std::string& text);

}  // namespace teracell::inline store

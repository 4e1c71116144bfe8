// What mesh and merge say when they are done.
#pragma once
#include "mesher/pipeline.hpp"
#include "mesher/run/dry_run.hpp"
#include "store/base/output_file.hpp"

namespace teracell::cli {

std::string size_text(const Index3& cells);   // "1,200 x 30 x 4"
std::string cells_text(const Index3& cells);  // "1,200 x 30 x 4 = 144,000"
std::string axis_text(int d, const Axis& axis, const std::string& units);  // its domain and its cells, in one line
std::vector<std::string> breach_lines(const PlanesReport& planes, const std::string& units);
void say_dry_run(const mesher::DryRun& run, int threads);
// In one line, without a line feed; empty when there are none.
std::string overlaps_text(const Report& report);
void say_grid(const std::string& output, const mesher::MeshReport& report);  // in short, with warnings
void say_part(const std::string& part, const mesher::MeshReport& report);
// Writes the whole report. Throws IoError that says that `output` is complete.
void write_report(const mesher::MeshReport& report, OutputFile& file, const std::string& output);

}  // namespace teracell::cli

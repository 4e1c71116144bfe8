#include "mesher/report/report_json.hpp"

#include "store/format/report_json.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::mesher {
namespace {

void write_run(JsonWriter& out, const RunReport& run) {
  out.key("trust").begin_array();
  for (const auto& [body, trust] : run.trust) {
    out.begin_object().field("body", body).field("points", trust.points).field("disagree", trust.disagree);
    if (trust.disagree > 0) out.field("at", trust.at).key("box").begin_array().value(trust.lo).value(trust.hi).end_array();
    out.end_object();
  }
  out.end_array().key("phases").begin_array();
  for (const auto& [name, seconds] : run.phases) out.begin_object().field("name", name).field("seconds", seconds).end_object();
  out.end_array().field("peak_memory_bytes", run.peak_memory_bytes).field("threads", run.threads).field("engine", run.engine);
  out.field("exact_decisions", run.exact_decisions).field("spilled_bytes", run.spilled_bytes).field("resumed_chunks", run.resumed_chunks);
  out.field("file_bytes", run.file_bytes);
}

}  // namespace

std::string report_json(const Report& report, const Scene& scene) { return write_report(report, report.warnings, normalised(scene, kMostOfScene)); }

std::string report_json(const Report& report, const Scene& scene, const RunReport& run, const std::vector<std::string>& warnings) {
  std::string text = write_report(report, warnings, normalised(scene, kMostOfScene));
  text.pop_back();
  JsonWriter out(text);
  write_run(out, run);
  out.end_object();
  return text;
}

}  // namespace teracell::mesher

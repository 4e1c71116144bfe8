#include "mesher/survey/survey_json.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "store/text/json_writer.hpp"

namespace teracell::mesher {
namespace {

// "stl" for "STL (binary)".
std::string format_word(const std::string& format) {
  std::string word = format.substr(0, format.find(' '));
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word;
}

void text_or_null(JsonWriter& json, std::string_view name, const std::string& text) {
  if (text.empty()) json.field(name, nullptr);
  else json.field(name, text);
}

void write_box(JsonWriter& json, const Vec3& lo, const Vec3& hi) {
  json.field("box", std::span<const double>(std::array{lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]}));
}

void write_kind(JsonWriter& json, const PartKind& k) {
  json.begin_object().field("path", k.path);
  text_or_null(json, "product", k.product);
  json.field("instances", k.instances).field("facets", k.facets).field("closed", k.closed).field("open_edges", k.open_edges);
  write_box(json, k.lo, k.hi);
  json.field("volume", k.volume);
  json.field("kernel_volume", k.kernel_volume);
  json.field("sender_volume", k.sender_volume);
  json.field("area", k.area);
  text_or_null(json, "color", k.color);
  text_or_null(json, "material", k.material);
  json.end_object();
}

}  // namespace

std::string survey_json(const std::vector<FileSurvey>& files, const std::vector<std::string>& names) {
  std::string text;
  JsonWriter json(text);
  json.begin_object().field("schema", 1).key("files").begin_array();
  for (size_t i = 0; i < files.size(); ++i) {
    const FileSurvey& f = files[i];
    json.begin_object().field("path", names[i]).field("format", format_word(f.file.format));
    text_or_null(json, "unit", f.file.unit);
    json.field("bytes", f.file.bytes).field("hash", f.file.hash);
    write_box(json, f.lo, f.hi);
    json.key("parts").begin_array();
    for (const PartKind& k : f.kinds) write_kind(json, k);
    json.end_array().key("warnings").begin_array();
    for (const std::string& w : f.file.warnings) json.value(w);
    json.end_array().end_object();
  }
  json.end_array().end_object();
  return text;
}

}  // namespace teracell::mesher

#include "mesher/formats/xml.hpp"

#include <expat.h>
#include <strings.h>

#include <algorithm>
#include <array>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "mesher/surface/facet.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

using namespace std::string_view_literals;

constexpr int kDeepest = 64;
constexpr uint64_t kLongestTag = uint64_t{1} << 22;
constexpr size_t kMostNameSpaces = 256;

// Expat 2.9 wants the 64 bits of a count to be asked for by name.
#if XML_MAJOR_VERSION > 2 || XML_MINOR_VERSION >= 9
constexpr auto byte_index = XML_GetCurrentByteIndex64;
constexpr auto line_number = XML_GetCurrentLineNumber64;
#else
constexpr auto byte_index = XML_GetCurrentByteIndex;
constexpr auto line_number = XML_GetCurrentLineNumber;
#endif

}  // namespace

const char* XmlElement::find(std::string_view attribute) const {
  for (const char** a = attributes_; *a; a += 2)
    if (attribute == *a) return a[1];
  return nullptr;
}

// What Expat calls.
struct XmlReader::Calls {
  template <class F>
  static void guarded(void* self, F&& f) {
    auto& reader = *static_cast<XmlReader*>(self);
    if (reader.failure_) return;
    try {
      f(reader);
    } catch (...) {
      reader.failure_ = std::current_exception();
      XML_StopParser(reader.parser_, XML_FALSE);
    }
  }
  static void begin(void* self, const char* name, const char** attributes) {
    guarded(self, [&](XmlReader& r) {
      if (++r.depth_ > kDeepest) r.refuse(fmt::format("expected at most {} elements within each other, found more", kDeepest));
      r.begin_(XmlElement(name, attributes));
    });
  }
  static void end(void* self, const char* name) {
    guarded(self, [&](XmlReader& r) {
      --r.depth_;
      r.end_(name);
    });
  }
  static void declaration(void* self, const char*, const char* encoding, int) {
    guarded(self, [&](XmlReader& r) {
      if (encoding && strcasecmp(encoding, "utf-8") != 0 && strcasecmp(encoding, "utf-16") != 0)
        r.refuse(fmt::format("expected text in UTF-8 or UTF-16, found the encoding {}", shown(encoding)));
    });
  }
  static void document_type(void* self, const char*, const char*, const char*, int) {
    guarded(self, [](XmlReader& r) { r.refuse("expected no document type definition, found <!DOCTYPE"); });
  }
  static void name_space(void* self, const char* prefix, const char* uri) {
    guarded(self, [&](XmlReader& r) {
      if (r.depth_ > 0) return;
      if (r.name_spaces_.size() == kMostNameSpaces) r.refuse(fmt::format("expected at most {} namespaces, found more", kMostNameSpaces));
      r.name_spaces_.emplace_back(prefix ? prefix : "", uri ? uri : "");
    });
  }
};

XmlReader::XmlReader(std::string where, std::function<void(const XmlElement&)> begin, std::function<void(std::string_view)> end)
    : where_(std::move(where)), begin_(std::move(begin)), end_(std::move(end)), parser_(XML_ParserCreateNS(nullptr, '|')) {
  if (!parser_) throw std::bad_alloc();
  XML_SetUserData(parser_, this);
  XML_SetElementHandler(parser_, Calls::begin, Calls::end);
  XML_SetXmlDeclHandler(parser_, Calls::declaration);
  XML_SetStartDoctypeDeclHandler(parser_, Calls::document_type);
  XML_SetStartNamespaceDeclHandler(parser_, Calls::name_space);
}

XmlReader::~XmlReader() { XML_ParserFree(parser_); }

void XmlReader::parse(std::string_view text, bool last) {
  constexpr std::array kUtf32 = {"\xff\xfe\0\0"sv, "\0\0\xfe\xff"sv, "<\0\0\0"sv, "\0\0\0<"sv};
  if (fed_ == 0 && std::ranges::any_of(kUtf32, [&](std::string_view begin) { return text.starts_with(begin); }))
    refuse("expected text in UTF-8 or UTF-16, found UTF-32");
  fed_ += text.size();
  const XML_Status status = XML_Parse(parser_, text.data(), static_cast<int>(text.size()), last);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  if (status == XML_STATUS_ERROR) {
    const XML_Error error = XML_GetErrorCode(parser_);
    if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
    refuse(fmt::format("not well-formed XML: {}", XML_ErrorString(error)));
  }
  const int64_t at = byte_index(parser_);
  if (at >= 0 && fed_ - std::min(fed_, static_cast<uint64_t>(at)) > kLongestTag + text.size())
    refuse(fmt::format("expected tags and texts of at most {} bytes, found a longer one", kLongestTag));
}

void XmlReader::refuse(std::string why) { throw InputError(fmt::format("{}: {}", at_line(), why)); }

uint64_t XmlReader::line() const { return line_number(parser_); }

std::string XmlReader::at_line() const { return fmt::format("{}: line {}", where_, line()); }

std::string XmlReader::name_space(const std::string& prefix) const {
  const auto found = std::ranges::find(name_spaces_.rbegin(), name_spaces_.rend(), prefix, &std::pair<std::string, std::string>::first);
  return found == name_spaces_.rend() ? "" : found->second;
}

}  // namespace teracell::mesher

// XML as a stream of elements, by Expat. What serves only to fill memory or time is refused: document types (and with them entities), tags of
// many megabytes, elements within elements without end.
#pragma once
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

struct XML_ParserStruct;

namespace teracell::mesher {

// An element where it begins. Views are valid during the call.
class XmlElement {
 public:
  XmlElement(std::string_view name, const char** attributes) : name_(name), attributes_(attributes) {}
  // As "namespace|name"; attributes without a namespace have their name alone.
  std::string_view name() const { return name_; }
  // The value of an attribute; none: null.
  const char* find(std::string_view attribute) const;

 private:
  std::string_view name_;
  const char** attributes_;
};

class XmlReader {
 public:
  // `where` begins every message: "a.3mf: '3D/3dmodel.model'".
  XmlReader(std::string where, std::function<void(const XmlElement&)> begin, std::function<void(std::string_view)> end);
  ~XmlReader();
  XmlReader(const XmlReader&) = delete;

  // Throws InputError for what is no XML, and what the functions throw.
  void feed(std::string_view text) { parse(text, false); }
  void finish() { parse({}, true); }
  // For messages: "a.3mf: '3D/3dmodel.model': line 7".
  std::string at_line() const;
  uint64_t line() const;
  // The namespace that a prefix stands for in the root element; empty when it stands for none.
  std::string name_space(const std::string& prefix) const;

 private:
  struct Calls;
  void parse(std::string_view text, bool last);
  void refuse(std::string why);

  const std::string where_;
  const std::function<void(const XmlElement&)> begin_;
  const std::function<void(std::string_view)> end_;
  XML_ParserStruct* const parser_;
  std::exception_ptr failure_;  // must not pass through Expat
  int depth_ = 0;
  uint64_t fed_ = 0;
  std::vector<std::pair<std::string, std::string>> name_spaces_;  // by prefix, the latest last
};

}  // namespace teracell::mesher

// PLY. A text header declares elements; each element has a number of rows, and a row has the declared properties. The values
// follow, as text with one row per line, or as binary in either byte order. Vertices are the element `vertex` with x, y and z.
// Facets are the list `vertex_indices` or `vertex_index` of the element `face` (a polygon) or `tristrips` (triangle strips,
// with -1 between two strips). Everything else is skipped. Greg Turk, "The PLY Polygon File Format", 1994.
//
// The counts of a header may be wrong, so memory grows with the values that are read and never with a count.
#include <algorithm>
#include <bit>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include "mesher/surface/readers.hpp"
#include "mesher/surface/spill_table.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct TypeInfo {
  const char *name, *old_name;
  uint64_t bytes;
  int64_t least, most;  // of integers
};
constexpr TypeInfo kTypes[] = {
    {"int8", "char", 1, INT8_MIN, INT8_MAX},
    {"uint8", "uchar", 1, 0, UINT8_MAX},
    {"int16", "short", 2, INT16_MIN, INT16_MAX},
    {"uint16", "ushort", 2, 0, UINT16_MAX},
    {"int32", "int", 4, INT32_MIN, INT32_MAX},
    {"uint32", "uint", 4, 0, UINT32_MAX},
    {"float32", "float", 4, 0, 0},
    {"float64", "double", 8, 0, 0},
};
const TypeInfo& info(Type type) { return kTypes[static_cast<int>(type)]; }
bool is_integer(Type type) { return type < Type::kFloat32; }

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  // of a list: the type of its length, which comes first
};
struct Element {
  std::string name;
  uint64_t count;
  std::vector<Property> properties;
};
struct Header {
  std::string format;  // "ascii", "binary_little_endian" or "binary_big_endian"
  std::vector<Element> elements;
};

// ---- the header

class HeaderReader {
 public:
  explicit HeaderReader(Input& input) : input_(input) {}

  Header read() {
    Header header;
    next_line();  // "ply", by which the format was recognised
    for (;;) {
      const std::string_view keyword = next_line();
      if (keyword == "format") header.format = read_format();
      else if (keyword == "element") header.elements.push_back(read_element());
      else if (keyword == "property") read_property(header);
      else if (keyword == "end_header") break;
      else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty())
        refuse("expected format, element, property, comment, obj_info or end_header", keyword);
    }
    if (header.format.empty()) refuse("expected a format line before end_header", "none");
    return header;
  }

 private:
  // Returns the first word of the line; line_ keeps the others.
  std::string_view next_line() {
    if (!input_.next_line(line_)) throw InputError(fmt::format("{}: cut short: expected end_header, found the end of the file", input_.at_line()));
    if (input_.offset() > kLongest)
      throw InputError(fmt::format("{}: expected end_header within the first {} bytes, found a longer header", input_.at_line(), kLongest));
    return next_word(line_);
  }
  [[noreturn]] void refuse(const char* expected, std::string_view found) const {
    throw InputError(fmt::format("{}: {}, found {}", input_.at_line(), expected, shown(found)));
  }

  std::string read_format() {
    const std::string_view format = next_word(line_), version = next_word(line_);
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian")
      refuse("expected format ascii, binary_little_endian or binary_big_endian", format);
    if (version != "1.0") refuse("expected version 1.0", version);
    return std::string(format);
  }

  Element read_element() {
    Element element;
    element.name = next_word(line_);
    const std::string_view count = next_word(line_);
    const auto [stop, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc{} || stop != count.data() + count.size()) refuse("expected element NAME COUNT", count);
    return element;
  }

  void read_property(Header& header) {
    if (header.elements.empty()) refuse("expected an element before its properties", "property");
    Property property;
    std::string_view word = next_word(line_);
    if (word == "list") {
      word = next_word(line_);
      property.count = type(word);
      if (!is_integer(*property.count)) refuse("expected an integer type for a list's length", word);
      word = next_word(line_);
    }
    property.type = type(word);
    property.name = next_word(line_);
    if (property.name.empty()) refuse("expected property TYPE NAME", "");
    header.elements.back().properties.push_back(std::move(property));
  }

  Type type(std::string_view word) const {
    for (size_t i = 0; i < std::size(kTypes); ++i)
      if (word == kTypes[i].name || word == kTypes[i].old_name) return static_cast<Type>(i);
    refuse("expected a type (char, uchar, short, ushort, int, uint, float, double, int8 ... float64)", word);
  }

  static constexpr uint64_t kLongest = uint64_t{1} << 20;  // a header is held in memory
  Input& input_;
  std::string_view line_;
};

// ---- the values: two classes with one interface (template arguments, because one virtual call per value is slow)

class AsciiValues {
 public:
  explicit AsciiValues(Input& input) : input_(input) {}

  void begin_row(const Element& element, uint64_t row) {
    do {
      if (!input_.next_line(line_))
        throw InputError(
            fmt::format("{}: cut short: expected {} {} of {}, found the end of the file", input_.at_line(), element.name, row, element.count));
    } while (trimmed(line_).empty());
  }
  // MeshLab has written rows with more values than it declares.
  void end_row(const Element& element) {
    if (next_word(line_).empty()) return;
    if (rows_too_long_++ == 0) first_too_long_ = fmt::format("line {}, of {}", input_.line(), element.name);
  }
  double coordinate(Type type) {
    if (is_integer(type)) return static_cast<double>(integer(type));
    return type == Type::kFloat32 ? next_coordinate<float>(line_, input_) : next_coordinate<double>(line_, input_);
  }
  int64_t integer(Type type) {
    const std::string_view word = next_word(line_);
    const int64_t v = text_integer(word, "an integer", input_);
    if (v < info(type).least || v > info(type).most) refuse_number(word, info(type).name, input_);
    return v;
  }
  void skip(Type, uint64_t values) {
    for (; values > 0; --values)
      if (next_word(line_).empty()) refuse_number({}, "a value", input_);
  }
  void finish(FacetStream& out) {
    if (rows_too_long_ > 0)
      out.warn(fmt::format("{} than the header declares, the first in {}: these values were left out.",
                           rows_too_long_ == 1 ? "1 row has more values" : fmt::format("{} rows have more values", rows_too_long_), first_too_long_));
    while (input_.next_line(line_))
      if (!trimmed(line_).empty()) throw InputError(fmt::format("{}: expected the end of the file, found {}", input_.at_line(), shown(line_)));
  }
  std::string place() const { return input_.at_line(); }

 private:
  Input& input_;
  std::string_view line_;
  uint64_t rows_too_long_ = 0;
  std::string first_too_long_;
};

template <std::endian kOrder>
class BinaryValues {
 public:
  explicit BinaryValues(Input& input) : input_(input) {}

  void begin_row(const Element& element, uint64_t row) {
    element_ = &element;
    row_ = row;
  }
  void end_row(const Element&) {}
  double coordinate(Type type) {
    if (is_integer(type)) return static_cast<double>(integer(type));
    const double v = type == Type::kFloat32 ? std::bit_cast<float>(load<uint32_t>()) : std::bit_cast<double>(load<uint64_t>());
    if (!is_coordinate(v)) checked_coordinate(v, place());
    return v + 0.0;
  }
  int64_t integer(Type type) {
    switch (type) {
      case Type::kInt8: return static_cast<int8_t>(load<uint8_t>());
      case Type::kUint8: return load<uint8_t>();
      case Type::kInt16: return static_cast<int16_t>(load<uint16_t>());
      case Type::kUint16: return load<uint16_t>();
      case Type::kInt32: return static_cast<int32_t>(load<uint32_t>());
      default: return load<uint32_t>();
    }
  }
  void skip(Type type, uint64_t values) {
    for (uint64_t left = values * info(type).bytes; left > 0;) {  // values < 2^32
      const uint64_t here = std::min<uint64_t>(input_.window(1).size(), left);
      if (here == 0) cut_short();
      input_.consume(here);
      left -= here;
    }
  }
  void finish(FacetStream&) {
    if (!input_.window(1).empty())
      throw InputError(fmt::format("{}: expected the end of the file after the last element, found more bytes", input_.at_byte()));
  }
  std::string place() const { return fmt::format("{}: {} {}", input_.at_byte(), element_->name, row_); }

 private:
  template <class T>
  T load() {
    const std::string_view bytes = input_.window(sizeof(T));
    if (bytes.size() < sizeof(T)) cut_short();
    T v = 0;
    for (size_t i = 0; i < sizeof(T); ++i) {
      const size_t shift = 8 * (kOrder == std::endian::little ? i : sizeof(T) - 1 - i);
      v = static_cast<T>(v | static_cast<T>(T{static_cast<unsigned char>(bytes[i])} << shift));
    }
    input_.consume(sizeof(T));
    return v;
  }
  [[noreturn]] void cut_short() const {
    throw InputError(
        fmt::format("{}: cut short: expected {} {} of {}, found the end of the file", input_.at_byte(), element_->name, row_, element_->count));
  }

  Input& input_;
  const Element* element_ = nullptr;
  uint64_t row_ = 0;
};

// ---- the elements

// An element that lists vertices by number.
struct Lists {
  const Element* element = nullptr;
  const Property* indices = nullptr;
};

// Which properties are the coordinates of a vertex, and which lists are facets.
struct Layout {
  const Element* vertex = nullptr;
  std::array<const Property*, 3> xyz{};
  Lists face, strips;
};

// Throws InputError when the header does not describe a surface.
Layout layout_of(const Header& header, const Input& input) {
  Layout layout;
  const auto refuse = [&](const std::string& text) { throw InputError(fmt::format("{}: PLY header: {}", input.name(), text)); };
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      if (layout.vertex) refuse("expected one element vertex, found two");
      layout.vertex = &element;
      for (const Property& p : element.properties)
        if (!p.count && p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z') layout.xyz[p.name[0] - 'x'] = &p;
    } else if (element.name == "face" || element.name == "tristrips") {
      Lists& lists = element.name == "face" ? layout.face : layout.strips;
      if (lists.element) refuse(fmt::format("expected one element {}, found two", element.name));
      if (!layout.vertex)
        refuse(fmt::format("expected element vertex before element {}, found it later or not at all: write the file again with the vertices first",
                           element.name));
      lists.element = &element;
      for (const Property& p : element.properties)
        if (p.count && is_integer(p.type) && (p.name == "vertex_indices" || p.name == "vertex_index")) lists.indices = &p;
      if (!lists.indices) refuse(fmt::format("expected a list of integers vertex_indices of element {}, found none", element.name));
    }
  }
  if (!layout.vertex) refuse("expected an element vertex, found none");
  for (const Property* p : layout.xyz)
    if (!p) refuse("expected the properties x, y and z of element vertex, found not all of them");
  if (!layout.face.element && !layout.strips.element)
    refuse("expected an element face or tristrips, found none: points alone are not a surface, reconstruct a surface from them first");
  return layout;
}

template <class Values>
uint64_t list_length(Values& values, const Property& property) {
  const int64_t n = values.integer(*property.count);
  if (n < 0) throw InputError(fmt::format("{}: expected the length of list {}, found {}", values.place(), property.name, n));
  return static_cast<uint64_t>(n);
}

template <class Values>
void skip_property(Values& values, const Property& property) {
  values.skip(property.type, property.count ? list_length(values, property) : 1);
}

template <class Values>
void read_vertex(Values& values, const Layout& layout, VertexTable& vertices) {
  Vec3 v{};
  for (const Property& p : layout.vertex->properties) {
    const auto axis = std::find(layout.xyz.begin(), layout.xyz.end(), &p);
    if (axis != layout.xyz.end()) v[axis - layout.xyz.begin()] = values.coordinate(p.type);
    else skip_property(values, p);
  }
  vertices.push_back(v);
}

template <class Values>
const Vec3& vertex_at(const Values& values, int64_t number, VertexTable& vertices) {
  if (number >= 0 && static_cast<uint64_t>(number) < vertices.size()) return vertices[number];
  throw InputError(fmt::format("{}: expected a vertex number below {}, found {}", values.place(), vertices.size(), number));
}

template <class Values>
void read_face(Values& values, const Lists& face, VertexTable& vertices, Fan fan) {
  for (const Property& p : face.element->properties) {
    if (&p != face.indices) {
      skip_property(values, p);
      continue;
    }
    const uint64_t n = list_length(values, p);
    if (n < 3) throw InputError(fmt::format("{}: expected a face of 3 or more vertices, found {}", values.place(), n));
    for (uint64_t i = 0; i < n; ++i) {
      const int64_t number = values.integer(p.type);
      fan.add(vertex_at(values, number, vertices), static_cast<uint64_t>(number));
    }
  }
}

// Each vertex of a strip forms a facet with the two vertices before it; every other facet is reversed. A facet that repeats a
// vertex only changes the course of the strip and is left out.
template <class Values>
void read_strips(Values& values, const Lists& strips, VertexTable& vertices, FacetStream& out, bool wanted) {
  struct Corner {
    uint64_t number;
    Vec3 place;
  };
  for (const Property& p : strips.element->properties) {
    if (&p != strips.indices) {
      skip_property(values, p);
      continue;
    }
    Corner a{}, b{};
    uint64_t length = 0;  // of the strip so far
    for (uint64_t left = list_length(values, p); left > 0; --left) {
      const int64_t number = values.integer(p.type);
      if (number == -1) {
        length = 0;
        continue;
      }
      const Corner c{static_cast<uint64_t>(number), vertex_at(values, number, vertices)};
      if (length >= 2 && wanted && a.number != b.number && b.number != c.number && c.number != a.number) {
        const auto& [first, second] = length % 2 == 0 ? std::tie(a, b) : std::tie(b, a);
        out.add(first.place, second.place, c.place, {first.number, second.number, c.number});
      }
      a = b, b = c;
      ++length;
    }
  }
}

template <class Values>
void read_body(Values values, const Header& header, const Layout& layout, FacetStream& out, const Budget& budget) {
  const bool wanted = out.wants("");
  VertexTable vertices(budget);
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;  // its rows take no bytes, whatever their number
    for (uint64_t row = 0; row < element.count; ++row) {
      values.begin_row(element, row);
      if (&element == layout.vertex) read_vertex(values, layout, vertices);
      else if (&element == layout.face.element) read_face(values, layout.face, vertices, Fan(out, wanted));
      else if (&element == layout.strips.element) read_strips(values, layout.strips, vertices, out, wanted);
      else
        for (const Property& p : element.properties) skip_property(values, p);
      values.end_row(element);
    }
  }
  values.finish(out);
}

Match recognises_ply(const Head& head) {
  std::string_view line = first_line(head.bytes);
  return line.size() < head.bytes.size() && next_word(line) == "ply" && trimmed(line).empty() ? Match::kSure : Match::kNo;
}

void read_ply(Input& input, FacetStream& out, SurfaceFile& file, const ReadOptions& options) {
  const std::string_view start = input.window(3);
  const size_t stop = start.find_first_of("\r\n");
  if (!start.substr(stop).starts_with("\r\n") && start[stop] == '\r') input.set_newline('\r');

  const Header header = HeaderReader(input).read();
  const Layout layout = layout_of(header, input);
  file.float32 = true;
  for (const Property* p : layout.xyz) file.float32 &= p->type == Type::kFloat32;
  if (layout.face.element) options.expect(layout.face.element->count);
  if (header.format == "ascii") {
    file.format = "PLY (ASCII)";
    read_body(AsciiValues(input), header, layout, out, options.budget);
  } else if (header.format == "binary_little_endian") {
    file.format = "PLY (binary, little endian)";
    read_body(BinaryValues<std::endian::little>(input), header, layout, out, options.budget);
  } else {
    file.format = "PLY (binary, big endian)";
    read_body(BinaryValues<std::endian::big>(input), header, layout, out, options.budget);
  }
}

}  // namespace

const SurfaceReader kPlyReader = {"PLY", recognises_ply, read_ply};

}  // namespace teracell::mesher

// What a surface file may look like, what comes out of it, and what is said when it is none.
#include "mesher/facets.hpp"

#include <unistd.h>
#include <xxhash.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <sstream>

#include "mesher/readers.hpp"
#include "store/error.hpp"

using namespace teracell;
using Catch::Matchers::Contains;

namespace {

// ---- fixture: surfaces written in every format

using Facets = std::vector<std::array<Vec3, 3>>;

Facets tetrahedron() {
  const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 0.5};
  return {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}};
}

template <class T>
std::string bytes_of(T v, std::endian order = std::endian::little) {
  std::string s(reinterpret_cast<const char*>(&v), sizeof v);
  if (order != std::endian::native) std::reverse(s.begin(), s.end());
  return s;
}

std::string binary_stl(const Facets& facets, std::string header = "made by a test") {
  header.resize(80);
  std::string s = header + bytes_of(static_cast<uint32_t>(facets.size()));
  for (const auto& facet : facets) {
    for (int i = 0; i < 3; ++i) s += bytes_of(0.f);
    for (const Vec3& v : facet)
      for (double x : v) s += bytes_of(static_cast<float>(x));
    s += std::string("\0\0", 2);
  }
  return s;
}

std::string ascii_stl(const Facets& facets, const std::string& name) {
  std::ostringstream s;
  s << "solid " << name << "\n";
  for (const auto& facet : facets) {
    s << " facet normal 0 0 0\n  outer loop\n";
    for (const Vec3& v : facet) s << "   vertex " << v[0] << " " << v[1] << " " << v[2] << "\n";
    s << "  endloop\n endfacet\n";
  }
  s << "endsolid " << name << "\n";
  return s.str();
}

const std::string kObj = "# a tetrahedron\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0.5\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

std::string ply_header(const std::string& format, const std::string& scalar = "float") {
  return "ply\nformat " + format + " 1.0\ncomment made by a test\nelement vertex 4\nproperty " + scalar +
         " x\nproperty " + scalar + " y\nproperty " + scalar +
         " z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n";
}
const std::string kPlyBody = "0 0 0\n1 0 0\n0 1 0\n0 0 0.5\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

template <class Scalar>
std::string binary_ply(std::endian order) {
  std::string s = ply_header(order == std::endian::little ? "binary_little_endian" : "binary_big_endian",
                             sizeof(Scalar) == 4 ? "float" : "double");
  for (const Scalar x : {0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 0.5}) s += bytes_of(static_cast<Scalar>(x), order);
  for (const std::array<int32_t, 3> face : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    s += '\3';
    for (int32_t i : face) s += bytes_of(i, order);
  }
  return s;
}

std::string gzipped(const std::string& bytes) {
  z_stream z{};
  REQUIRE(deflateInit2(&z, 6, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string s(deflateBound(&z, bytes.size()), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(s.data());
  z.avail_out = static_cast<uInt>(s.size());
  REQUIRE(deflate(&z, Z_FINISH) == Z_STREAM_END);
  s.resize(z.total_out);
  deflateEnd(&z);
  return s;
}

struct Result {
  SurfaceFile file;
  Facets facets;
};

Result read(const std::string& bytes, const std::string& part = "") {
  Result r;
  Input input("mesh", bytes);
  r.file = read_facets(input, part, [&](std::span<const Facet> some) {
    for (const Facet& f : some) r.facets.push_back(f.vertex);
  });
  return r;
}

// The message of the InputError; empty when there was none.
std::string refusal(const std::string& bytes, const std::string& part = "") {
  try {
    read(bytes, part);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const size_t at = text.find(old);
  REQUIRE(at != std::string::npos);
  return text.replace(at, old.size(), by);
}

// The same coordinate through a text format.
double through_obj(const std::string& word) {
  return read("v 0 0 0\nv 1 0 0\nv 0 1 " + word + "\nf 1 2 3\n").facets[0][2][2];
}
std::string one_facet_stl(const std::string& word) {
  return "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 " + word +
         "\nendloop\nendfacet\nendsolid\n";
}
double through_stl(const std::string& word) { return read(one_facet_stl(word)).facets[0][2][2]; }

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& bytes)
      : path(std::filesystem::temp_directory_path() / ("teracell-facets-" + std::to_string(getpid()))) {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  ~TemporaryFile() { std::filesystem::remove(path); }
  const std::filesystem::path path;
};

int64_t open_descriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator());
}

}  // namespace

// ---- one surface, every format

TEST_CASE("The same surface in every format gives the same facets") {
  const auto [format, bytes] = GENERATE(table<std::string, std::string>({
      {"STL (binary)", binary_stl(tetrahedron())},
      {"STL (binary)", binary_stl(tetrahedron(), "solid but binary")},
      {"STL (ASCII)", ascii_stl(tetrahedron(), "tetra")},
      {"OBJ", kObj},
      {"PLY (ASCII)", ply_header("ascii") + kPlyBody},
      {"PLY (ASCII)", ply_header("ascii", "float64") + kPlyBody},
      {"PLY (binary, little endian)", binary_ply<float>(std::endian::little)},
      {"PLY (binary, little endian)", binary_ply<double>(std::endian::little)},
      {"PLY (binary, big endian)", binary_ply<float>(std::endian::big)},
      {"PLY (binary, big endian)", binary_ply<double>(std::endian::big)},
  }));
  CAPTURE(format);
  const Result plain = read(bytes), zipped = read(gzipped(bytes));
  for (const Result& r : {plain, zipped}) {
    CHECK(r.facets == tetrahedron());
    CHECK(r.file.format == format);
    CHECK(r.file.facets == 4);
  }
  CHECK(plain.file.bytes == bytes.size());
  CHECK(zipped.file.bytes == gzipped(bytes).size());
  CHECK(zipped.file.hash != plain.file.hash);
  CHECK(plain.file.float32 == (format != "OBJ" && bytes.find("property float64") == std::string::npos &&
                               bytes.find("property double") == std::string::npos));
}

TEST_CASE("Line ends of every system, and a byte order mark, change nothing") {
  for (const std::string& text : {kObj, ascii_stl(tetrahedron(), "t"), ply_header("ascii") + kPlyBody})
    for (const std::string end : {"\r\n", "\r"}) {
      std::string other;
      for (char c : text) other += c == '\n' ? end : std::string(1, c);
      CHECK(read(other).facets == tetrahedron());
      if (!text.starts_with("ply")) CHECK(read("\xef\xbb\xbf" + other).facets == tetrahedron());
    }
  CHECK(read(replaced(binary_ply<float>(std::endian::little), "end_header\n", "end_header\r\n")).facets ==
        tetrahedron());
}

TEST_CASE("A file is read, hashed as xxhsum does, and closed again") {
  const TemporaryFile file(gzipped(kObj));
  const int64_t before = open_descriptors();
  Facets facets;
  const SurfaceFile found = read_facets(file.path, "", [&](std::span<const Facet> some) {
    for (const Facet& f : some) facets.push_back(f.vertex);
  });
  CHECK(facets == tetrahedron());
  CHECK(found.bytes == gzipped(kObj).size());
  const XXH128_hash_t hash = XXH3_128bits(gzipped(kObj).data(), gzipped(kObj).size());
  char hex[33];
  std::snprintf(hex, sizeof hex, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  CHECK(found.hash == hex);

  const TemporaryFile broken(binary_stl(tetrahedron()) + "x");
  CHECK_THROWS_AS(read_facets(broken.path, "", [](auto) {}), InputError);
  CHECK_THROWS_AS(read_facets("/nowhere/hull.stl", "", [](auto) {}), IoError);
  CHECK_THROWS_AS(read_facets("/", "", [](auto) {}), IoError);
  CHECK_THROWS_WITH(read_facets("/nowhere/hull.stl", "", [](auto) {}),
                    Contains("/nowhere/hull.stl") && Contains("No such file"));
  CHECK(open_descriptors() == before);
}

TEST_CASE("Facets come in order however large the file, and an exception of the sink passes through") {
  Facets many;
  for (int i = 0; i < 30'000; ++i) many.push_back({Vec3{0. + i, 0, 0}, Vec3{1. + i, 0, 0}, Vec3{0. + i, 1, 0}});
  for (const std::string& bytes : {binary_stl(many), ascii_stl(many, "many")}) {
    CHECK((read(bytes).facets == many));
    CHECK((read(gzipped(bytes)).facets == many));
  }
  Input input("mesh", kObj);
  CHECK_THROWS_AS(read_facets(input, "", [](auto) { throw Interrupted("stop"); }), Interrupted);
}

// ---- numbers

TEST_CASE("Decimal text is rounded once, to the declared type") {
  // Just above the middle of 1 and the next float32: by way of a double it would be a tie, and go down to 1.
  const std::string above_middle = "1.00000005960464477540";
  CHECK(static_cast<float>(std::stod(above_middle)) == 1.f);
  CHECK(through_stl(above_middle) == 1.f + std::numeric_limits<float>::epsilon());
  CHECK(through_obj(above_middle) == std::stod(above_middle));
  CHECK(through_obj("0.1") == 0.1);
  CHECK(through_stl("0.1") == 0.1f);
  const auto ply_vertex = [](const std::string& type) {
    return read(replaced(ply_header("ascii", type) + kPlyBody, "0.5", "1.00000005960464477540")).facets[1][2][2];
  };
  CHECK(ply_vertex("float") == 1.f + std::numeric_limits<float>::epsilon());
  CHECK(ply_vertex("double") == std::stod(above_middle));
}

TEST_CASE("Signs, exponents and points may be written in every usual way") {
  CHECK(through_obj("+1.5E+1") == 15);
  CHECK(through_obj(".5") == 0.5);
  CHECK(through_obj("5.") == 5);
  CHECK(through_obj("-5.e-1") == -0.5);
  for (const char* bad : {"", "+", "+-1", "--1", "1,5", "0x10", "1e", "1.5.2", "abc", "1d3"}) {
    CAPTURE(bad);
    CHECK_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 " + std::string(bad) + "\nf 1 2 3\n"),
               Contains("mesh: line 3: expected a number"));
  }
}

TEST_CASE("Minus zero is read as zero") {
  for (double v :
       {through_obj("-0"), through_obj("-0.0e5"), through_stl("-0"), through_stl("-1e-60"), through_obj("-1e-400")})
    CHECK((v == 0 && !std::signbit(v)));
  Facets facets = tetrahedron();
  facets[0][0] = {-0., -0., -0.};
  const Result r = read(binary_stl(facets));
  for (double x : r.facets[0][0]) CHECK(!std::signbit(x));
}

TEST_CASE("A coordinate is 0 or between 1e-75 and 1e75 once it is rounded") {
  CHECK(through_obj("1e75") == 1e75);
  CHECK(through_obj("-1e-75") == -1e-75);
  CHECK(through_obj("1e-400") == 0);  // rounds to 0
  CHECK(through_stl("1e-50") == 0);
  CHECK(through_stl("1e-45") == std::numeric_limits<float>::denorm_min());
  CHECK(through_stl("0.8e-45") == std::numeric_limits<float>::denorm_min());
  CHECK(through_stl("1.17549421e-38") == 0x7fffffp-149);
  CHECK(through_stl("3.4028235e38") == std::numeric_limits<float>::max());
  for (const char* bad :
       {"1.1e75", "1e-76", "5e-324", "3e-324", "1e400", "-1e400", "1e99999999999999999999", "inf", "-inf", "nan"}) {
    CAPTURE(bad);
    CHECK_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 " + std::string(bad) + "\nf 1 2 3\n"),
               Contains("mesh: line 3: '" + std::string(bad) + "': expected a"));
  }
  for (const char* bad : {"1e39", "3.4028236e38", "-1e400", "inf", "nan", "infinity"}) {
    CAPTURE(bad);
    CHECK_THAT(refusal(one_facet_stl(bad)), Contains("mesh: line 6") && Contains("expected a finite coordinate"));
  }
  Facets facets = tetrahedron();
  facets[2][1][0] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(refusal(binary_stl(facets)), Contains("mesh: byte 184: facet 2: expected a finite coordinate, found"));
  CHECK(checked_coordinate(-0.0, "here") == 0);
  CHECK_THROWS_WITH(checked_coordinate(1e80, "here"), Contains("here: expected a coordinate") && Contains("1e+80"));
}

// ---- telling the format

TEST_CASE("What is no surface is refused with a look at it") {
  CHECK_THAT(refusal(""), Contains("mesh: the file is empty"));
  CHECK_THAT(refusal("Dear reader,\nthis is a letter\n"),
             Contains("expected STL, OBJ or PLY, found 'Dear reader,?this is a letter?'"));
  CHECK_THAT(refusal("\x89PNG\r\n\x1a\n" + std::string(200, '\0')), Contains("byte 80") && Contains("or no STL"));
  CHECK_THAT(refusal(std::string(20, '\0')), Contains("expected STL, OBJ or PLY"));
  CHECK_THAT(refusal("# only a remark\n"), Contains("mesh: holds no facet"));
}

// ---- STL

TEST_CASE("Binary STL: the header's count and the size must agree") {
  const std::string whole = binary_stl(tetrahedron());
  for (const bool zip : {false, true}) {
    const auto message = [&](const std::string& bytes) { return refusal(zip ? gzipped(bytes) : bytes); };
    CHECK_THAT(message(whole.substr(0, 200)),
               Contains("byte 80") && Contains("the header counts 4 facets (284 bytes), the file has 200: cut short"));
    CHECK_THAT(message(whole + "xyz"),
               Contains("byte 80") && Contains("4 facets (284 bytes)") && Contains("bytes follow"));
  }
  std::string liar = whole;
  liar.replace(80, 4, "\xff\xff\xff\xff");
  CHECK_THAT(refusal(liar), Contains("4294967295 facets (214748364834 bytes), the file has 284"));
  // Long enough that the size of the gzip contents isn't known at the first look.
  const std::string large = binary_stl(Facets(5000, tetrahedron()[0]));
  CHECK_THAT(refusal(gzipped(large.substr(0, 100'000))),
             Contains("byte 80 (uncompressed)") && Contains("the file has 100000: cut short"));
  CHECK_THAT(refusal(gzipped(large + "x")), Contains("the file has more than 250084"));
  CHECK_THAT(refusal(binary_stl({})), Contains("mesh: holds no facet"));
}

TEST_CASE("ASCII STL: keywords in any case, any layout, several solids") {
  std::string text = ascii_stl(tetrahedron(), "");
  for (char& c : text) c = static_cast<char>(std::toupper(c));
  CHECK(read(text).facets == tetrahedron());
  for (char& c : text) c = c == '\n' ? ' ' : c;
  CHECK(read(replaced(text, "SOLID ", "SOLID\n")).facets == tetrahedron());
  CHECK(read(replaced(text, "SOLID ", "SOLID\n")).file.parts.empty());
  const Result two = read(ascii_stl(tetrahedron(), "the hull") + ascii_stl(tetrahedron(), "deck"));
  CHECK(two.facets.size() == 8);
  CHECK(two.file.parts == std::vector<std::string>{"the hull", "deck"});
  CHECK(read(replaced(ascii_stl(tetrahedron(), "t"), "normal 0 0 0", "normal nan -1.#IND x")).facets == tetrahedron());
}

TEST_CASE("ASCII STL: what is wrong is named with its line") {
  const std::string whole = ascii_stl(tetrahedron(), "t");
  CHECK_THAT(refusal(whole.substr(0, whole.find("endsolid"))), Contains("line 29: cut short: expected 'endsolid'"));
  CHECK_THAT(refusal(replaced(whole, "normal 0 0 0", "normal 0 0")),
             Contains("line 3: expected 'outer', found 'loop'"));
  CHECK_THAT(refusal(replaced(whole, "vertex 0 0 0", "vertex 0 0")),
             Contains("line 5: expected a number, found 'vertex'"));
  CHECK_THAT(refusal(replaced(whole, "  endloop", "vertex 1 1 1\n  endloop")),
             Contains("line 7: expected 'endloop', found 'vertex'"));
  CHECK_THAT(refusal(replaced(whole, " facet", " faced")), Contains("line 2: expected 'facet', found 'faced'"));
  CHECK_THAT(refusal(whole + "and more\n"), Contains("line 31: expected 'solid', found 'and'"));
  CHECK_THAT(refusal("solid Empty\nendsolid Empty\n"), Contains("holds no facet"));
}

// ---- OBJ

TEST_CASE("OBJ: every way to name a vertex") {
  const std::string vertices = "v 0 0 0 1.0\nv 1 0 0 0.1 0.2 0.3\nvt 0 0\nvn 0 0 1\nv 0 1 0\nv 0 0 0.5\n";
  CHECK(read(vertices + "f 1 3 2\nf 1/1 2/1 4/1\nf 1//1 4//1 3//1\nf -3/-1/-1 -2/1/1 -1/1/1 # the last\n").facets ==
        tetrahedron());
  CHECK(read(vertices + "f 1 \\\n3 2\nf 1 2\\\r\n4\n# in C:\\\nf 1 4 3\nf 2 3 \\\n \\\n4").facets == tetrahedron());
}

TEST_CASE("OBJ: polygons are fans from their first vertex") {
  const Result r = read("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0.5 0\nf 2 3 4 5 1\n");
  const Vec3 a{1, 0, 0}, b{1, 1, 0}, c{0, 1, 0}, d{0, 0.5, 0}, e{0, 0, 0};
  CHECK(r.facets == Facets{{a, b, c}, {a, c, d}, {a, d, e}});

  std::string large = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";  // a line longer than the window
  for (int i = 0; i < 300'000; ++i) large += " " + std::to_string(i % 3 + 1);
  CHECK(read(large).facets.size() == 299'998);
}

TEST_CASE("OBJ: what is decoration is skipped, what would leave a hole is not") {
  const std::string decorated = "mtllib a.mtl\nusemtl steel\ns off\nvp 1 2\nl 1 2\np 1\nsomething new 1 2 3\n\n  \t\n";
  CHECK(read(decorated + kObj).facets == tetrahedron());
  CHECK_THAT(refusal(kObj + "surf 0 1 0 1\n"), Contains("mesh: line 10") && Contains("free-form surface"));
}

TEST_CASE("OBJ: what is wrong is named with its line") {
  const auto with_face = [](const std::string& face) {
    return refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + face + "\nv 0 0 1\n");
  };
  CHECK_THAT(with_face("f 1 2 0"), Contains("mesh: line 4: vertex 0 of a face"));
  CHECK_THAT(with_face("f 1 2 4"), Contains("mesh: line 4: vertex 4 of a face: expected one of the 3 declared so far"));
  CHECK_THAT(with_face("f 1 2 -4"), Contains("mesh: line 4: vertex -4"));
  CHECK_THAT(with_face("f 1 2"), Contains("mesh: line 4: expected a face of 3 or more vertices, found 2"));
  CHECK_THAT(with_face("f 1 2 x"), Contains("expected a vertex number, found 'x'"));
  CHECK_THAT(with_face("f 1 2 3.5"), Contains("expected a vertex number, found '3.5'"));
  CHECK_THAT(with_face("f 1 2 3/a"), Contains("expected a vertex v, v/t, v//n or v/t/n, found '3/a'"));
  CHECK_THAT(with_face("f 1 2 /3"), Contains("found '/3'"));
  CHECK_THAT(with_face("f 1 2 99999999999999999999"), Contains("expected a vertex number"));
  CHECK_THAT(refusal("v 1 2\n"), Contains("mesh: line 1: expected a number, found the end of the line"));
  CHECK_THAT(with_face(""), Contains("holds no facet"));
}

// ---- PLY

TEST_CASE("PLY: elements and properties of no use are skipped, lists too") {
  const std::string header =
      "element extra 2\nproperty list uint double numbers\nproperty int8 flag\nelement nothing 99999999999999999\n"
      "element vertex 4\nproperty uchar red\nproperty float z\nproperty list uint8 int16 tags\nproperty float "
      "x\nproperty "
      "double y\nobj_info more\nelement face 4\nproperty float quality\nproperty list short ushort "
      "vertex_index\nproperty "
      "list char uint edges\nelement tail 1\nproperty float64 end\nend_header\n";
  const std::string text = "ply\nformat ascii 1.0\n" + header +
                           "2 1e999 x\n  7\n0 7\n9 0 0 0 0\n\n9 0 1 5 1 0\n9 0 2 5 6 0 1\n9 0.5 0 0 0\n"
                           "0 3 0 2 1 0\n0 3 0 1 3 1 7\n0 3 0 3 2 0\n0 3 1 2 3 0\n8\n\n \n";
  CHECK_THAT(refusal(text), Contains("line 21: expected a value, found the end of the line"));
  const Result ascii = read(replaced(text, "x\n  7", "x 7"));
  CHECK(ascii.facets == tetrahedron());
  CHECK_FALSE(ascii.file.float32);  // y is a double

  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const auto put = [&](auto v) { return bytes_of(v, order); };
    std::string bytes =
        "ply\nformat binary_" + std::string(order == std::endian::little ? "little" : "big") + "_endian 1.0\n" + header;
    bytes += put(2u) + put(1e99) + put(std::nan("")) + "\7" + put(0u) + "\7";
    for (const Vec3 v : {Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}})
      bytes += "\11" + put(static_cast<float>(v[2])) + "\1" + put(short{6}) + put(static_cast<float>(v[0])) + put(v[1]);
    for (const std::array<uint16_t, 3> face : {std::array<uint16_t, 3>{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}})
      bytes += put(0.f) + put(short{3}) + put(face[0]) + put(face[1]) + put(face[2]) + "\1" + put(5u);
    bytes += put(8.);
    CHECK(read(bytes).facets == tetrahedron());
    CHECK_FALSE(read(bytes).file.float32);
  }
}

TEST_CASE("PLY: integer coordinates are exact, polygons are fans") {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty uint y\nproperty char z\nelement face 1\n"
      "property list uchar uint vertex_indices\nend_header\n-2147483648 4294967295 -128\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 "
      "3\n";
  const Result r = read(text);
  const Vec3 a{-2147483648., 4294967295., -128}, b{1, 0, 0}, c{1, 1, 0}, d{0, 1, 0};
  CHECK(r.facets == Facets{{a, b, c}, {a, c, d}});
  CHECK_FALSE(r.file.float32);
  CHECK_THAT(refusal(replaced(text, "-128", "-129")), Contains("line 10: expected int8, found '-129'"));
  CHECK_THAT(refusal(replaced(text, "-128", "0.5")), Contains("line 10: expected an integer, found '0.5'"));
}

TEST_CASE("PLY: a header that is wrong is named with its line") {
  const std::string whole = ply_header("ascii") + kPlyBody;
  const auto message = [&](const std::string& old, const std::string& by) { return refusal(replaced(whole, old, by)); };
  CHECK_THAT(message("ascii", "utf8"), Contains("mesh: line 2: expected format ascii") && Contains("found 'utf8'"));
  CHECK_THAT(message("1.0", "2.0"), Contains("expected version 1.0, found '2.0'"));
  CHECK_THAT(message("comment", "remark"), Contains("line 3") && Contains("found 'remark'"));
  CHECK_THAT(message("vertex 4", "vertex four"), Contains("line 4") && Contains("found 'four'"));
  CHECK_THAT(message("vertex 4", "vertex -4"), Contains("line 4") && Contains("found '-4'"));
  CHECK_THAT(message("float x", "real x"), Contains("line 5: expected a type") && Contains("found 'real'"));
  CHECK_THAT(message("list uchar", "list float"), Contains("expected an integer type for a list's length"));
  CHECK_THAT(message("element vertex 4\n", ""), Contains("line 4: expected an element before its properties"));
  CHECK_THAT(message("float z", "float w"), Contains("expected the properties x, y and z"));
  CHECK_THAT(message("element face", "element tristrips"), Contains("expected an element face") && Contains("convert"));
  CHECK_THAT(message("list uchar int", "list uchar float"), Contains("expected a list of integers vertex_indices"));
  CHECK_THAT(message("element vertex", "element point"), Contains("expected element vertex before element face"));
  CHECK_THAT(message("format ascii 1.0\n", ""), Contains("expected a format line"));
  CHECK_THAT(refusal("ply\nformat ascii 1.0\n"), Contains("line 2: cut short: expected end_header"));
}

TEST_CASE("PLY: values that are wrong are named with their place") {
  const std::string whole = ply_header("ascii") + kPlyBody;
  const auto message = [&](const std::string& old, const std::string& by) { return refusal(replaced(whole, old, by)); };
  CHECK_THAT(message("3 1 2 3\n", "3 1 2 4\n"), Contains("line 18: expected a vertex number below 4, found 4"));
  CHECK_THAT(message("3 1 2 3\n", "3 1 2 -1\n"), Contains("expected a vertex number below 4, found -1"));
  CHECK_THAT(message("3 1 2 3\n", "3 1 2\n"), Contains("line 18: expected an integer, found the end of the line"));
  CHECK_THAT(message("3 1 2 3\n", "2 1 2\n"), Contains("expected a face of 3 or more vertices, found 2"));
  CHECK_THAT(message("3 1 2 3\n", "3 1 2 3 255\n"),
             Contains("line 18: expected no more values for this face, found '255'"));
  CHECK_THAT(message("3 1 2 3\n", ""), Contains("line 17: cut short: expected face 3 of 4"));
  CHECK_THAT(refusal(whole + "1\n"), Contains("line 19: expected the end of the file, found '1'"));

  const std::string binary = binary_ply<float>(std::endian::little);
  CHECK_THAT(refusal(binary + "x"), Contains("byte " + std::to_string(binary.size())) && Contains("found more bytes"));
  CHECK_THAT(refusal(binary.substr(0, binary.size() - 1)), Contains("cut short: expected face 3 of 4"));
  std::string far = binary;
  far.replace(far.size() - 4, 4, std::string("\0\0\0\1", 4));
  CHECK_THAT(refusal(far), Contains("face 3: expected a vertex number below 4, found 16777216"));
  std::string infinite = binary;
  infinite.replace(infinite.find("end_header\n") + 11, 4, bytes_of(std::numeric_limits<float>::infinity()));
  CHECK_THAT(refusal(infinite), Contains("vertex 0: expected a finite coordinate, found inf"));
}

TEST_CASE("PLY: a count that lies costs no memory") {
  for (const std::string& text : {binary_ply<float>(std::endian::little), ply_header("ascii") + kPlyBody})
    for (const std::string element : {"vertex", "face"})
      CHECK(refusal(replaced(text, element + " 4", element + " 18446744073709551615")) != "");
  std::string list = replaced(binary_ply<float>(std::endian::little), "list uchar", "list uint");
  list.replace(list.size() - 52, 4, "\xff\xff\xff\xff");
  CHECK(refusal(list) != "");
}

// ---- parts

TEST_CASE("A part of an OBJ is a group or an object, and the names may be a glob") {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0.5\nf 1 3 2\ng deck aft\nf 1 2 4\ng hull\nf 1 4 3\no big mast\nf 2 3 4\ng\nf "
      "2 4 3\no\nf 4 3 2\n";
  const auto count = [&](const std::string& part) { return read(text, part).facets.size(); };
  CHECK(read(text).file.parts == std::vector<std::string>{"deck", "aft", "hull", "big mast"});
  CHECK(read(text, "deck").file.parts == std::vector<std::string>{"deck", "aft", "hull", "big mast"});
  CHECK(read(text, "deck").file.facets == 1);
  CHECK(read(text, "deck").facets == Facets{tetrahedron()[1]});
  CHECK(count("") == 6);
  CHECK(count("*") == 6);
  CHECK(count("aft") == 1);
  CHECK(count("hull") == 2);      // the group goes on inside the object
  CHECK(count("big mast") == 2);  // and the object outside the group
  CHECK(count("[dh]*") == 3);
  CHECK(count("?*") == 4);  // those with a name
  CHECK_THAT(refusal(text, "Deck"),
             Contains("no part matches 'Deck': the file has 4 parts: 'deck', 'aft', 'hull', 'big mast'"));
  CHECK_THAT(refusal(kObj, "deck"), Contains("no part matches 'deck': the file names no parts"));
  CHECK_THAT(refusal(text + "g last\n", "last"), Contains("the parts that match 'last' hold no facet"));
}

TEST_CASE("A part of an STL is a named solid; binary STL and PLY have one part without a name") {
  const std::string text = ascii_stl(tetrahedron(), "lower deck") + ascii_stl(tetrahedron(), "hull");
  CHECK(read(text, "lower*").facets == tetrahedron());
  CHECK(read(text, "*").facets.size() == 8);
  CHECK_THAT(refusal(text, "mast"), Contains("'lower deck', 'hull'"));
  for (const std::string& bytes : {binary_stl(tetrahedron()), binary_ply<float>(std::endian::big)}) {
    CHECK(read(bytes, "*").facets == tetrahedron());
    CHECK_THAT(refusal(bytes, "hull"), Contains("no part matches 'hull': the file names no parts"));
  }
}

// ---- gzip, and files cut short

TEST_CASE("Gzip members one after the other are one file; damage is found") {
  const std::string bytes = binary_stl(tetrahedron());
  const std::string two = gzipped(bytes.substr(0, 100)) + gzipped(bytes.substr(100));
  CHECK(read(two).facets == tetrahedron());
  CHECK(read(two + gzipped("")).facets == tetrahedron());
  CHECK(read(two + std::string(300, '\0')).facets == tetrahedron());
  CHECK(read(two + std::string(300, '\0')).file.bytes == two.size() + 300);
  CHECK_THAT(refusal(two + "tail"), Contains("damaged gzip"));
  CHECK_THAT(refusal(two + std::string("\0\0x", 3)), Contains("stray bytes after the compressed data"));
  std::string flipped = gzipped(bytes);
  flipped[flipped.size() - 7] ^= 1;  // in the check sum
  CHECK_THAT(refusal(flipped), Contains("of the compressed file: damaged gzip: incorrect data check"));
  CHECK_THAT(refusal(gzipped(gzipped(bytes))), Contains("expected STL, OBJ or PLY"));
}

TEST_CASE("A file cut short anywhere is refused, or nothing but its last blanks was lost") {
  const bool zip = GENERATE(false, true);
  for (const std::string& plain :
       {binary_stl(tetrahedron()), ascii_stl(tetrahedron(), ""), ply_header("ascii") + kPlyBody,
        binary_ply<float>(std::endian::little), binary_ply<double>(std::endian::big)}) {
    const std::string bytes = zip ? gzipped(plain) : plain;
    for (size_t n = 0; n < bytes.size(); ++n) {
      const std::string message = refusal(bytes.substr(0, n));
      if (!message.empty()) continue;
      CAPTURE(n, bytes.size());
      CHECK((!zip && bytes.find_first_not_of(" \n", n) == std::string::npos));
      CHECK(read(bytes.substr(0, n)).facets == tetrahedron());
    }
  }
}

TEST_CASE("An OBJ has no end mark: cut short it is refused or gives the facets up to there") {
  for (size_t n = 0; n < kObj.size(); ++n) {
    if (!refusal(kObj.substr(0, n)).empty()) continue;
    const Facets facets = read(kObj.substr(0, n)).facets, all = tetrahedron();
    CHECK(std::equal(facets.begin(), facets.end(), all.begin()));
  }
}

// ---- surfaces nobody here made

TEST_CASE("Real surfaces hold the facets that their makers say") {
  const char* set = std::getenv("TERACELL_SHARED");
#ifdef TERACELL_SOURCE_DIR
  const std::filesystem::path shared = set ? set : TERACELL_SOURCE_DIR "/../shared";
#else
  const std::filesystem::path shared = set ? set : "../shared";
#endif
  if (!std::filesystem::exists(shared / "meshes")) {
    std::cout << "no surfaces in " << shared << ": set TERACELL_SHARED to test real files\n";
    return;
  }
  const std::vector<std::tuple<std::string, std::string, uint64_t, size_t>> known = {
      {"nefertiti.obj", "OBJ", 99'938, 0},
      {"rocker-arm.obj", "OBJ", 20'088, 0},
      {"fandisk.obj", "OBJ", 12'946, 0},
      {"turbineblade.ply", "PLY (binary, little endian)", 199'034, 0},
      {"lucy.ply", "PLY (binary, little endian)", 99'970, 0},
      {"gears.stl", "STL (ASCII)", 19'426, 1},
      {"shark.stl", "STL (binary)", 49'702, 0},
      {"buildings.obj.gz", "OBJ", 400'020, 2},
      {"DTC-hull.stl.gz", "STL (ASCII)", 116'062, 1},
      {"motorBike.obj.gz", "OBJ", 331'653, 67},
      {"stirred-tank/tank.obj", "OBJ", 36'322, 2},
      {"stirred-tank/sparger.obj", "OBJ", 55'876, 2},
      {"furnace/shield.obj", "OBJ", 1'612, 2},
      {"heat-exchanger/shell.stl.gz", "STL (ASCII)", 516, 3},
      {"broken/bunny.ply", "PLY (ASCII)", 69'451, 0},
      {"broken/propeller.obj.gz", "OBJ", 37'240, 2},
      {"broken/hourglass.stl", "STL (ASCII)", 2'146, 1},
      {"broken/featuretype.STL", "STL (binary)", 3'476, 0},
      {"broken/soup.stl", "STL (binary)", 100, 0},
  };
  for (const auto& [name, format, facets, parts] : known) {
    CAPTURE(name);
    uint64_t seen = 0;
    const SurfaceFile file =
        read_facets(shared / "meshes" / name, "", [&](std::span<const Facet> some) { seen += some.size(); });
    CHECK(file.format == format);
    CHECK(file.facets == facets);
    CHECK(seen == facets);
    CHECK(file.parts.size() == parts);
    CHECK(file.bytes == std::filesystem::file_size(shared / "meshes" / name));
  }
  for (const char* name : {"broken/empty.stl", "broken/empty-binary.stl"})
    CHECK_THROWS_WITH(read_facets(shared / "meshes" / name, "", [](auto) {}), Contains("holds no facet"));
}

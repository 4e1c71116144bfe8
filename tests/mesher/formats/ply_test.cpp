// PLY, ASCII and binary both ways.
#include "tests/support/surfaces.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

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
    std::string bytes = "ply\nformat binary_" + std::string(order == std::endian::little ? "little" : "big") + "_endian 1.0\n" + header;
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

TEST_CASE("PLY: coordinates and lists of every type") {
  const std::vector<std::string> integers = {"char", "uchar", "short", "ushort", "int",   "uint",
                                             "int8", "uint8", "int16", "uint16", "int32", "uint32"};
  const std::string body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const Facets expected = read(ply_header("ascii") + body).facets;
  for (const std::string& a : integers)
    for (const std::string& b : integers) {
      const std::string text = replaced(ply_header("ascii", a) + body, "list uchar int", "list " + a + " " + b);
      CHECK(read(text).facets == expected);
      CHECK(read(replaced(text, "vertex_indices", "vertex_index")).facets == expected);
    }
  for (const std::string type : {"float", "float32", "double", "float64"}) CHECK(read(ply_header("ascii", type) + body).facets == expected);
}

TEST_CASE("PLY: comments, obj_info and empty lines may stand anywhere in the header") {
  const std::string remark = "comment element\nobj_info end_header\n\ncomment\n";
  std::string header = ply_header("ascii");
  for (size_t end = header.find('\n'); end + 1 < header.size(); end = header.find('\n', end + 1 + remark.size())) header.insert(end + 1, remark);
  CHECK(read(header + kPlyBody).facets == tetrahedron());
  CHECK(read(header + kPlyBody).file.warnings.empty());
}

TEST_CASE("PLY: triangle strips turn every other facet, and begin anew behind -1") {
  Facets grid;  // of 2 x 3 vertices, as a strip goes
  const auto corner = [](int i) { return Vec3{static_cast<double>(i / 2), static_cast<double>(i % 2), 0}; };
  for (const std::array<int, 3> t : {std::array{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}})
    grid.push_back({corner(t[0]), corner(t[1]), corner(t[2])});
  const auto file = [&](const std::string& format, const std::string& element, const std::string& body) {
    return "ply\nformat " + format + " 1.0\nelement vertex 6\nproperty uchar x\nproperty double y\nproperty float z\n" + element + "end_header\n" +
           body;
  };
  std::string vertices;
  for (int i = 0; i < 6; ++i) vertices += std::to_string(i / 2) + " " + std::to_string(i % 2) + " 0\n";
  const auto strips = [&](int rows, const std::string& lists) {
    return read(file("ascii", "element tristrips " + std::to_string(rows) + "\nproperty list int int vertex_indices\n", vertices + lists)).facets;
  };
  CHECK(strips(1, "6 0 1 2 3 4 5\n") == grid);
  CHECK(strips(1, "8 0 1 2 3 4 5 -1 -1\n") == grid);
  CHECK(strips(2, "6 0 1 2 3 4 5\n6 0 1 2 3 4 5\n").size() == 8);
  CHECK(strips(1, "13 -1 5 -1 5 4 -1 0 1 2 -1 2 1 3\n") == Facets{grid[0], grid[1]});
  CHECK(strips(1, "7 -1 0 1 2 -1 2 1\n") == Facets{grid[0]});
  const Facets turned = {grid[0], {corner(3), corner(2), corner(4)}, {corner(3), corner(4), corner(5)}};
  CHECK(strips(1, "7 0 1 2 2 3 4 5\n") == turned);  // a repeated vertex turns the strip, and is no facet
  const std::string both =
      "element face 1\nproperty list uchar int vertex_index\nelement tristrips 1\nproperty float w\nproperty list uchar short vertex_index\n";
  CHECK(read(file("ascii", both, vertices + "3 0 1 2\n0.5 5 2 1 3 -1 0\n")).facets == Facets{grid[0], Facets{{corner(2), corner(1), corner(3)}}[0]});

  for (const std::endian order : {std::endian::little, std::endian::big}) {
    std::string body;
    for (int i = 0; i < 6; ++i) body += std::string(1, static_cast<char>(i / 2)) + bytes_of(static_cast<double>(i % 2), order) + bytes_of(0.f, order);
    body += bytes_of(7, order);
    for (const int i : {0, 1, 2, 3, 4, 5, -1}) body += bytes_of(i, order);
    const std::string bytes = file(order == std::endian::little ? "binary_little_endian" : "binary_big_endian",
                                   "element tristrips 1\nproperty list int int vertex_indices\n", body);
    CHECK(read(bytes).facets == grid);
    CHECK_THAT(refusal(bytes.substr(0, bytes.size() - 1)), Contains("cut short: expected tristrips 0 of 1"));
  }
  const auto refused = [&](const std::string& list) {
    return refusal(file("ascii", "element tristrips 1\nproperty list int int vertex_indices\n", vertices + list));
  };
  CHECK_THAT(refused("3 0 1 6\n"), Contains("line 16: expected a vertex number below 6, found 6"));
  CHECK_THAT(refused("3 0 1 -2\n"), Contains("expected a vertex number below 6, found -2"));
  CHECK_THAT(refused("2 0 1\n"), Contains("holds no facet"));
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
  CHECK_THAT(message("element face", "element edge"), Contains("expected an element face or tristrips, found none: points alone are not a surface"));
  CHECK_THAT(message("list uchar int", "list uchar float"), Contains("expected a list of integers vertex_indices"));
  CHECK_THAT(message("element vertex", "element point"),
             Contains("expected element vertex before element face, found it later or not at all: write the file again with the vertices first"));
  CHECK_THAT(message("format ascii 1.0\n", ""), Contains("expected a format line"));
  CHECK_THAT(refusal("ply\nformat ascii 1.0\n"), Contains("line 2: cut short: expected end_header"));
}

TEST_CASE("PLY: a header without end is refused before it fills the memory") {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 4\n";
  while (text.size() < 2'000'000) text += "property int a\n";
  CHECK_THAT(refusal(text), Contains("expected end_header within the first 1048576 bytes, found a longer header"));
}

TEST_CASE("PLY: values at the ends of rows that the header does not declare are left out, with one warning") {
  const std::string whole = ply_header("ascii") + kPlyBody;
  CHECK(read(whole).file.warnings.empty());
  const Result one = read(replaced(whole, "3 1 2 3\n", "3 1 2 3 255 abc\n"));
  CHECK(one.facets == tetrahedron());
  CHECK(one.file.warnings ==
        std::vector<std::string>{"1 row has more values than the header declares, the first in line 18, of face: these values were left out."});
  const Result two = read(replaced(replaced(whole, "3 1 2 3\n", "3 1 2 3 255\n"), "end_header\n0 0 0", "end_header\n0 0 0 7"));
  CHECK(two.facets == tetrahedron());
  CHECK(two.file.warnings ==
        std::vector<std::string>{"2 rows have more values than the header declares, the first in line 11, of vertex: these values were left out."});
}

TEST_CASE("PLY: values that are wrong are named with their place") {
  const std::string whole = ply_header("ascii") + kPlyBody;
  const auto message = [&](const std::string& old, const std::string& by) { return refusal(replaced(whole, old, by)); };
  CHECK_THAT(message("3 1 2 3\n", "3 1 2 4\n"), Contains("line 18: expected a vertex number below 4, found 4"));
  CHECK_THAT(message("3 1 2 3\n", "3 1 2 -1\n"), Contains("expected a vertex number below 4, found -1"));
  CHECK_THAT(message("3 1 2 3\n", "3 1 2\n"), Contains("line 18: expected an integer, found the end of the line"));
  CHECK_THAT(message("3 1 2 3\n", "2 1 2\n"), Contains("expected a face of 3 or more vertices, found 2"));
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
    for (const std::string element : {"vertex", "face"}) CHECK(refusal(replaced(text, element + " 4", element + " 18446744073709551615")) != "");
  std::string list = replaced(binary_ply<float>(std::endian::little), "list uchar", "list uint");
  list.replace(list.size() - 52, 4, "\xff\xff\xff\xff");
  CHECK(refusal(list) != "");
}

// What a surface file may look like, what comes out of it, and what is said when it is none.
#include <xxhash.h>

#include <map>
#include <random>

#include "tests/support/shared_files.hpp"
#include "tests/support/surfaces.hpp"

using namespace teracell;
using namespace teracell::mesher;
using namespace teracell::surfaces;
using Catch::Contains;

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
    CHECK(r.expected == (format == "OBJ" || format == "STL (ASCII)" ? std::nullopt : std::optional<uint64_t>(4)));  // others have counts
  }
  CHECK(plain.file.warnings.empty());
  CHECK(plain.file.bytes == bytes.size());
  CHECK(zipped.file.bytes == gzipped(bytes).size());
  CHECK(zipped.file.hash != plain.file.hash);
  CHECK(plain.file.float32 ==
        (format != "OBJ" && bytes.find("property float64") == std::string::npos && bytes.find("property double") == std::string::npos));
}

TEST_CASE("Formats whose files number the vertices tell these numbers: equal ones are equal vertices") {
  const std::string polygons = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf -5 5//2 2/1/1\n# more\nf 1 5 4\n";
  const std::string off = "OFF 4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  for (const std::string& bytes : {kObj, polygons, off, ply_header("ascii") + kPlyBody, binary_ply<double>(std::endian::big)}) {
    std::map<uint32_t, Vec3> vertex;
    std::vector<std::array<uint32_t, 3>> numbers;
    size_t facets = 0;
    Input input("mesh", bytes);
    read_facets(input, "",
                [&](std::span<const Facet> some) {
                  REQUIRE(numbers.size() == some.size());
                  for (size_t f = 0; f < some.size(); ++f)
                    for (int i = 0; i < 3; ++i) CHECK(vertex.try_emplace(numbers[f][i], some[f].vertex[i]).first->second == some[f].vertex[i]);
                  facets += some.size();
                },
                {.numbers = &numbers});
    CHECK(facets >= 4);
    CHECK(vertex.size() < 6);
    CHECK(numbers.empty());
  }
  std::vector<std::array<uint32_t, 3>> none;
  const std::string stl = binary_stl(tetrahedron());
  Input input("mesh", stl);
  read_facets(input, "", [&](std::span<const Facet>) { CHECK(none.empty()); }, {.numbers = &none});
}

TEST_CASE("Line ends of every system, and a byte order mark, change nothing") {
  for (const std::string& text : {kObj, ascii_stl(tetrahedron(), "t"), ply_header("ascii") + kPlyBody})
    for (const std::string end : {"\r\n", "\r"}) {
      std::string other;
      for (char c : text) other += c == '\n' ? end : std::string(1, c);
      CHECK(read(other).facets == tetrahedron());
      if (!text.starts_with("ply")) CHECK(read("\xef\xbb\xbf" + other).facets == tetrahedron());
    }
  CHECK(read(replaced(binary_ply<float>(std::endian::little), "end_header\n", "end_header\r\n")).facets == tetrahedron());
}

TEST_CASE("A file is read, hashed as xxhsum does, and closed again") {
  const TemporaryFile file(gzipped(kObj));
  const size_t before = testing::open_descriptors();
  Facets facets;
  const SurfaceFile found = read_facets(file.path, "", [&](std::span<const Facet> some) {
    for (const Facet& f : some) facets.push_back(f.vertex);
  });
  CHECK(facets == tetrahedron());
  CHECK(found.bytes == gzipped(kObj).size());
  const XXH128_hash_t hash = XXH3_128bits(gzipped(kObj).data(), gzipped(kObj).size());
  char hex[33];
  std::snprintf(hex, sizeof hex, "%016llx%016llx", static_cast<unsigned long long>(hash.high64), static_cast<unsigned long long>(hash.low64));
  CHECK(found.hash == hex);

  const TemporaryFile broken(binary_stl(tetrahedron()).substr(0, 200));
  CHECK_THROWS_AS(read_facets(broken.path, "", [](auto) {}), InputError);
  CHECK_THROWS_AS(read_facets("/nowhere/hull.stl", "", [](auto) {}), IoError);
  CHECK_THROWS_AS(read_facets("/", "", [](auto) {}), IoError);
  CHECK_THROWS_WITH(read_facets("/nowhere/hull.stl", "", [](auto) {}), Contains("/nowhere/hull.stl") && Contains("No such file"));
  CHECK(testing::open_descriptors() == before);
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

  std::mt19937_64 random(1);
  std::vector<std::string> numbers = {"1.000000059604644775390625", "16777217",          "16777219", "9007199254740993",
                                      "0.000000000000000001",       "9007199254740992.5"};
  for (int i = 0; i < 3000; ++i) {  // of up to 20 digits, and near the middles of floats
    std::string digits = i % 3 == 0 ? std::to_string((uint64_t{1} << 24) + random() % (1 << 24)) + "5" : std::to_string(random() >> random() % 60);
    if (const size_t point = random() % (digits.size() + 1); point > 0 && point < digits.size()) digits.insert(point, ".");
    numbers.push_back((random() % 2 == 0 ? "-" : "") + digits);
  }
  for (const std::string& number : numbers) {
    CAPTURE(number);
    REQUIRE(through_obj(number) == std::stod(number));
    REQUIRE(through_stl(number) == std::stof(number));
  }
}

TEST_CASE("Signs, exponents and points may be written in every usual way") {
  CHECK(through_obj("+1.5E+1") == 15);
  CHECK(through_obj(".5") == 0.5);
  CHECK(through_obj("5.") == 5);
  CHECK(through_obj("-5.e-1") == -0.5);
  for (const char* bad : {"", "+", "+-1", "--1", "1,5", "0x10", "1e", "1.5.2", "abc", "1d3"}) {
    CAPTURE(bad);
    CHECK_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 " + std::string(bad) + "\nf 1 2 3\n"), Contains("mesh: line 3: expected a number"));
  }
}

TEST_CASE("Minus zero is read as zero") {
  for (double v : {through_obj("-0"), through_obj("-0.0e5"), through_stl("-0"), through_stl("-1e-60"), through_obj("-1e-400")})
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
  for (const char* bad : {"1.1e75", "1e-76", "5e-324", "3e-324", "1e400", "-1e400", "1e99999999999999999999", "inf", "-inf", "nan"}) {
    CAPTURE(bad);
    CHECK_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 " + std::string(bad) + "\nf 1 2 3\n"),
               Contains("mesh: line 3: '" + std::string(bad) + "': expected a"));
  }
  for (const char* bad : {"inf", "nan", "infinity"}) {
    CAPTURE(bad);
    CHECK_THAT(refusal(one_facet_stl(bad)), Contains("mesh: line 6") && Contains("expected a finite coordinate"));
  }
  for (const std::string bad : {"1e39", "3.4028236e38", "+1e39", "-1e400"}) {
    CAPTURE(bad);
    const auto too_large = Contains("'" + bad + "': expected a coordinate, found a number too large for float32 (at most 3.4e38)");
    CHECK_THAT(refusal(one_facet_stl(bad)), Contains("mesh: line 6: ") && too_large);
    CHECK_THAT(refusal(replaced(ply_header("ascii") + kPlyBody, "0.5", bad)), Contains("mesh: line 14: ") && too_large);
  }
  for (const std::string& text : {replaced(kObj, "0.5", "1e309"), replaced(ply_header("ascii", "double") + kPlyBody, "0.5", "1e309")})
    CHECK_THAT(refusal(text), Contains("'1e309': ") && Contains("found a number too large for float64 (at most 1.8e308)"));
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
             Contains("expected STL, OBJ, PLY, OFF, 3MF, glTF or STEP, found 'Dear reader,?this is a letter?'"));
  CHECK_THAT(refusal("unheard of" + std::string(200, '\1') + std::string(1, '\0')), Contains("byte 80") && Contains("or not an STL file"));
  CHECK_THAT(refusal(std::string(20, '\0')), Contains("expected STL, OBJ, PLY, OFF, 3MF, glTF or STEP"));
  CHECK_THAT(refusal("# only a remark\n"), Contains("mesh: holds no facet"));
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
  CHECK_THAT(refusal(text, "Deck"), Contains("no part matches 'Deck': the file has 4 parts: 'deck', 'aft', 'hull', 'big mast'"));
  CHECK_THAT(refusal(kObj, "deck"), Contains("no part matches 'deck': the file names no parts"));
  CHECK_THAT(refusal(text + "g last\n", "last"), Contains("the parts that match 'last' hold no facet"));
}

TEST_CASE("Names of parts are kept up to some megabytes, and parts are found however many there are") {
  std::string text = kObj;
  for (int i = 0; i < 100'000; ++i) text += "g " + std::to_string(i) + "\n";
  text += "g last\nf 1 2 3\n";
  CHECK(read(text, "last").facets.size() == 1);
  CHECK(read(text).file.parts.size() < 100'000);
  CHECK_THAT(refusal(text, "deck"), Contains("no part matches 'deck': the file has more than ") && Contains("'0', '1', '2'"));
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
  CHECK_THAT(refusal(gzipped(gzipped(bytes))),
             Contains("mesh: this is a gzip file, compressed by gzip: expected STL, OBJ, PLY, OFF, 3MF, glTF or STEP; decompress it first"));
}

TEST_CASE("A file cut short anywhere is refused, or nothing but its last blanks was lost") {
  const bool zip = GENERATE(false, true);
  for (const std::string& plain : {binary_stl(tetrahedron()), ascii_stl(tetrahedron(), ""), ply_header("ascii") + kPlyBody,
                                   binary_ply<float>(std::endian::little), binary_ply<double>(std::endian::big)}) {
    if (!zip && plain.starts_with("solid")) continue;  // see below
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

TEST_CASE("An ASCII STL cut short is refused, or gives the facets that are whole, with a warning") {
  const std::string whole = ascii_stl(tetrahedron(), "");
  for (size_t n = 0; n < whole.size(); ++n) {
    CAPTURE(n);
    const std::string text = whole.substr(0, n);
    size_t facets = 0;
    for (size_t at = text.find("endfacet"); at != std::string::npos; at = text.find("endfacet", at + 1)) ++facets;
    const bool between = facets > 0 && text.rfind("endfacet") + 8 > text.find_last_not_of(" \n") &&
                         text.find("facet", text.rfind("endfacet") + 8) == std::string::npos;
    if (!between && facets < 4) {
      CHECK(refusal(text) != "");
      continue;
    }
    const Result r = read(text);
    const Facets all = tetrahedron();
    CHECK(r.facets == Facets(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(facets)));
    CHECK(r.file.warnings.empty() == (whole.find_first_not_of(" \n", n) == std::string::npos));
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
  const auto meshes = testing::shared_files("meshes");
  if (!meshes) return;
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
    const SurfaceFile file = read_facets(*meshes / name, "", [&](std::span<const Facet> some) { seen += some.size(); });
    CHECK(file.format == format);
    CHECK(file.facets == facets);
    CHECK(seen == facets);
    CHECK(file.parts.size() == parts);
    CHECK(file.bytes == std::filesystem::file_size(*meshes / name));
  }
  for (const char* name : {"broken/empty.stl", "broken/empty-binary.stl"})
    CHECK_THROWS_WITH(read_facets(*meshes / name, "", [](auto) {}), Contains("holds no facet"));
}

#include "tools/export/formats.hpp"

#include "store/base/error.hpp"
#include "store/text/npy_header.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

using namespace teracell;
using namespace teracell::exports;
using namespace teracell::testing;

namespace {

// A grid of random cells on disk. Its labels are few, and its materials as many as asked for.
struct Stored {
  Stored(const Index3& size, uint32_t materials) : n(size), wide(materials > 256) {
    constexpr uint32_t kLabels = 5;
    std::mt19937_64 random(7);
    cells = random_cells(random, n, kLabels);
    Metadata meta = with_tiny_chunks(metadata_of(unit_grid(n), 1, materials));
    meta.labels.resize(kLabels);
    for (uint32_t i = 0; i < kLabels; ++i) meta.labels[i].material = i * (materials - 1) / (kLabels - 1);
    store_cells(folder / "g.tcell", meta, cells);
    reader.emplace(folder / "g.tcell");
  }
  // The material ids of `box` on level 0, as arrays hold them.
  Bytes dense(const Box& box) const {
    Bytes out;
    for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
      for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
        for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) {
          const uint32_t material = reader->meta().labels[cells[(z * n[1] + y) * n[0] + x]].material;
          out.push_back(static_cast<uint8_t>(material));
          if (wide) out.push_back(static_cast<uint8_t>(material >> 8));
        }
    return out;
  }
  Bytes written(const std::string& name, const Box& box) const {
    export_format_of(name)->write({*reader, 0, box, folder / name, [](double) {}});
    return file_bytes(folder / name);
  }

  TempFolder folder;
  Index3 n;
  bool wide;
  std::vector<Label> cells;
  std::optional<GridReader> reader;
};

}  // namespace

TEST_CASE("Formats have names and extensions of their own, and are found by both", "[export]") {
  std::set<std::string> names, extensions;
  for (const ExportFormat& format : export_formats()) {
    CHECK(names.insert(format.name).second);
    CHECK(export_format_named(format.name) == &format);
    CHECK_FALSE(format.holds.empty());
    for (const std::string& extension : format.extensions) {
      CHECK(extensions.insert(extension).second);
      CHECK(export_format_of("folder.npy/name" + extension) == &format);
    }
  }
  CHECK(export_format_named("tiff") == nullptr);
  CHECK(export_format_of("name.tiff") == nullptr);
  CHECK(export_format_of("npy") == nullptr);
}

TEST_CASE("An array holds the materials of the box in C order, in one byte per cell or in two", "[export]") {
  for (const uint32_t materials : {5u, 256u, 257u}) {
    const Stored s({13, 9, 11}, materials);
    for (const Box& box : {Box{{0, 0, 0}, s.n}, Box{{3, 8, 1}, {12, 9, 10}}}) {
      const Bytes dense = s.dense(box);
      CHECK((s.written("cells.raw", box) == dense));
      Bytes expected = npy_header(s.wide ? "<u2" : "|u1", {box.hi[2] - box.lo[2], box.hi[1] - box.lo[1], box.hi[0] - box.lo[0]});
      expected.insert(expected.end(), dense.begin(), dense.end());
      CHECK((s.written("cells.npy", box) == expected));
    }
  }
}

TEST_CASE("A coarse level is exported as the reader gives it", "[export]") {
  const Stored s({13, 9, 11}, 5);
  const Index3 n = s.reader->meta().grid.cells(2);
  export_format_named("raw")->write({*s.reader, 2, {{0, 0, 0}, n}, s.folder / "x.raw", [](double) {}});
  const std::vector<uint32_t> cells = all_cells(*s.reader, 2);
  CHECK((file_bytes(s.folder / "x.raw") == Bytes(cells.begin(), cells.end())));
}

TEST_CASE("Steps of an export ascend from 0 to 1, and one that throws leaves nothing", "[export]") {
  const TempFolder folder;
  const Index3 n{13, 9, 11};
  const mesher::Scene scene =
      scene_of(folder, {{shapes::sphere({6, 5, 5}, 4.2, 1)}, {shapes::box({3, 3, 3}, {8.2, 8.3, 8.4}), oracle::Rule::kNonzero, 2}}, unit_grid(n));
  mesh_quietly(scene, folder / "g.tcell", {.fractions = Subdivision{2, 2, 4}, .links = true});
  const GridReader reader(folder / "g.tcell");
  const std::string inner = reader.meta().materials[1].name, outer = reader.meta().materials[2].name;
  std::vector<std::pair<const ExportFormat*, std::map<std::string, std::string>>> exports;
  for (const ExportFormat& format : export_formats()) {
    std::map<std::string, std::string> options;
    if (format.name == "openems") options["--epsilon"] = inner + "=2," + outer + "=3";
    if (format.name == "leaves" || format.name == "vtu") options["--refine"] = "5,1";
    exports.emplace_back(&format, options);
    if (format.name == "openfoam") exports.emplace_back(&format, std::map<std::string, std::string>{{"--refine", "5,1"}, {"--drop-unreachable", ""}});
    for (const char* more : {"--fractions", "--patches"})
      if (std::ranges::count(format.options, more, &ExportOption::name) > 0) options[more], exports.emplace_back(&format, options);
  }
  CHECK(exports.size() == export_formats().size() + 6);
  for (size_t i = 0; i < exports.size(); ++i) {
    const auto& [format, options] = exports[i];
    INFO(format->name);
    std::vector<double> shares;
    format->write({reader, 0, {{0, 0, 0}, n}, folder / ("done-" + std::to_string(i)), [&](double share) { shares.push_back(share); }, {}, options});
    CHECK(shares.front() == 0);
    CHECK(shares.back() == 1);
    CHECK(std::ranges::is_sorted(shares));
    for (const double last : {0.0, 1.0}) {
      const auto stop = [&](double share) {
        if (share == last) throw Interrupted("stopped");
      };
      CHECK_THROWS_AS(format->write({reader, 0, {{0, 0, 0}, n}, folder / "stopped", stop, {}, options}), Interrupted);
      for (const auto& left : std::filesystem::directory_iterator(folder.path())) CHECK_FALSE(left.path().filename().string().starts_with("stopped"));
    }
  }
}

TEST_CASE("VTK's files and NRRD are the array behind a header that says where its cells lie", "[export]") {
  const Stored s({13, 9, 11}, 5);
  const Box box{{3, 2, 1}, {12, 9, 10}};
  const Bytes dense = s.dense(box);
  const auto text = [](const Bytes& bytes) { return std::string(bytes.begin(), bytes.end()); };
  const std::string cells = text(dense), vti = text(s.written("x.vti", box)), vtr = text(s.written("x.vtr", box)),
                    nrrd = text(s.written("x.nrrd", box));
  CHECK(vti.find("WholeExtent=\"0 9 0 7 0 9\" Origin=\"3 2 1\" Spacing=\"1 1 1\"") != std::string::npos);
  CHECK(vti.substr(vti.find("\n_") + 2 + 8, cells.size()) == cells);
  Bytes size;
  put_fixed(size, static_cast<uint64_t>(cells.size()));
  CHECK(vti.substr(vti.find("\n_") + 2, 8) == text(size));
  CHECK(vti.ends_with("</AppendedData>\n</VTKFile>\n"));
  const size_t planes = 3 * 8 + 8 * (10 + 8 + 10);
  CHECK(vtr.find(fmt::format("Name=\"material\" format=\"appended\" offset=\"{}\"", planes)) != std::string::npos);
  CHECK(vtr.substr(vtr.find("\n_") + 2 + planes + 8, cells.size()) == cells);
  CHECK(nrrd.find("sizes: 9 7 9\n") != std::string::npos);
  CHECK(nrrd.find("space origin: (3.5,2.5,1.5)\n") != std::string::npos);
  CHECK(nrrd.substr(nrrd.find("\n\n") + 2) == cells);
}

TEST_CASE("Arrays hold the numbers of a map, in as many bytes as the largest needs", "[export]") {
  const Stored s({13, 9, 11}, 5);
  const Box box{{0, 0, 0}, s.n};
  const Bytes ids = s.dense(box);
  for (const uint32_t large : {9u, 255u, 256u, 65535u, 65536u, 4294967295u}) {
    const std::vector<uint32_t> map = {3, large, 1, 0, 7};
    export_format_named("raw")->write({*s.reader, 0, box, s.folder / "m.raw", [](double) {}, map});
    const Bytes found = file_bytes(s.folder / "m.raw");
    const size_t bytes = large < 256 ? 1 : large < 65536 ? 2 : 4;
    REQUIRE(found.size() == bytes * ids.size());
    bool same = true;
    for (size_t i = 0; i < ids.size(); ++i) {
      uint32_t value = 0;
      for (size_t b = 0; b < bytes; ++b) value |= uint32_t{found[i * bytes + b]} << (8 * b);
      same = same && value == map[ids[i]];
    }
    CHECK(same);
  }
}

namespace {

std::string text_of(const std::filesystem::path& path) {
  const Bytes bytes = file_bytes(path);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

TEST_CASE("MetaImage is the array with a header that says where its cells lie, in two files or in one", "[export]") {
  for (const uint32_t materials : {5u, 257u}) {
    const Stored s({13, 9, 11}, materials);
    const Box box{{3, 2, 1}, {12, 9, 10}};
    const Bytes dense = s.dense(box);
    s.written("x.mhd", box);
    const std::string head = text_of(s.folder / "x.mhd"), whole = text_of((s.written("x.mha", box), s.folder / "x.mha"));
    CHECK((file_bytes(s.folder / "x.raw") == dense));
    CHECK(head.find("\nOffset = 3.5 2.5 1.5\n") != std::string::npos);
    CHECK(head.find("\nElementSpacing = 1 1 1\nDimSize = 9 7 9\n") != std::string::npos);
    CHECK(head.find("\nMaterial4 = m4\n") != std::string::npos);
    CHECK(head.ends_with(materials > 256 ? "\nElementType = MET_USHORT\nElementDataFile = x.raw\n"
                                         : "\nElementType = MET_UCHAR\nElementDataFile = x.raw\n"));
    const std::string local = "ElementDataFile = LOCAL\n";
    const size_t end = whole.find(local) + local.size();
    CHECK(whole.substr(0, end - local.size()) == head.substr(0, head.find("ElementDataFile")));
    CHECK(whole.substr(end) == std::string(dense.begin(), dense.end()));
  }
}

TEST_CASE("A header or an array of two files never takes the place of the grid", "[export]") {
  const Stored s({13, 9, 11}, 5);
  std::filesystem::rename(s.folder / "g.tcell", s.folder / "g.raw");
  const GridReader reader(s.folder / "g.raw");
  const Bytes grid = file_bytes(s.folder / "g.raw");
  const Box box{{0, 0, 0}, s.n};
  CHECK_THROWS_AS(export_format_named("mhd")->write({reader, 0, box, s.folder / "g.mhd", [](double) {}}), UsageError);
  CHECK_THROWS_AS(export_format_named("mhd")->write({reader, 0, box, s.folder / "x.raw", [](double) {}}), UsageError);  // both would be x.raw
  CHECK((file_bytes(s.folder / "g.raw") == grid));
  for (const char* name : {"g.mhd", "x.raw"}) CHECK_FALSE(std::filesystem::exists(s.folder / name));
}

TEST_CASE("Palabos' text has the numbers with x slowest, a line for each row along z", "[export]") {
  const Stored s({5, 4, 3}, 5);
  for (const Box& box : {Box{{0, 0, 0}, s.n}, Box{{1, 2, 0}, {4, 4, 2}}}) {
    const Bytes dense = s.dense(box);
    const Index3 n = {box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]};
    std::string expected;
    for (int64_t x = 0; x < n[0]; ++x)
      for (int64_t y = 0; y < n[1]; ++y)
        for (int64_t z = 0; z < n[2]; ++z)
          expected += fmt::format("{}{}", dense[static_cast<size_t>((z * n[1] + y) * n[0] + x)], z + 1 < n[2] ? ' ' : '\n');
    s.written("x.dat", box);
    CHECK(text_of(s.folder / "x.dat") == expected);
  }
}

TEST_CASE("With --header a text beside raw and Palabos' numbers says what they are", "[export]") {
  const Stored s({13, 9, 11}, 257);
  const Box box{{3, 2, 1}, {12, 9, 10}};
  const auto written = [&](const std::string& format, const std::string& name, int level, const Box& cells) {
    Export e{*s.reader, level, cells, s.folder / name, [](double) {}};
    export_format_named(format)->write(e);
    const Bytes plain = file_bytes(e.output);
    CHECK_FALSE(std::filesystem::exists(s.folder / (name + ".txt")));
    e.options["--header"];
    export_format_named(format)->write(e);
    CHECK((file_bytes(e.output) == plain));
    return text_of(s.folder / (name + ".txt"));
  };
  const std::string raw = written("raw", "x.raw", 0, box);
  CHECK(
      raw.find("\nfile: x.raw\ntype: uint16 little endian\norder: x fastest, z slowest\nsizes: 9 7 9\nlevel: 0\nregion: 3 2 1 12 9 10\nunits: m\n") !=
      std::string::npos);
  CHECK(raw.find("\nx first plane: 3\nx step: 1\ny first plane: 2\n") != std::string::npos);
  CHECK(raw.find("\nmaterial 0: m0\n") != std::string::npos);
  CHECK(raw.ends_with("\nmaterial 256: m256\n"));
  const std::string coarse = written("palabos", "x.dat", 1, s.reader->meta().grid.box(1));
  CHECK(coarse.find("\ntype: integers as text\norder: z fastest, x slowest\nsizes: 7 5 6\nlevel: 1\n") != std::string::npos);
  CHECK(coarse.find("\nx first plane: 0\nx step: 2\n") != std::string::npos);
}

TEST_CASE("The header of raw cells has the planes of a graded axis", "[export]") {
  TempFolder folder;
  Grid grid = unit_grid({3, 2, 2});
  grid.axis[0] = Axis::graded({-1, 0.5, 0.75, 4}, 0.5);
  Metadata meta = metadata_of(grid, 1, 2);
  meta.materials[1].name = "a\nb";
  store_cells(folder / "g.tcell", meta, std::vector<Label>(12, 1));
  const GridReader reader(folder / "g.tcell");
  export_format_named("raw")->write({reader, 1, grid.box(1), folder / "x.raw", [](double) {}, {}, {{"--header", ""}}});
  const std::string text = text_of(folder / "x.raw.txt");
  CHECK(text.find("\nx planes: -1 0.75 4\n") != std::string::npos);
  CHECK(text.find("\nmaterial 1: a\\nb\n") != std::string::npos);
  CHECK_THROWS_AS(export_format_named("mhd")->write({reader, 0, grid.box(0), folder / "x.mhd", [](double) {}}), UsageError);
}

#include <regex>

#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"
#include "tools/export/formats.hpp"
#include "tools/export/openems/boxes.hpp"

using namespace teracell;
using namespace teracell::exports;
using namespace teracell::testing;

namespace {

// A layer whose runs are those of rows of letters; '.' is no cell of the mesh.
Layer layer_of(const std::vector<std::string>& rows) {
  Layer out;
  for (const std::string& row : rows) {
    for (size_t x = 0; x < row.size();) {
      size_t end = row.find_first_not_of(row[x], x);
      if (end == std::string::npos) end = row.size();
      out.runs.push_back({static_cast<int32_t>(x), static_cast<int32_t>(end), static_cast<uint32_t>(row[x] - 'a'), 0, row[x] == '.' ? -1 : 0});
      x = end;
    }
    out.rows.push_back(out.runs.size());
  }
  return out;
}

std::vector<MaterialBox> merged(const std::vector<std::vector<std::string>>& layers) {
  BoxMerger merger(1000);
  for (size_t z = 0; z < layers.size(); ++z) merger.add(layer_of(layers[z]), static_cast<int32_t>(z));
  return merger.finish();
}

}  // namespace

TEST_CASE("Runs become rectangles, and rectangles become boxes", "[export]") {
  CHECK(merged({{"aaa", "aaa"}, {"aaa", "aaa"}, {"aaa", "aaa"}}).size() == 1);
  CHECK(merged({{"...", "..."}}).empty());
  CHECK(merged({{"aab", "aab"}, {"aab", "aab"}}).size() == 2);
  CHECK(merged({{"aa.", "aa."}, {".aa", ".aa"}}).size() == 2);  // shifted
  CHECK(merged({{"a"}, {"."}, {"a"}}).size() == 2);
  CHECK(merged({{"a", ".", "a"}}).size() == 2);
  CHECK(merged({{"a.a", "a.a"}, {"a.a", "a.a"}}).size() == 2);
  CHECK(merged({{"aaa", "a.a", "aaa"}}).size() == 4);
  const MaterialBox box = merged({{"....", "...."}, {"....", ".bb.", ".bb."}, {"....", ".bb.", ".bb."}}).at(0);
  CHECK(box.material == 1);
  CHECK(box.lo == std::array{1, 1, 1});
  CHECK(box.hi == std::array{3, 3, 3});
  BoxMerger few(2);
  few.add(layer_of({"a.a"}), 0);
  few.add(layer_of({"a.a"}), 1);
  CHECK_THROWS_WITH(few.add(layer_of({".a."}), 2), Catch::Contains("at most 2 boxes"));
}

TEST_CASE("Boxes of openEMS fill the cells of their materials", "[export]") {
  const TempFolder folder;
  const Index3 n = {23, 17, 19};
  std::mt19937_64 random(3);
  const std::vector<Label> cells = random_cells(random, n, 4);
  Grid grid;
  grid.axis[0] = Axis::uniform(-3, 0.1, 0, n[0], 0.5);
  grid.axis[1] = Axis::uniform(0, 1, 0, n[1], 0.5);
  std::vector<double> planes;
  for (int64_t i = 0; i <= n[2]; ++i) planes.push_back(static_cast<double>(i * i) / 7);
  grid.axis[2] = Axis::graded(planes, 0.5);
  Metadata meta = with_tiny_chunks(metadata_of(grid, 0, 4));
  meta.units = "mm";
  meta.materials[2].name = "a <\"&>";
  store_cells(folder / "g.tcell", meta, cells);
  const GridReader reader(folder / "g.tcell");
  const Box box = {{1, 2, 3}, {23, 16, 18}};
  const auto write = [&](std::map<std::string, std::string> options) {
    export_format_named("openems")->write({reader, 0, box, folder / "x.xml", [](double) {}, {}, std::move(options)});
    return bytes_of(folder / "x.xml");
  };
  const std::string xml = write({{"--epsilon", "m1=2.25,a <\"&>=4,m3=1"}, {"--sigma", "m1=0.5,m3=inf"}});
  CHECK(xml.find("<RectilinearGrid DeltaUnit=\"0.001\"") != std::string::npos);
  CHECK(xml.find("<Material ID=\"2\" Name=\"a &lt;&quot;&amp;&gt;\">") != std::string::npos);
  CHECK(xml.find("<Property Epsilon=\"2.25\" Mue=\"1\" Kappa=\"0.5\" Sigma=\"0\"/>") != std::string::npos);
  CHECK(xml.find("<Metal ID=\"3\" Name=\"m3\">") != std::string::npos);

  // Each number of a box is one of the lines, to the last digit.
  std::array<std::map<std::string, int64_t>, 3> lines;
  for (int d = 0; d < 3; ++d) {
    const std::string begin = fmt::format("<{}Lines>", "XYZ"[d]);
    const size_t from = xml.find(begin) + begin.size();
    std::istringstream list(xml.substr(from, xml.find('<', from) - from));
    int64_t i = box.lo[d];
    for (std::string number; std::getline(list, number, ','); ++i) {
      CHECK(std::stod(number) == grid.axis[d].plane(i));
      lines[d][number] = i;
    }
    CHECK(i == box.hi[d] + 1);
  }
  std::vector<Label> painted(cells.size(), 0);
  size_t twice = 0, boxes = 0;
  Label material = 0;
  const std::regex what(R"re(<(?:Material|Metal) ID="(\d+)"|<P1 X="([^"]*)" Y="([^"]*)" Z="([^"]*)"/><P2 X="([^"]*)" Y="([^"]*)" Z="([^"]*)"/>)re");
  for (auto at = std::sregex_iterator(xml.begin(), xml.end(), what); at != std::sregex_iterator(); ++at) {
    if ((*at)[1].matched) {
      material = static_cast<Label>(std::stoul((*at)[1]));
      continue;
    }
    ++boxes;
    Index3 lo, hi;
    for (int d = 0; d < 3; ++d) lo[d] = lines[d].at((*at)[2 + d]), hi[d] = lines[d].at((*at)[5 + d]);
    for (int64_t z = lo[2]; z < hi[2]; ++z)
      for (int64_t y = lo[1]; y < hi[1]; ++y)
        for (int64_t x = lo[0]; x < hi[0]; ++x) {
          Label& cell = painted[static_cast<size_t>((z * n[1] + y) * n[0] + x)];
          twice += cell != 0;
          cell = material;
        }
  }
  size_t wrong = 0, inside = 0;
  for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
    for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
      for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) {
        const auto i = static_cast<size_t>((z * n[1] + y) * n[0] + x);
        wrong += painted[i] != cells[i];
        inside += cells[i] != 0;
      }
  CHECK(wrong == 0);
  CHECK(twice == 0);
  CHECK(boxes * 2 < inside);
  CHECK_THROWS_WITH(write({{"--epsilon", "m1=2.25,m3=1"}}), Catch::Contains("--epsilon") && Catch::Contains("a <\"&>"));
}

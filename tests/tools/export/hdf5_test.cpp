#include <hdf5.h>
#include <sys/resource.h>

#include "store/base/error.hpp"
#include "store/channels/fraction_reader.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"
#include "tools/export/formats.hpp"

using namespace teracell;
using namespace teracell::exports;
using namespace teracell::testing;
namespace fs = std::filesystem;

namespace {

using Options = std::map<std::string, std::string>;

// A grid of balls, noise and plain corners, of several chunks of HDF5 along each axis of which the last ones are cut.
struct H5Cells {
  explicit H5Cells(uint32_t materials, int ray_axis = 2, bool graded = false) : n{70, 149, 67} {
    std::mt19937_64 random(11);
    cells = random_cells(random, n, 5);
    for (int64_t z = 0; z < 64; ++z)  // a chunk of one material
      for (int64_t y = 0; y < 64; ++y)
        for (int64_t x = 0; x < 64; ++x) cells[static_cast<size_t>((z * n[1] + y) * n[0] + x)] = 3;
    Grid grid;
    for (int d = 0; d < 3; ++d) grid.axis[d] = Axis::uniform(d, 0.5, 0, n[d], 0.5);
    if (graded) {
      std::vector<double> planes(static_cast<size_t>(n[1]) + 1);
      for (size_t i = 0; i < planes.size(); ++i) planes[i] = static_cast<double>(i * i) / 8;
      grid.axis[1] = Axis::graded(planes, 0.5);
    }
    Metadata meta = metadata_of(grid, ray_axis, materials);
    meta.units = "mm";
    meta.labels.resize(5);
    for (uint32_t i = 0; i < 5; ++i) meta.labels[i].material = i * (materials - 1) / 4;
    store_cells(folder / "g.tcell", meta, cells);
    reader.emplace(folder / "g.tcell");
  }
  const Metadata& meta() const { return reader->meta(); }
  Box all() const { return {{0, 0, 0}, n}; }
  fs::path write(const std::string& name, const Box& box, const Options& options = {}, int level = 0, std::vector<uint32_t> map = {}) const {
    return write_as("hdf5", name, box, options, level, std::move(map));
  }
  fs::path write_as(const char* format, const std::string& name, const Box& box, const Options& options = {}, int level = 0,
                    std::vector<uint32_t> map = {}) const {
    export_format_named(format)->write({*reader, level, box, folder / name, [](double) {}, std::move(map), options});
    return folder / name;
  }
  // Materials of the cells of `box`, of which x varies fastest, or z.
  std::vector<uint32_t> materials(const Box& box, bool x_fastest, int level = 0) const {
    const std::vector<uint32_t> level_cells = all_cells(*reader, level);
    const Index3 m = meta().grid.cells(level);
    std::vector<uint32_t> out;
    const int slow = x_fastest ? 2 : 0, fast = 2 - slow;
    Index3 at;
    for (at[slow] = box.lo[slow]; at[slow] < box.hi[slow]; ++at[slow])
      for (at[1] = box.lo[1]; at[1] < box.hi[1]; ++at[1])
        for (at[fast] = box.lo[fast]; at[fast] < box.hi[fast]; ++at[fast])
          out.push_back(level_cells[static_cast<size_t>((at[2] * m[1] + at[1]) * m[0] + at[0])]);
    return out;
  }

  TempFolder folder;
  Index3 n;
  std::vector<Label> cells;
  std::optional<GridReader> reader;
};

struct Read {
  std::vector<hsize_t> size;
  H5T_class_t kind;
  size_t bytes;
  std::vector<double> values;
};

// A dataset, or an attribute of an object, as doubles.
Read read_h5(const fs::path& path, const std::string& object, const std::string& attribute = "") {
  Read out;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  REQUIRE(file >= 0);
  const hid_t o = H5Oopen(file, object.c_str(), H5P_DEFAULT);
  REQUIRE(o >= 0);
  const hid_t a = attribute.empty() ? -1 : H5Aopen(o, attribute.c_str(), H5P_DEFAULT);
  const hid_t space = a < 0 ? H5Dget_space(o) : H5Aget_space(a), type = a < 0 ? H5Dget_type(o) : H5Aget_type(a);
  REQUIRE(space >= 0);
  out.size.resize(static_cast<size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, out.size.data(), nullptr);
  out.kind = H5Tget_class(type);
  out.bytes = H5Tget_size(type);
  out.values.resize(static_cast<size_t>(H5Sget_simple_extent_npoints(space)));
  REQUIRE((a < 0 ? H5Dread(o, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.values.data())
                 : H5Aread(a, H5T_NATIVE_DOUBLE, out.values.data())) >= 0);
  if (a >= 0) H5Aclose(a);
  H5Tclose(type);
  H5Sclose(space);
  H5Oclose(o);
  H5Fclose(file);
  return out;
}

// Texts of variable length: a dataset, or an attribute of an object.
std::vector<std::string> read_h5_texts(const fs::path& path, const std::string& object, const std::string& attribute = "") {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t o = H5Oopen(file, object.c_str(), H5P_DEFAULT);
  const hid_t a = attribute.empty() ? -1 : H5Aopen(o, attribute.c_str(), H5P_DEFAULT);
  const hid_t space = a < 0 ? H5Dget_space(o) : H5Aget_space(a), type = a < 0 ? H5Dget_type(o) : H5Aget_type(a);
  REQUIRE(H5Tis_variable_str(type) > 0);
  std::vector<char*> texts(static_cast<size_t>(H5Sget_simple_extent_npoints(space)));
  REQUIRE((a < 0 ? H5Dread(o, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()) : H5Aread(a, type, texts.data())) >= 0);
  std::vector<std::string> out(texts.begin(), texts.end());
  H5Dvlen_reclaim(type, space, H5P_DEFAULT, texts.data());
  if (a >= 0) H5Aclose(a);
  H5Tclose(type);
  H5Sclose(space);
  H5Oclose(o);
  H5Fclose(file);
  return out;
}

template <class T>
bool same_numbers(const std::vector<double>& found, const std::vector<uint32_t>& materials, const std::vector<T>& values) {
  bool same = found.size() == materials.size();
  for (size_t i = 0; same && i < found.size(); ++i) same = found[i] == static_cast<double>(values[materials[i]]);
  return same;
}

std::vector<double> ids_of(uint32_t materials) {
  std::vector<double> out(materials);
  std::iota(out.begin(), out.end(), 0);
  return out;
}

std::vector<hsize_t> size_zyx(const Box& b) {
  return {static_cast<hsize_t>(b.hi[2] - b.lo[2]), static_cast<hsize_t>(b.hi[1] - b.lo[1]), static_cast<hsize_t>(b.hi[0] - b.lo[0])};
}
std::vector<hsize_t> size_xyz(const Box& b) {
  std::vector<hsize_t> out = size_zyx(b);
  std::ranges::reverse(out);
  return out;
}

size_t files_in(const TempFolder& folder) {
  return static_cast<size_t>(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
}

const Options kAllMedia = {{"--epsilon", "m0=1,m1=2.25,m2=4,m3=9.5,m4=80"}, {"--sigma", "m2=0.01"}, {"--mu", "m3=2"}};

}  // namespace

TEST_CASE("A plain HDF5 file holds cells, planes, materials and where they come from", "[export]") {
  for (const uint32_t materials : {5u, 257u})
    for (const int ray_axis : {0, 2}) {
      const H5Cells s(materials, ray_axis, true);
      for (const Box& box : {s.all(), Box{{3, 70, 1}, {69, 149, 2}}}) {
        const fs::path path = s.write("plain.h5", box);
        const Read cells = read_h5(path, "material");
        CHECK(cells.size == size_zyx(box));
        CHECK(cells.kind == H5T_INTEGER);
        CHECK(cells.bytes == (materials > 256 ? 2 : 1));
        CHECK(same_numbers(cells.values, s.materials(box, true), ids_of(materials)));
        for (int d = 0; d < 3; ++d) {
          std::vector<double> planes;
          for (int64_t i = box.lo[d]; i <= box.hi[d]; ++i) planes.push_back(s.meta().grid.axis[d].plane(i));
          CHECK(read_h5(path, "planes_" + axis_name(d)).values == planes);
        }
        CHECK(read_h5(path, "/", "region").values == std::vector<double>({double(box.lo[0]), double(box.lo[1]), double(box.lo[2]), double(box.hi[0]),
                                                                          double(box.hi[1]), double(box.hi[2])}));
        CHECK(read_h5(path, "/", "level").values == std::vector<double>{0});
        CHECK(read_h5_texts(path, "/", "units") == std::vector<std::string>{"mm"});
        CHECK(read_h5_texts(path, "/", "content_hash") == std::vector<std::string>{s.reader->hash()});
        const std::vector<std::string> names = read_h5_texts(path, "materials/name");
        REQUIRE(names.size() == materials);
        for (uint32_t id = 0; id < materials; ++id) CHECK(names[id] == fmt::format("m{}", id));
        CHECK(read_h5_texts(path, "materials/color") == std::vector<std::string>(materials, "#808080"));
        CHECK(read_h5(path, "materials/number").values == ids_of(materials));
      }
    }
}

TEST_CASE("HDF5 has the cells and planes of a coarse level, and the numbers of a map", "[export]") {
  const H5Cells s(5);
  const Box coarse{{0, 1, 0}, s.meta().grid.cells(3)};
  const fs::path path = s.write("coarse.h5", coarse, {}, 3);
  CHECK(same_numbers(read_h5(path, "material").values, s.materials(coarse, true, 3), ids_of(5)));
  CHECK(read_h5(path, "/", "level").values == std::vector<double>{3});
  CHECK(read_h5(path, "planes_y").values.front() == s.meta().grid.axis[1].plane(8));
  CHECK(read_h5(path, "planes_y").values.back() == s.meta().grid.axis[1].max());
  for (const uint32_t large : {255u, 65535u, 4294967295u}) {
    const std::vector<uint32_t> map = {3, large, 1, 0, 7};
    const fs::path mapped = s.write("mapped.h5", s.all(), {}, 0, map);
    const Read cells = read_h5(mapped, "material");
    CHECK(cells.bytes == (large < 256 ? 1 : large < 65536 ? 2 : 4));
    CHECK(same_numbers(cells.values, s.materials(s.all(), true), map));
    CHECK(read_h5(mapped, "materials/number").values == std::vector<double>(map.begin(), map.end()));
  }
}

TEST_CASE("The profile meep has permittivities, x slowest", "[export]") {
  const H5Cells s(5);
  for (const Box& box : {s.all(), Box{{3, 70, 1}, {69, 149, 2}}}) {
    const Read eps = read_h5(s.write("eps.h5", box, {{"--profile", "meep"}, {"--epsilon", kAllMedia.at("--epsilon")}}), "eps");
    CHECK(eps.size == size_xyz(box));
    CHECK(eps.kind == H5T_FLOAT);
    CHECK(same_numbers(eps.values, s.materials(box, false), std::vector<double>{1, 2.25, 4, 9.5, 80}));
  }
}

TEST_CASE("Shares of materials stand beside the cells, and Meep has the mean of the permittivities", "[export]") {
  const TempFolder folder;
  const mesher::MeshOptions options{.fractions = Subdivision{2, 4, 8}, .chunk_rays = 8};
  const Grid grid = unit_grid({70, 17, 15});
  mesh_quietly(scene_of(folder, {{shapes::sphere({60, 8, 8}, 6.2, 2)}, {shapes::box({3, 3, 3}, {58.2, 8.3, 8.4}), oracle::Rule::kNonzero, 2}}, grid),
               folder / "g.tcell", options);
  const GridReader reader(folder / "g.tcell");
  const FractionReader fractions(reader);
  const std::vector<MaterialInfo>& materials = reader.meta().materials;
  const auto write = [&](const char* format, const std::string& name, const Box& box, Options asked, int level = 0) {
    asked["--fractions"];
    export_format_named(format)->write({reader, level, box, folder / name, [](double) {}, {}, asked});
    return folder / name;
  };
  const std::string epsilon = fmt::format("{}=1,{}=2.25,{}=9.5", materials[0].name, materials[1].name, materials[2].name);
  for (const Box& box : {grid.box(0), Box{{3, 7, 1}, {69, 17, 2}}}) {
    const Index3 n{box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]};
    const auto cells = static_cast<size_t>(n[0] * n[1] * n[2]);
    std::vector<double> mean(cells), sum(cells);
    std::vector<std::vector<float>> shares(3, std::vector<float>(cells));
    int mixed = 0;
    for (uint32_t id = 0; id < 3; ++id) {
      std::vector<double> share(cells);
      fractions.read_box(box, id, 0.0, share.data(), {n[1] * n[2], n[2], 1});
      for (size_t i = 0; i < cells; ++i)
        mean[i] += share[i] * std::array{1.0, 2.25, 9.5}[id], sum[i] += share[i], mixed += share[i] > 0 && share[i] < 1;
      fractions.read_box(box, id, 0.0F, shares[id].data(), {1, n[0], n[0] * n[1]});
    }
    CHECK(mixed > 5);
    CHECK(std::ranges::count(sum, 1.0) == static_cast<int64_t>(cells));

    const Read eps = read_h5(write("hdf5", "eps.h5", box, {{"--profile", "meep"}, {"--epsilon", epsilon}}), "eps");
    CHECK(eps.size == size_xyz(box));
    double worst = 0;
    for (size_t i = 0; i < cells; ++i) worst = std::max(worst, std::abs(eps.values[i] - mean[i]));
    CHECK(worst <= 1e-14);  // sums of the same three numbers in other orders

    const fs::path plain = write("hdf5", "plain.h5", box, {});
    const std::string vti = bytes_of(write("vti", "x.vti", box, {})), vtr = bytes_of(write("vtr", "x.vtr", box, {}));
    const std::string xdmf = bytes_of(write("xdmf", "x.xdmf", box, {}));
    for (uint32_t id = 0; id < 3; ++id) {
      const std::string name = fmt::format("fractions/{}", id);
      const Read found = read_h5(plain, name);
      CHECK(found.size == size_zyx(box));
      CHECK(found.bytes == 4);
      CHECK(std::ranges::equal(found.values, shares[id], {}, {}, [](float f) { return static_cast<double>(f); }));
      CHECK(read_h5_texts(plain, name, "material") == std::vector{materials[id].name});
      CHECK(xdmf.find(fmt::format("fraction of {}", materials[id].name)) != std::string::npos);
      CHECK(xdmf.find(":/" + name) != std::string::npos);
      for (const std::string& vtk : {vti, vtr}) {
        CHECK(vtk.find(fmt::format("<DataArray type=\"Float32\" Name=\"fraction of {}\"", materials[id].name)) != std::string::npos);
        const std::string numbers(reinterpret_cast<const char*>(shares[id].data()), 4 * cells), end = "\n</AppendedData>\n</VTKFile>\n";
        const size_t at = vtk.size() - end.size() - (3 - id) * (8 + 4 * cells);
        const uint64_t bytes = 4 * cells;
        CHECK(vtk.substr(at, 8) == std::string(reinterpret_cast<const char*>(&bytes), 8));
        CHECK((vtk.substr(at + 8, 4 * cells) == numbers));
      }
    }
  }
  for (const char* profile : {"gprmax", "openems"})
    CHECK_THROWS_WITH(write("hdf5", "no.h5", grid.box(0), {{"--profile", profile}, {"--epsilon", epsilon}}),
                      Catch::Contains("one material for each cell"));
  CHECK_THROWS_WITH(write("vti", "no.vti", grid.box(1), {}, 1), Catch::Contains("expected --level 0"));
  CHECK_FALSE(fs::exists(folder / "no.h5"));
  CHECK_FALSE(fs::exists(folder / "no.vti"));
  const H5Cells without(2);
  CHECK_THROWS_WITH(without.write("no.h5", without.all(), {{"--fractions", ""}}), Catch::Contains("no fractions"));
  CHECK(files_in(without.folder) == 1);
}

TEST_CASE("In every format cells of sheets and kept cells have the shares that solids have in them", "[export]") {
  const TempFolder folder;
  std::vector<oracle::Body> bodies = {{shapes::box({2.2, 2.2, 0.6}, {7.7, 7.7, 4.3})},
                                      {shapes::sphere({5, 5, 5}, 3.1, 2), oracle::Rule::kNonzero, 2},
                                      {shapes::box({1.6, 1, 1}, {1.9, 9, 9}), oracle::Rule::kNonzero, 3}};
  bodies[1].sheet = true;
  mesher::Scene scene = scene_of(folder, bodies, cube_grid_of(0, 1, 10));
  scene.bodies[2].thin = mesher::Thin::kKeep;
  mesh_quietly(scene, folder / "g.tcell", {.fractions = Subdivision{2, 2, 2}});
  const GridReader reader(folder / "g.tcell");
  const Box box = reader.meta().grid.box(0);
  const auto write = [&](const char* format, const char* name) {
    export_format_named(format)->write({reader, 0, box, folder / name, [](double) {}, {}, {{"--fractions", ""}}});
    return folder / name;
  };
  const fs::path plain = write("hdf5", "plain.h5");
  write("xdmf", "x.xdmf");
  for (uint32_t id = 0; id < 4; ++id) {
    std::vector<float> share(1000);
    FractionReader(reader).read_box(box, id, 0.0F, share.data(), {1, 10, 100});
    CHECK((std::ranges::count_if(share, [](float s) { return s > 0; }) > 0) == (id != 2));  // a sheet has no share
    for (const fs::path& h5 : {plain, folder / "x.h5"})
      CHECK(std::ranges::equal(read_h5(h5, fmt::format("fractions/{}", id)).values, share, {}, {}, [](float f) { return static_cast<double>(f); }));
  }
}

TEST_CASE("The profile gprmax has numbers of lines of a file of materials, and -1 for the background", "[export]") {
  const H5Cells s(5);
  const Options options = {{"--profile", "gprmax"}, {"--epsilon", "m4=80,m1=2.25,m2=4,m3=9.5"}, {"--sigma", "m2=0.01,m4=inf"}, {"--mu", "m3=2"}};
  const Read data = read_h5(s.write("block.h5", s.all(), options), "data");
  CHECK(data.size == size_xyz(s.all()));
  CHECK(data.kind == H5T_INTEGER);
  CHECK(data.bytes == 2);
  CHECK(same_numbers(data.values, s.materials(s.all(), false), std::vector<int>{-1, 0, 1, 2, 3}));
  CHECK(bytes_of(s.folder / "block_materials.txt") ==
        "#material: 2.25 0.0 1.0 0 m1\n#material: 4.0 0.01 1.0 0 m2\n#material: 9.5 0.0 2.0 0 m3\n#material: 80.0 inf 1.0 0 m4\n");
  const Read step = read_h5(s.folder / "block.h5", "/", "dx_dy_dz");
  CHECK(step.bytes == 8);
  for (const double metres : step.values) CHECK(metres == 0.0005);
  // A background that is given is a material like others.
  Options all = kAllMedia;
  all["--profile"] = "gprmax";
  CHECK(same_numbers(read_h5(s.write("block.h5", s.all(), all, 0), "data").values, s.materials(s.all(), false), ids_of(5)));
  CHECK(read_h5(s.write("block.h5", s.reader->meta().grid.box(1), all, 1), "/", "dx_dy_dz").values == std::vector<double>(3, 0.001));
}

TEST_CASE("The profile openems is CSXCAD's DiscMaterial", "[export]") {
  const H5Cells s(5, 2, true);
  Options options = kAllMedia;
  options["--profile"] = "openems";
  const fs::path path = s.write("disc.h5", s.all(), options);
  const Read data = read_h5(path, "DiscData");
  CHECK(data.size == size_zyx(s.all()));
  CHECK(data.bytes == 1);
  CHECK(same_numbers(data.values, s.materials(s.all(), true), ids_of(5)));
  CHECK(read_h5(path, "/", "Version").values == std::vector<double>{2});
  CHECK(read_h5(path, "DiscData", "DB_Size").values == std::vector<double>{5});
  CHECK(read_h5(path, "DiscData", "epsR").values == std::vector<double>{1, 2.25, 4, 9.5, 80});
  CHECK(read_h5(path, "DiscData", "kappa").values == std::vector<double>{0, 0, double{0.01F}, 0, 0});
  CHECK(read_h5(path, "DiscData", "mueR").values == std::vector<double>{1, 1, 1, 2, 1});
  CHECK(read_h5(path, "mesh/y").values == s.meta().grid.axis[1].planes());
  CHECK(read_h5(path, "mesh/x").values.size() == 71);
  CHECK_THROWS_AS(H5Cells(2).write("disc.h5", {{0, 0, 0}, {1, 1, 1}}, {{"--profile", "openems"}, {"--epsilon", "m1=1"}, {"--sigma", "m1=inf"}}),
                  UsageError);
}

TEST_CASE("The same cells give the same HDF5 file, whenever it is written", "[export]") {
  const H5Cells s(3, 0, false);
  const std::string before = bytes_of(s.write("first.h5", s.all()));
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 counts seconds
  CHECK(bytes_of(s.write("second.h5", s.all())) == before);
}

TEST_CASE("XDMF names the arrays of an HDF5 file beside it", "[export]") {
  const H5Cells s(257, 2, true);
  const Box box{{3, 70, 1}, {69, 149, 2}};
  const std::string xml = bytes_of(s.write_as("xdmf", "x.xdmf", box));
  const std::string h5 = fs::absolute(s.folder / "x.h5").string();
  CHECK(xml.find("Dimensions=\"2 80 67\"") != std::string::npos);
  CHECK(xml.find("Dimensions=\"1 79 66\" NumberType=\"UShort\" Precision=\"2\" Format=\"HDF\">" + h5 + ":/material<") != std::string::npos);
  CHECK(xml.find("Dimensions=\"80\" NumberType=\"Float\" Precision=\"8\" Format=\"HDF\">" + h5 + ":/planes_y<") != std::string::npos);
  CHECK(same_numbers(read_h5(s.folder / "x.h5", "material").values, s.materials(box, true), ids_of(257)));
  CHECK_THROWS_AS(s.write_as("xdmf", "x.h5", box), UsageError);
  fs::copy_file(s.folder / "g.tcell", s.folder / "grid.h5");
  const GridReader other(s.folder / "grid.h5");
  CHECK_THROWS_AS(export_format_named("xdmf")->write({other, 0, box, s.folder / "grid.xdmf", [](double) {}}), UsageError);
  CHECK(file_bytes(s.folder / "grid.h5") == file_bytes(s.folder / "g.tcell"));
}

TEST_CASE("What a profile can't hold is refused, and leaves nothing", "[export]") {
  const H5Cells s(5, 2, true);
  const size_t files = files_in(s.folder);
  const std::string all = kAllMedia.at("--epsilon");
  const auto refused = [&](const Options& options, const std::string& word, std::vector<uint32_t> map = {}) {
    INFO(word);
    CHECK_THROWS_WITH(s.write("no.h5", s.all(), options, 0, std::move(map)), Catch::Contains(word));
    CHECK_THROWS_AS(s.write("no.h5", s.all(), options), UsageError);
  };
  refused({{"--profile", "matlab"}}, "gprmax");
  refused({{"--profile", "meep"}, {"--epsilon", all}}, "graded axis y");
  refused({{"--profile", "gprmax"}, {"--epsilon", all}}, "graded axis y");
  refused({{"--epsilon", all}}, "plain has no such option");
  refused({{"--profile", "openems"}, {"--epsilon", "m1=2,m2=2,m4=2"}}, "'m3'");
  refused({{"--profile", "openems"}, {"--epsilon", all + ",m5=1"}}, "'m5'");
  refused({{"--profile", "openems"}, {"--epsilon", "m1=-2"}}, "above 0");
  refused({{"--profile", "openems"}, {"--epsilon", all}, {"--sigma", "m1=-1"}}, "--sigma");
  refused({{"--profile", "openems"}, {"--epsilon", "m1=2,m2=2,m3=2,m4=2"}, {"--mu", "m0=1"}}, "'m0'");
  const H5Cells uniform(5);
  for (const Options& options : {Options{{"--profile", "meep"}, {"--epsilon", "m1=2,m2=2,m3=2,m4=2"}},  // not the background
                                 Options{{"--profile", "meep"}, {"--epsilon", all}, {"--sigma", "m1=1"}},
                                 Options{{"--profile", "gprmax"}, {"--epsilon", "m1=0.5,m2=2,m3=2,m4=2"}}})
    CHECK_THROWS_AS(uniform.write("no.h5", uniform.all(), options), UsageError);
  CHECK_THROWS_WITH(uniform.write("no.h5", uniform.all(), {{"--profile", "meep"}, {"--epsilon", all}}, 0, {0, 1, 2, 3, 4}), Catch::Contains("--map"));
  CHECK(files_in(s.folder) == files);
  CHECK(files_in(uniform.folder) == files);
}

TEST_CASE("A full disk ends an export with the path and the reason, and leaves nothing", "[export]") {
  const H5Cells s(257);
  const size_t files = files_in(s.folder);
  Options media = {{"--epsilon", "m0=1,m64=2.25,m128=4,m192=9.5,m256=80"}};
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_IGN);
  for (const rlim_t most : {0, 100, 3000, 100'000}) {  // the header; metadata; chunks
    const rlimit now = {most, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &now);
    std::string said;
    const auto fails = [&](const char* format, const Options& options) {
      try {
        s.write_as(format, "full.out", s.all(), options);
      } catch (const IoError& error) {
        said = error.what();
      }
    };
    for (const auto& [format, profile] : {std::pair("hdf5", "plain"), {"hdf5", "meep"}, {"hdf5", "gprmax"}, {"xdmf", ""}}) {
      Options options = profile == std::string("meep") || profile == std::string("gprmax") ? media : Options();
      if (*profile != 0) options["--profile"] = profile;
      said.clear();
      fails(format, options);
      INFO(format << " " << profile << " " << most);
      CHECK_THAT(said, Catch::Contains(".partial: byte ") && Catch::Contains(std::strerror(EFBIG)));
      CHECK(files_in(s.folder) == files);
    }
    setrlimit(RLIMIT_FSIZE, &before);
  }
  std::signal(SIGXFSZ, SIG_DFL);
  CHECK_THROWS_WITH(s.write("no/such.h5", s.all()), Catch::Contains("no folder"));
  CHECK(fs::exists(s.write("fits.h5", s.all())));
}

TEST_CASE("An export to HDF5 or XDMF that is stopped leaves no file", "[export]") {
  const H5Cells s(5);
  const size_t files = files_in(s.folder);
  Options gprmax = kAllMedia;
  gprmax["--profile"] = "gprmax";
  for (const double last : {0.0, 1.0})
    for (const auto& [format, options] : {std::pair<const char*, Options>("hdf5", {}), {"hdf5", gprmax}, {"xdmf", {}}, {"openems", kAllMedia}}) {
      const auto stop = [&, last = last](double share) {
        if (share == last) throw Interrupted("stopped");
      };
      CHECK_THROWS_AS(export_format_named(format)->write({*s.reader, 0, s.all(), s.folder / "x.out", stop, {}, options}), Interrupted);
      CHECK(files_in(s.folder) == files);
    }
}

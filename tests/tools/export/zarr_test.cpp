// Zarr on disk: a reader that knows only the documents and the specifications reads every cell of every level.
#include "tools/export/zarr/zarr.hpp"

#include <zlib.h>
#include <zstd.h>

#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"
#include "tools/export/formats.hpp"
#include "tools/export/zarr/layout.hpp"
#include "tools/export/zarr/shard.hpp"

namespace fs = std::filesystem;
using namespace teracell;
using namespace teracell::exports;
using namespace teracell::testing;
using nlohmann::ordered_json;

namespace {

// Chunks of at most 60 cells, 6 chunks in a shard, columns of at most 3 chunks: small grids have many of all.
constexpr zarr::Pieces kTinyPieces{60, 6, 180};

// A grid of random cells on disk, with a side of background.
struct ZarrGrid {
  ZarrGrid(const Index3& n, uint32_t materials, int ray_axis = 1) {
    constexpr uint32_t kLabels = 5;
    Grid grid;
    for (int d = 0; d < 3; ++d) grid.axis[d] = Axis::uniform(d - 1, 0.25, 2, n[d], 0.5);
    std::mt19937_64 random(11);
    std::vector<Label> cells = random_cells(random, n, kLabels);
    for (size_t i = cells.size() / 2; i < cells.size(); ++i) cells[i] = 0;
    Metadata meta = with_tiny_chunks(metadata_of(grid, ray_axis, materials));
    meta.units = "mm";
    meta.labels.resize(kLabels);
    for (uint32_t i = 0; i < kLabels; ++i) meta.labels[i].material = i * (materials - 1) / (kLabels - 1);
    store_cells(folder / "g.tcell", meta, cells);
    reader.emplace(folder / "g.tcell");
  }
  Box all(int level = 0) const { return reader->meta().grid.box(level); }
  Export to(const std::string& name, int level, const Box& box) const {
    return {*reader, level, box, folder / name, [](double) {}};
  }
  void write(const std::string& name, int version = 3, int threads = 1) const { zarr::write_zarr(to(name, 0, all()), version, kTinyPieces, threads); }

  TempFolder folder;
  std::optional<GridReader> reader;
};

using FileSet = std::map<std::string, Bytes>;

FileSet files_in(const fs::path& folder) {
  FileSet out;
  for (const auto& at : fs::recursive_directory_iterator(folder))
    if (at.is_regular_file()) out[at.path().lexically_relative(folder).string()] = file_bytes(at.path());
  return out;
}

struct Unzipped {
  FileSet files;
  std::vector<std::string> order;  // of the directory, which must be that of the files
  std::string comment;
};

// Reads a zip with 64-bit sizes from its end, and holds each file's header against the directory.
Unzipped unzipped(const Bytes& zip) {
  const auto at = [&](uint64_t offset, uint64_t bytes) {
    REQUIRE(offset + bytes <= zip.size());
    return ByteReader({zip.data() + offset, bytes}, "zip");
  };
  size_t end = zip.size() - 22;
  while (at(end, 4).fixed<uint32_t>() != 0x06054b50) --end;
  Unzipped out;
  out.comment = {zip.begin() + static_cast<int64_t>(end) + 22, zip.end()};
  CHECK(at(end + 20, 2).fixed<uint16_t>() == out.comment.size());
  CHECK(at(end + 4, 16).take(16)[4] == 0xff);  // the counts are in the 64-bit record
  REQUIRE(at(end - 20, 4).fixed<uint32_t>() == 0x07064b50);
  const auto record = at(end - 12, 8).fixed<uint64_t>();
  REQUIRE(record + 56 == end - 20);
  REQUIRE(at(record, 4).fixed<uint32_t>() == 0x06064b50);
  const auto count = at(record + 32, 8).fixed<uint64_t>(), size = at(record + 40, 8).fixed<uint64_t>(), start = at(record + 48, 8).fixed<uint64_t>();
  REQUIRE(start + size == record);
  ByteReader directory = at(start, size);
  uint64_t expected = 0;  // place of the next file
  for (uint64_t i = 0; i < count; ++i) {
    REQUIRE(directory.fixed<uint32_t>() == 0x02014b50);
    directory.take(6);
    CHECK(directory.fixed<uint16_t>() == 0);  // stored
    directory.take(4);
    const auto crc = directory.fixed<uint32_t>();
    CHECK(directory.fixed<uint64_t>() == ~uint64_t{0});
    const auto name_size = directory.fixed<uint16_t>();
    CHECK(directory.fixed<uint16_t>() == 28);
    directory.take(10);
    CHECK(directory.fixed<uint32_t>() == 0xffffffff);
    const auto name = directory.take(name_size);
    CHECK(directory.fixed<uint32_t>() == (24u << 16 | 1));
    const auto bytes = directory.fixed<uint64_t>(), stored = directory.fixed<uint64_t>(), offset = directory.fixed<uint64_t>();
    CHECK(bytes == stored);
    CHECK(offset == expected);
    ByteReader header = at(offset, 30 + name_size + 20 + bytes);
    CHECK(header.fixed<uint32_t>() == 0x04034b50);
    header.take(4);
    CHECK(header.fixed<uint16_t>() == 0);
    header.take(4);
    CHECK(header.fixed<uint32_t>() == crc);
    header.take(8);
    CHECK(header.fixed<uint16_t>() == name_size);
    CHECK(header.fixed<uint16_t>() == 20);
    CHECK(std::ranges::equal(header.take(name_size), name));
    header.take(4);
    CHECK(header.fixed<uint64_t>() == bytes);
    CHECK(header.fixed<uint64_t>() == bytes);
    const auto body = header.take(bytes);
    CHECK(::crc32_z(0, body.data(), body.size()) == crc);
    out.order.emplace_back(name.begin(), name.end());
    CHECK(out.files.emplace(out.order.back(), Bytes(body.begin(), body.end())).second);
    expected = offset + 30 + name_size + 20 + bytes;
  }
  CHECK(expected == start);
  directory.expect_end();
  return out;
}

ordered_json document(const FileSet& files, const std::string& name) {
  REQUIRE(files.contains(name));
  const Bytes& text = files.at(name);
  return ordered_json::parse(text.begin(), text.end());
}

// Bit by bit, with the polynomial as RFC 3720 has it.
uint32_t crc32c_by_bits(std::span<const uint8_t> bytes) {
  uint32_t crc = 0xffffffff;
  for (const uint8_t byte : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const bool one = (crc ^ static_cast<uint32_t>(byte >> bit)) & 1;
      crc >>= 1;
      if (one) crc ^= 0x82f63b78;
    }
  return ~crc;
}

Bytes unpacked(std::span<const uint8_t> frame) {
  Bytes out(ZSTD_getFrameContentSize(frame.data(), frame.size()));
  REQUIRE(ZSTD_decompress(out.data(), out.size(), frame.data(), frame.size()) == out.size());
  return out;
}

// The bytes of chunk (z, y, x), if there is such a chunk. What is missing is not even a file.
using ChunkBytes = std::function<std::optional<Bytes>(const std::vector<int64_t>&)>;

ChunkBytes chunks_of_shards(const FileSet& files, const std::string& array, const std::vector<int64_t>& shard, const std::vector<int64_t>& chunk) {
  return [&files, array, shard, chunk](const std::vector<int64_t>& at) -> std::optional<Bytes> {
    std::vector<int64_t> of(3), in(3), per(3);
    for (size_t d = 0; d < 3; ++d) per[d] = shard[d] / chunk[d], of[d] = at[d] / per[d], in[d] = at[d] % per[d];
    const auto it = files.find(fmt::format("{}/c/{}/{}/{}", array, of[0], of[1], of[2]));
    if (it == files.end()) return std::nullopt;
    const auto count = static_cast<size_t>(per[0] * per[1] * per[2]);
    REQUIRE(it->second.size() > 16 * count + 4);
    const std::span<const uint8_t> index = std::span(it->second).last(16 * count + 4);
    REQUIRE(ByteReader(index.last(4), "checksum").fixed<uint32_t>() == crc32c_by_bits(index.first(16 * count)));
    ByteReader entry(index.subspan(static_cast<size_t>((in[0] * per[1] + in[1]) * per[2] + in[2]) * 16, 16), "index");
    const auto offset = entry.fixed<uint64_t>(), bytes = entry.fixed<uint64_t>();
    if (offset == ~uint64_t{0} && bytes == ~uint64_t{0}) return std::nullopt;
    REQUIRE(offset + bytes <= it->second.size() - index.size());
    return unpacked(std::span(it->second).subspan(offset, bytes));
  };
}

ChunkBytes chunks_of_files(const FileSet& files, const std::string& array) {
  return [&files, array](const std::vector<int64_t>& at) -> std::optional<Bytes> {
    const auto it = files.find(fmt::format("{}/{}/{}/{}", array, at[0], at[1], at[2]));
    return it == files.end() ? std::nullopt : std::optional(unpacked(it->second));
  };
}

struct Decoded {
  Index3 n;  // x, y, z
  std::vector<uint32_t> cells;
  int present = 0, absent = 0;  // chunks
};

Decoded decoded(const std::vector<int64_t>& n, const std::vector<int64_t>& chunk, size_t width, uint32_t fill, const ChunkBytes& chunk_bytes) {
  Decoded out{{n[2], n[1], n[0]}, std::vector<uint32_t>(static_cast<size_t>(n[0] * n[1] * n[2]), 0xdead), 0, 0};
  for (int64_t kz = 0; kz * chunk[0] < n[0]; ++kz)
    for (int64_t ky = 0; ky * chunk[1] < n[1]; ++ky)
      for (int64_t kx = 0; kx * chunk[2] < n[2]; ++kx) {
        const std::optional<Bytes> bytes = chunk_bytes({kz, ky, kx});
        ++(bytes ? out.present : out.absent);
        if (bytes) REQUIRE(bytes->size() == static_cast<size_t>(chunk[0] * chunk[1] * chunk[2]) * width);
        bool all_fill = true;
        for (size_t i = 0; i < static_cast<size_t>(chunk[0] * chunk[1] * chunk[2]); ++i) {
          uint32_t value = fill;
          if (bytes) {
            value = 0;
            for (size_t b = 0; b < width; ++b) value |= uint32_t{(*bytes)[i * width + b]} << (8 * b);
          }
          all_fill = all_fill && value == fill;
          const auto k = static_cast<int64_t>(i);
          const int64_t z = kz * chunk[0] + k / chunk[2] / chunk[1], y = ky * chunk[1] + k / chunk[2] % chunk[1], x = kx * chunk[2] + k % chunk[2];
          if (z < n[0] && y < n[1] && x < n[2]) out.cells[static_cast<size_t>((z * n[1] + y) * n[2] + x)] = value;
          else if (value != fill) FAIL("the padding is not the fill value");
        }
        if (bytes && all_fill) FAIL("a chunk of the fill value alone is there");
      }
  return out;
}

Decoded read3(const FileSet& files, const std::string& array) {
  const ordered_json j = document(files, array + "/zarr.json"), sharding = j["codecs"][0]["configuration"];
  REQUIRE(j["zarr_format"] == 3);
  REQUIRE(j["codecs"].size() == 1);
  REQUIRE(j["codecs"][0]["name"] == "sharding_indexed");
  REQUIRE(sharding["codecs"][0]["name"] == "bytes");
  REQUIRE(sharding["codecs"][1]["name"] == "zstd");
  REQUIRE(sharding["index_codecs"][1]["name"] == "crc32c");
  REQUIRE(sharding["index_location"] == "end");
  REQUIRE(j["dimension_names"] == ordered_json::array({"z", "y", "x"}));
  const size_t width = std::map<std::string, size_t>{{"uint8", 1}, {"uint16", 2}, {"uint32", 4}}.at(j["data_type"]);
  if (width > 1) REQUIRE(sharding["codecs"][0]["configuration"]["endian"] == "little");
  const std::vector<int64_t> n = j["shape"], shard = j["chunk_grid"]["configuration"]["chunk_shape"], chunk = sharding["chunk_shape"];
  for (size_t d = 0; d < 3; ++d) REQUIRE(shard[d] % chunk[d] == 0);
  return decoded(n, chunk, width, j["fill_value"], chunks_of_shards(files, array, shard, chunk));
}

Decoded read2(const FileSet& files, const std::string& array) {
  const ordered_json j = document(files, array + "/.zarray");
  REQUIRE(j["zarr_format"] == 2);
  REQUIRE(j["compressor"]["id"] == "zstd");
  REQUIRE(j["order"] == "C");
  REQUIRE(j["dimension_separator"] == "/");
  const size_t width = std::map<std::string, size_t>{{"|u1", 1}, {"<u2", 2}, {"<u4", 4}}.at(j["dtype"]);
  return decoded(j["shape"], j["chunks"], width, j["fill_value"], chunks_of_files(files, array));
}

// The cells of a level that cover a box of `from`, as the reader gives them.
std::vector<uint32_t> expected_cells(const Export& e, int level, Index3& n) {
  Box box;
  for (int d = 0; d < 3; ++d) {
    box.lo[d] = e.box.lo[d] >> (level - e.level), box.hi[d] = ceil_shift(e.box.hi[d], level - e.level);
    n[d] = box.hi[d] - box.lo[d];
  }
  std::vector<uint32_t> out(static_cast<size_t>(n[0] * n[1] * n[2]));
  read_box<uint32_t>(e.reader, level, box, e.number(), 7, out.data(), {1, n[0], n[0] * n[1]});
  return out;
}

// Every level of the export. Returns how many chunks are there, and how many are not.
std::pair<int, int> check_levels(const Export& e, const FileSet& files, int version) {
  int present = 0, absent = 0;
  for (int level = 0; level < e.reader.levels(); ++level) {
    const std::string array = std::to_string(level);
    CHECK(files.contains(array + (version == 3 ? "/zarr.json" : "/.zarray")) == (level >= e.level));
    if (level < e.level) continue;
    const Decoded found = version == 3 ? read3(files, array) : read2(files, array);
    Index3 n;
    CHECK((found.cells == expected_cells(e, level, n)));
    CHECK(found.n == n);
    present += found.present, absent += found.absent;
  }
  return {present, absent};
}

}  // namespace

TEST_CASE("Every level in Zarr 3 is as the reader gives it: boxes, levels, 8 and 16 bits, any ray axis", "[export][zarr]") {
  for (const uint32_t materials : {5u, 256u, 257u})
    for (const int ray_axis : {0, 1, 2}) {
      const ZarrGrid g({29, 18, 23}, materials, ray_axis);
      for (const auto& [level, box] :
           std::vector<std::pair<int, Box>>{{0, g.all()}, {0, {{5, 3, 1}, {28, 17, 22}}}, {1, {{1, 2, 0}, {13, 8, 11}}}, {3, g.all(3)}}) {
        const Export e = g.to(fmt::format("{}-{}.zarr", level, box.lo[0]), level, box);
        zarr::write_zarr(e, 3, kTinyPieces, 1);
        const FileSet files = files_in(e.output);
        const auto [present, absent] = check_levels(e, files, 3);
        CHECK(present > 0);
        if (level == 0) CHECK(absent > present / 2);
        CHECK(document(files, fmt::format("{}/zarr.json", level))["data_type"] == (materials > 256 ? "uint16" : "uint8"));
      }
    }
}

TEST_CASE("Every level in Zarr 2 is as the reader gives it, a file per chunk", "[export][zarr]") {
  for (const uint32_t materials : {5u, 257u}) {
    const ZarrGrid g({29, 18, 23}, materials);
    const Export e = g.to("g.zarr", 0, {{5, 3, 1}, {28, 17, 22}});
    zarr::write_zarr(e, 2, kTinyPieces, 1);
    const FileSet files = files_in(e.output);
    const auto [present, absent] = check_levels(e, files, 2);
    CHECK(absent > present / 2);
    CHECK(files.size() == static_cast<size_t>(3 + 2 * g.reader->levels() + present));
    const ordered_json all = document(files, ".zmetadata")["metadata"];
    for (const auto& [name, node] : all.items()) CHECK(node == document(files, name));
    CHECK(all.size() == static_cast<size_t>(2 + 2 * g.reader->levels()));
  }
}

TEST_CASE("Numbers of a map are written to Zarr, and the fill value is that of the background", "[export][zarr]") {
  const ZarrGrid g({29, 18, 23}, 5);
  for (const int version : {2, 3}) {
    Export e = g.to(fmt::format("v{}.zarr", version), 0, g.all());
    e.map = {70000, 2, 70000, 0, 4294967295};
    zarr::write_zarr(e, version, kTinyPieces, 1);
    const FileSet files = files_in(e.output);
    CHECK(check_levels(e, files, version).second > 0);
    CHECK(document(files, version == 3 ? "0/zarr.json" : "0/.zarray")["fill_value"] == 70000);
    const ordered_json attributes = version == 3 ? document(files, "zarr.json")["attributes"]["ome"] : document(files, ".zattrs");
    CHECK_FALSE(attributes["image-label"].contains("properties"));  // names belong to ids
  }
}

TEST_CASE("A zip has the files of the folder, the documents first", "[export][zarr]") {
  const ZarrGrid g({29, 18, 23}, 5);
  for (const int version : {2, 3}) {
    const std::string name = fmt::format("v{}", version);
    g.write(name + ".zarr", version);
    g.write(name + ".zip", version);
    g.write(name + ".ozx", version);
    const Unzipped zip = unzipped(file_bytes(g.folder / (name + ".zip")));
    CHECK((file_bytes(g.folder / (name + ".ozx")) == file_bytes(g.folder / (name + ".zip"))));
    CHECK((zip.files == files_in(g.folder / (name + ".zarr"))));
    const auto is_document = [](const std::string& file) { return file.ends_with("zarr.json") || file.find(".z") != std::string::npos; };
    CHECK(std::ranges::is_partitioned(zip.order, is_document));
    CHECK(zip.order.front() == (version == 3 ? "zarr.json" : ".zgroup"));
    if (version == 2) CHECK(zip.comment.empty());
    else CHECK(ordered_json::parse(zip.comment)["ome"]["version"] == "0.5");
  }
}

TEST_CASE("A grid of background alone is exported as documents alone", "[export][zarr]") {
  TempFolder folder;
  const Grid grid = cube_grid_of(0, 1, 20);
  store_cells(folder / "g.tcell", metadata_of(grid, 2, 3), std::vector<Label>(8000, 0));
  const GridReader reader(folder / "g.tcell");
  const Export e{reader, 0, grid.box(0), folder / "g.zarr", [](double) {}};
  zarr::write_zarr(e, 3, kTinyPieces, 2);
  CHECK(files_in(e.output).size() == static_cast<size_t>(1 + reader.levels()));
  check_levels(e, files_in(e.output), 3);
}

TEST_CASE("The bytes in Zarr do not depend on the number of threads", "[export][zarr][threads]") {
  const ZarrGrid g({29, 18, 23}, 257);
  for (const int version : {2, 3}) {
    TempFolder folders;
    std::vector<FileSet> found;
    for (const int threads : {1, 2, 5}) {
      const fs::path path = folders / std::to_string(threads);
      fs::create_directory(path);
      Export e = g.to("", 0, g.all());
      e.output = path / "g.zarr";
      zarr::write_zarr(e, version, kTinyPieces, threads);
      e.output = path / "g.ozx";
      zarr::write_zarr(e, version, kTinyPieces, threads);
      found.push_back(files_in(path));
    }
    CHECK((found[1] == found[0]));
    CHECK((found[2] == found[0]));
  }
}

TEST_CASE("A Zarr export that is stopped leaves nothing, and what was there stays", "[export][zarr]") {
  const ZarrGrid g({29, 18, 23}, 5);
  g.write("old.ozx");
  const Bytes old = file_bytes(g.folder / "old.ozx");
  const size_t before = files_in(g.folder.path()).size();
  for (const std::string name : {"new.zarr", "new.ozx", "old.ozx"})
    for (const int version : {2, 3})
      for (const double last : {0.0, 0.3, 0.99, 1.0}) {
        Export e = g.to(name, 0, g.all());
        e.progress = [last](double share) {
          if (share >= last) throw Interrupted("stopped");
        };
        CHECK_THROWS_AS(zarr::write_zarr(e, version, kTinyPieces, 2), Interrupted);
        CHECK(files_in(g.folder.path()).size() == before);
        CHECK_FALSE(fs::exists(g.folder / "new.zarr"));
        CHECK_FALSE(fs::exists(g.folder / "new.zarr.partial"));
      }
  CHECK((file_bytes(g.folder / "old.ozx") == old));
}

TEST_CASE("A folder that holds something is not replaced by Zarr", "[export][zarr]") {
  const ZarrGrid g({5, 6, 7}, 5);
  g.write("g.zarr");
  const FileSet before = files_in(g.folder / "g.zarr");
  CHECK_THROWS_AS(g.write("g.zarr"), UsageError);
  CHECK((files_in(g.folder / "g.zarr") == before));
  fs::create_directories(g.folder / "empty.zarr.partial/0/c");  // what a killed run has left
  fs::create_directory(g.folder / "empty.zarr");
  g.write("empty.zarr");
  CHECK(files_in(g.folder / "empty.zarr").size() == before.size());
}

TEST_CASE("OME-Zarr says where the cells of a region lie, what they are called, and which levels there are", "[export][zarr]") {
  const ZarrGrid g({290, 18, 23}, 5);
  const Box box{{100, 3, 1}, {290, 17, 22}};
  const Export e = g.to("part.zarr", 0, box);
  zarr::write_zarr(e, 3, kTinyPieces, 1);
  const FileSet files = files_in(e.output);
  const ordered_json root = document(files, "zarr.json"), ome = root["attributes"]["ome"], scales = ome["multiscales"][0];
  CHECK(root["node_type"] == "group");
  CHECK(ome["version"] == "0.5");
  CHECK(scales["name"] == "part");
  CHECK(scales["axes"][2] == ordered_json{{"name", "x"}, {"type", "space"}, {"unit", "millimeter"}});
  CHECK(scales["datasets"].size() == 3);  // 190, 95 and 48 cells along x
  CHECK(root["attributes"]["teracell"]["region"] == ordered_json::array({100, 3, 1, 290, 17, 22}));
  for (int level = 0; level < 3; ++level) {
    const ordered_json dataset = scales["datasets"][static_cast<size_t>(level)];
    CHECK(dataset["path"] == std::to_string(level));
    const std::vector<double> scale = dataset["coordinateTransformations"][0]["scale"], to = dataset["coordinateTransformations"][1]["translation"];
    for (int d = 0; d < 3; ++d) {
      const double step = 0.25 * (1 << level), plane = d - 1 + 2 * 0.25 + static_cast<double>(box.lo[d] >> level) * step;
      CHECK(scale[static_cast<size_t>(2 - d)] == step);
      CHECK(to[static_cast<size_t>(2 - d)] == Approx(plane + step / 2).epsilon(1e-14));
    }
  }
  CHECK(ome["image-label"]["properties"][3] == ordered_json{{"label-value", 3}, {"name", "m3"}});
  CHECK(ome["image-label"]["colors"][3] == ordered_json{{"label-value", 3}, {"rgba", {128, 128, 128, 255}}});
  const ordered_json nodes = root["consolidated_metadata"]["metadata"];
  CHECK(nodes.size() == static_cast<size_t>(g.reader->levels()));
  for (const auto& [path, node] : nodes.items()) CHECK(node == document(files, path + "/zarr.json"));
}

TEST_CASE("Blocks are as near to cubes as their size and their volume allow", "[export][zarr]") {
  CHECK(zarr::block_within({1000, 1000, 1000}, 1 << 18) == Index3{64, 64, 64});
  CHECK(zarr::block_within({3, 3, 3}, 27) == Index3{3, 3, 3});
  CHECK(zarr::block_within({16, 16, 16}, 1 << 12) == Index3{16, 16, 16});
  CHECK(zarr::block_within({100, 3, 1}, 1 << 18) == Index3{100, 3, 1});
  CHECK(zarr::block_within({1, 1, 1'000'000'000}, 1 << 18) == Index3{1, 1, 1 << 18});
  CHECK(zarr::block_within({1000, 1, 1000}, 1 << 18) == Index3{512, 1, 512});
  CHECK(zarr::volume(zarr::block_within({17, 500, 70}, 1 << 18)) > 1 << 16);
}

TEST_CASE("The checksum of shards is CRC-32C", "[export][zarr]") {
  const std::string digits = "123456789";
  CHECK(zarr::crc32c({reinterpret_cast<const uint8_t*>(digits.data()), digits.size()}) == 0xe3069283);
  CHECK(zarr::crc32c(Bytes(32, 0)) == 0x8a9136aa);  // RFC 3720, B.4
}

TEST_CASE("Options of Zarr are held against their ranges", "[export][zarr]") {
  const ZarrGrid g({5, 6, 7}, 5);
  for (const auto& [option, value] : std::vector<std::pair<std::string, std::string>>{
           {"--zarr-version", "4"}, {"--zarr-version", "3.0"}, {"--threads", "0"}, {"--threads", "1025"}, {"--threads", ""}}) {
    Export e = g.to("g.zarr", 0, g.all());
    e.options = {{option, value}};
    CHECK_THROWS_WITH(export_format_named("zarr")->write(e), Catch::StartsWith(option));
    CHECK_FALSE(fs::exists(e.output));
  }
  Export ozx = g.to("g.ozx", 0, g.all());
  ozx.options = {{"--zarr-version", "2"}};
  CHECK_THROWS_WITH(export_format_named("zarr")->write(ozx), Catch::StartsWith("--zarr-version"));
  for (const std::string version : {"2", "3"}) {
    Export e = g.to("v" + version + ".zarr", 0, g.all());
    e.options = {{"--zarr-version", version}, {"--threads", "2"}};
    export_format_named("zarr")->write(e);
    CHECK(check_levels(e, files_in(e.output), std::stoi(version)).first > 0);
  }
}

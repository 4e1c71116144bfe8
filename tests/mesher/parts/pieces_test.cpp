// A grid in pieces that several processes make, and its assembly: the bytes of one run.
#include "mesher/parts/pieces.hpp"
#include "mesher/bodies/assembly.hpp"
#include "mesher/run/part_found.hpp"
#include "store/base/error.hpp"
#include "tests/support/parts.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

using Processes = std::vector<std::unique_ptr<Pieces>>;

Processes prepare(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, uint32_t processes) {
  Processes out;
  for (uint32_t i = 0; i < processes; ++i) {
    MeshOptions own = options;
    own.threads = 1 + static_cast<int>(i % 3);
    out.push_back(std::make_unique<Pieces>(scene, output, own, i == 0, kSilent, kGoOn));
  }
  return out;
}

// The last process is much slower than the others. Stops after `most` pieces.
void make_pieces(Processes& processes, std::vector<uint32_t> pieces, size_t most = ~size_t{0}, bool share_home = false) {
  const auto number = static_cast<uint32_t>(processes.size());
  if (share_home) last_by_cost(pieces, 2 * number, [&](uint32_t piece) { return processes[0]->cost(piece); });
  PieceQueue queue(std::move(pieces), share_home ? 1 : number);
  size_t made = 0;
  for (size_t turn = 0, idle = 0; idle < number && made < most; ++turn) {
    const auto process = static_cast<uint32_t>(turn % number);
    if (process + 1 == number && number > 1 && turn % (7 * number) != number - 1 && idle == 0) continue;
    const auto order = queue.next(share_home ? 0 : process);
    idle = order ? 0 : idle + 1;
    if (order) processes[process]->make(*order), ++made;
  }
}

std::vector<uint32_t> missing_pieces(const Pieces& pieces) {
  std::vector<uint32_t> out;
  for (uint32_t piece = 0; piece < pieces.size(); ++piece)
    if (!pieces.is_made(piece)) out.push_back(piece);
  return out;
}

void assemble(Processes& processes, const std::filesystem::path& output) {
  Pieces& first = *processes[0];
  first.finish_counting();
  Assembly assembly(output, first.meta());
  CastTotals totals;
  std::vector<std::pair<uint32_t, std::vector<Placed>>> all;
  for (uint32_t piece = 0; piece < first.size(); ++piece) {
    const auto part = first.open(piece);
    all.push_back({piece, assembly.add(*part)});
    const CastTotals found = decode_found(part->found(), part->name()).totals;
    if (piece == 0) totals = found;
    else totals.add(found);
  }
  for (size_t i = all.size(); i-- > 0;) copy_placed(*first.open(all[i].first), all[i].second, FileRoom(output), [] {});
  assembly.finish(first.report(totals).json, totals.crossings, totals.sums);
  first.remove_files([](uint32_t) { return false; });
}

size_t files_in(const TempFolder& folder) {
  return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()));
}

}  // namespace

TEST_CASE("Any number of processes, with any memory and threads, make the bytes of one run", "[parts][long]") {
  const TempFolder folder;
  const Scene scene = scene_in_parts(folder, 150);
  for (int axis = 0; axis < 3; ++axis) {
    MeshOptions options = options_of_parts(axis);
    mesh_quietly(scene, folder / "whole.tcell", options);
    const std::string expected = bytes_of(folder / "whole.tcell");
    const size_t files = files_in(folder);
    for (const uint32_t processes : {1u, 2u, 3u, 5u, 40u})
      for (const uint64_t memory : {~uint64_t{0}, uint64_t{1}}) {
        if (kSanitized && processes != 3) continue;
        INFO(processes << " processes, memory " << memory << ", rays along " << axis_name(axis));
        options.memory = memory;
        Processes all = prepare(scene, folder / "g.tcell", options, processes);
        REQUIRE(all[0]->size() > 10);
        make_pieces(all, missing_pieces(*all[0]), ~size_t{0}, all[0]->in_memory());
        assemble(all, folder / "g.tcell");
        REQUIRE(bytes_of(folder / "g.tcell") == expected);
        std::filesystem::remove(folder / "g.tcell");
        CHECK(files_in(folder) == files);
      }
  }
}

TEST_CASE("Others go on with the pieces that are whole", "[parts]") {
  const TempFolder folder;
  const Scene scene = scene_in_parts(folder);
  const MeshOptions options = options_of_parts(2);
  mesh_quietly(scene, folder / "whole.tcell", options);
  for (const size_t made : {size_t{0}, size_t{1}, size_t{20}, ~size_t{0}}) {
    Processes before = prepare(scene, folder / "g.tcell", options, 3);
    make_pieces(before, missing_pieces(*before[0]), made);
    const auto missing = missing_pieces(*before[0]);
    REQUIRE(missing.size() == before[0]->size() - std::min<size_t>(made, before[0]->size()));
    before.clear();
    Processes now = prepare(scene, folder / "g.tcell", options, 2);
    CHECK(missing_pieces(*now[0]) == missing);
    make_pieces(now, missing);
    assemble(now, folder / "g.tcell");
    CHECK(bytes_of(folder / "g.tcell") == bytes_of(folder / "whole.tcell"));
  }
}

TEST_CASE("A piece with another byte, another length or of another run is not a piece of this run", "[parts]") {
  const TempFolder folder;
  const Scene scene = scene_in_parts(folder, 100);
  Processes all = prepare(scene, folder / "g.tcell", options_of_parts(2), 1);
  make_pieces(all, missing_pieces(*all[0]));
  const Pieces& pieces = *all[0];
  const uint32_t piece = pieces.size() / 2;
  const std::string good = bytes_of(pieces.path(piece));
  const auto put = [&](const std::string& bytes) { std::ofstream(pieces.path(piece), std::ios::binary) << bytes; };
  REQUIRE(pieces.is_made(piece));
  for (size_t at = 0; at < good.size(); at += std::max<size_t>(1, good.size() / 97)) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    put(bad);
    INFO("byte " << at);
    CHECK_FALSE(pieces.is_made(piece));
  }
  put(good.substr(0, good.size() - 1));
  CHECK_FALSE(pieces.is_made(piece));
  put(bytes_of(pieces.path(piece + 1)));
  CHECK_FALSE(pieces.is_made(piece));
  put(good);
  CHECK(pieces.is_made(piece));
  Scene other = scene;
  other.bodies[0].name = "another";
  Processes others = prepare(other, folder / "g.tcell", options_of_parts(2), 1);
  REQUIRE(others[0]->size() == pieces.size());
  CHECK(missing_pieces(*others[0]).size() == pieces.size());
}

TEST_CASE("A copy whose bytes changed on the way is refused, and files of others are left alone", "[parts]") {
  const TempFolder folder;
  const Scene scene = scene_in_parts(folder, 100);
  Processes all = prepare(scene, folder / "g.tcell", options_of_parts(2), 1);
  make_pieces(all, missing_pieces(*all[0]));
  Pieces& first = *all[0];
  {
    Assembly assembly(folder / "g.tcell", first.meta());
    const auto places = assembly.add(*first.open(0));
    REQUIRE(first.open(0)->bytes() > 100);
    std::string bytes = bytes_of(first.path(0));
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 64);
    std::ofstream(first.path(0), std::ios::binary) << bytes;
    const FileRoom room(folder / "g.tcell");
    CHECK_THROWS_WITH(copy_placed(*first.open(0), places, room, [] {}), Catch::Contains("damaged"));
  }
  CHECK_FALSE(std::filesystem::exists(folder / "g.tcell.partial"));
  for (const char* name :
       {"g.tcell.piece-1-of-7", "g.tcell.piece-0-of-9.partial", "g.tcell.piece-1-of-7.old", "h.tcell.piece-1-of-7", "g.tcell.pieces"})
    std::ofstream(folder / name) << "x";
  first.remove_files([](uint32_t piece) { return piece == 3; });
  for (const char* name : {"g.tcell.piece-1-of-7.old", "h.tcell.piece-1-of-7", "g.tcell.pieces"}) CHECK(std::filesystem::exists(folder / name));
  for (const char* name : {"g.tcell.piece-1-of-7", "g.tcell.piece-0-of-9.partial"}) CHECK_FALSE(std::filesystem::exists(folder / name));
  CHECK(std::filesystem::exists(first.path(3)));
  CHECK_FALSE(std::filesystem::exists(first.path(4)));
}

}  // namespace teracell::mesher

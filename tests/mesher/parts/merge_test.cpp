// A grid that is made in parts, and put together: the bytes of one run.
#include "mesher/parts/merge.hpp"
#include "mesher/run/checkpoint.hpp"
#include "store/base/error.hpp"
#include "store/whole/verify.hpp"
#include "tests/support/parts.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

TEST_CASE("Any number of parts, made with any memory and threads, merge to the bytes of one run", "[parts]") {
  const TempFolder folder;
  const Scene scene = scene_in_parts(folder, 150);
  for (int axis = 0; axis < 3; ++axis) {
    MeshOptions options = options_of_parts(axis);
    REQUIRE(mesh_quietly(scene, folder / "whole.tcell", options)["overlaps"]["pairs"] == 1);
    const std::string expected = bytes_of(folder / "whole.tcell");
    for (const uint32_t of : {1u, 2u, 5u, 16u, 300u}) {
      if ((kSanitized && of != 5) || (of == 300 && axis != 2)) continue;
      INFO(of << " parts, rays along " << axis_name(axis));
      std::vector<std::filesystem::path> parts;
      for (uint32_t i = of; i-- > 0;) {  // in another order than theirs
        options.threads = 1 + static_cast<int>(i % 3);
        options.memory = i % 2 == 0 ? 1 : ~uint64_t{0};  // spilled, or not
        parts.push_back(make_part(scene, folder / "g.tcell", options, {i, of}));
        CHECK_NOTHROW(verify(PartReader(parts.back())));
      }
      const MeshReport report = merge(parts, folder / "g.tcell", kSilent, kGoOn);
      REQUIRE(bytes_of(folder / "g.tcell") == expected);
      CHECK(report.json == GridReader(folder / "whole.tcell").report());
    }
  }
}

TEST_CASE("What a part holds depends on scene, options and count alone", "[parts]") {
  const TempFolder folder;
  const Scene scene = scene_in_parts(folder);
  MeshOptions options = options_of_parts(2);
  std::vector<std::string> before;
  for (const auto& part : make_parts(scene, folder / "a.tcell", options, 3)) before.push_back(bytes_of(part));
  options.threads = 3;
  options.memory = 1;
  options.checkpoint_seconds = 0;
  for (uint32_t i = 0; i < 3; ++i) CHECK(bytes_of(make_part(scene, folder / "b.tcell", options, {i, 3})) == before[i]);
}

TEST_CASE("A part that was killed goes on to the same bytes", "[parts]") {
  const TempFolder folder;
  const Scene scene = scene_in_parts(folder);
  MeshOptions options = options_of_parts(2);
  options.checkpoint_seconds = 0;
  const Shard shard{1, 3};
  const std::string expected = bytes_of(make_part(scene, folder / "whole.tcell", options, shard));
  const std::filesystem::path part = part_path(folder / "g.tcell", shard);
  for (const int call : {3, 5, 6, 8, 11, 15, 20, 25, 30}) {
    INFO("call " << call);
    options.shard = shard;
    options.resume = false;
    run_and_kill(scene, folder / "g.tcell", options, call);
    REQUIRE_FALSE(std::filesystem::exists(part));
    options.resume = true;
    make_part(scene, folder / "g.tcell", options, shard);
    REQUIRE(bytes_of(part) == expected);
    REQUIRE_FALSE(std::filesystem::exists(checkpoint_path(part)));
    std::filesystem::remove(part);
  }
}

TEST_CASE("Parts that are missing, double, of another run or damaged are named, and nothing is written", "[parts]") {
  const TempFolder folder;
  const Scene scene = scene_in_parts(folder, 100);
  const MeshOptions options = options_of_parts(2);
  const auto parts = make_parts(scene, folder / "g.tcell", options, 4);
  const auto refused = [&](const std::vector<std::filesystem::path>& some, const std::string& words) {
    CHECK_THROWS_WITH(merge(some, folder / "merged.tcell", kSilent, kGoOn), Catch::Contains(words));
    CHECK_FALSE(std::filesystem::exists(folder / "merged.tcell"));
    CHECK_FALSE(std::filesystem::exists(folder / "merged.tcell.partial"));
  };
  refused({parts[0], parts[2], parts[3]}, "expected 4 parts, found 3: 1 is missing");
  refused({parts[3]}, "expected 4 parts, found 1: 0, 1, 2 are missing");
  refused({parts[0], parts[1], parts[1], parts[2], parts[3]}, "are both part 1");
  refused({parts[0], parts[1], parts[2], make_part(scene, folder / "h.tcell", options, {3, 5})}, "is one of 5");
  MeshOptions other = options;
  other.thin = false;
  refused({parts[0], parts[1], parts[2], make_part(scene, folder / "h.tcell", other, {3, 4})}, "thin was true and is false");
  refused({parts[0], parts[1], parts[2], scene.bodies[0].mesh}, "expected a part of a grid");

  const std::string whole = bytes_of(parts[1]);
  const std::filesystem::path damaged = folder / "damaged";
  for (size_t size = 0; size < whole.size(); size += 1 + whole.size() / 300) {
    std::ofstream(damaged, std::ios::binary) << whole.substr(0, size);
    refused({parts[0], damaged, parts[2], parts[3]}, "damaged");
  }
  for (size_t at = 0; at < whole.size(); at += 1 + whole.size() / 300) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    std::ofstream(damaged, std::ios::binary) << bytes;
    INFO("byte " << at);
    CHECK_THROWS_AS(verify(PartReader(damaged)), FormatError);
    CHECK_THROWS_AS(merge({parts[0], damaged, parts[2], parts[3]}, folder / "merged.tcell", kSilent, kGoOn), Error);
    CHECK_FALSE(std::filesystem::exists(folder / "merged.tcell"));
  }
}

TEST_CASE("A merge that is stopped leaves nothing", "[parts]") {
  const TempFolder folder;
  const auto parts = make_parts(scene_in_parts(folder, 100), folder / "g.tcell", options_of_parts(2), 2);
  const std::atomic<bool> stop{true};
  CHECK_THROWS_AS(merge(parts, folder / "g.tcell", kSilent, stop), Interrupted);
  CHECK_FALSE(std::filesystem::exists(folder / "g.tcell"));
}

}  // namespace
}  // namespace teracell::mesher

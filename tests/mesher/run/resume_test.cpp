// Runs that are killed, and those that go on from there: the same file, byte for byte.
#include <fcntl.h>
#include <sys/syscall.h>

#include "mesher/run/checkpoint.hpp"
#include "store/base/error.hpp"
#include "tests/support/parts.hpp"

// In a child that is to die there, the rename that gives the finished file its name kills it.
static bool die_at_rename = false;
extern "C" int rename(const char* from, const char* to) {
  if (die_at_rename && std::string_view(to).ends_with(".tcell")) kill(getpid(), SIGKILL);
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Rule;

Scene scene_to_kill(const TempFolder& folder) {
  const Grid grid{{Axis::uniform(-5, 0.01, 0, 1000, 0.5), Axis::uniform(-5, 0.01, 0, 1000, 0.5), Axis::uniform(-5, 0.1, 0, 100, 0.5)}};
  Scene scene = scene_of(folder, {{shapes::sphere({0, 0, 0}, 4, 4)}, {shapes::torus({0, 0, 1}, 3, 1.5, 40, 30), Rule::kNonzero, 2}}, grid);
  scene.bodies[0].fill = Fill::kAuto;
  return scene;
}

MeshOptions options_to_kill() {
  MeshOptions options{.axis = 2};
  options.chunk_rays = 16;  // 256 tile groups
  options.checkpoint_seconds = 0;
  return options;
}

// Runs in a child that dies at the given call of progress, or while it renames the finished file when there is none such.
void run_and_die(const Scene& scene, const std::filesystem::path& output, const MeshOptions& options, int call) {
  run_and_kill(scene, output, options, call, [] { die_at_rename = true; });
}

TEST_CASE("A run killed anywhere resumes to the bytes of an undisturbed one") {
  const TempFolder folder;
  const Scene scene = scene_to_kill(folder);
  MeshOptions options = options_to_kill();
  REQUIRE(mesh_quietly(scene, folder / "whole.tcell", options)["overlaps"]["pairs"] == 1);
  const std::string expected = bytes_of(folder / "whole.tcell");
  uint64_t least = ~uint64_t{0}, most = 0;
  for (const int call : {1, 3, 4, 5, 20, 100, 200, 258, 259, 260, 1 << 20}) {
    if (kSanitized && call != 4 && call != 259 && call < 1000) continue;
    INFO("call " << call);
    options.resume = false;
    run_and_die(scene, folder / "g.tcell", options, call);
    options.resume = true;
    const auto report = mesh_quietly(scene, folder / "g.tcell", options);
    REQUIRE(bytes_of(folder / "g.tcell") == expected);
    REQUIRE_FALSE(std::filesystem::exists(checkpoint_path(folder / "g.tcell")));
    least = std::min(least, report["resumed_chunks"].get<uint64_t>());
    most = std::max(most, report["resumed_chunks"].get<uint64_t>());
    std::filesystem::remove(folder / "g.tcell");
  }
  CHECK(least == 0);
  CHECK(most > 1000);
}

TEST_CASE("A run killed again and again gets to the end, with other threads and memory each time") {
  const TempFolder folder;
  Scene scene = scene_to_kill(folder);
  scene.bodies[1].thin = Thin::kKeep;
  MeshOptions options = options_to_kill();
  options.thin = true;
  const auto whole = mesh_quietly(scene, folder / "whole.tcell", options);
  options.resume = true;
  for (int i = 0; i < (kSanitized ? 2 : 5); ++i) {
    options.threads = 1 + i % 3;
    options.memory = i % 2 == 0 ? 1 : ~uint64_t{0};
    run_and_die(scene, folder / "g.tcell", options, 30 + i);
  }
  const auto report = mesh_quietly(scene, folder / "g.tcell", options);
  CHECK(report["resumed_chunks"] > 0);
  CHECK(whole["bodies"][1]["lost"]["z"]["number"] > 0);
  CHECK(report["bodies"] == whole["bodies"]);
  CHECK(report["crossings"] == whole["crossings"]);
  CHECK(report["exact_decisions"] == whole["exact_decisions"]);
  REQUIRE(bytes_of(folder / "g.tcell") == bytes_of(folder / "whole.tcell"));
}

TEST_CASE("With nothing to resume a run starts from the beginning; without --resume always") {
  const TempFolder folder;
  const Scene scene = scene_to_kill(folder);
  MeshOptions options = options_to_kill();
  options.resume = true;
  REQUIRE(mesh_quietly(scene, folder / "a.tcell", options)["resumed_chunks"] == 0);
  run_and_die(scene, folder / "b.tcell", options, 100);
  options.resume = false;
  REQUIRE(mesh_quietly(scene, folder / "b.tcell", options)["resumed_chunks"] == 0);
  REQUIRE(bytes_of(folder / "a.tcell") == bytes_of(folder / "b.tcell"));
  REQUIRE_FALSE(std::filesystem::exists(checkpoint_path(folder / "b.tcell")));
}

TEST_CASE("Another input or another option is refused, and said") {
  const TempFolder folder;
  const Scene scene = scene_to_kill(folder);
  MeshOptions options = options_to_kill();
  run_and_die(scene, folder / "g.tcell", options, 100);
  const auto refuse = [&](const Scene& other, MeshOptions with, const std::string& what) {
    with.resume = true;
    REQUIRE_THROWS_WITH(mesh_quietly(other, folder / "g.tcell", with), Catch::Contains("can't resume") && Catch::Contains(what));
  };
  MeshOptions along_x = options;
  along_x.axis = 0;
  refuse(scene, along_x, "axis was \"z\" and is \"x\"");
  MeshOptions counting = options;
  counting.thin = true;
  refuse(scene, counting, "thin was false and is true");
  Scene finer = scene;
  finer.axis[0].cells = 1001;
  refuse(finer, options, "1001");
  Scene moved = scene;
  moved.bodies[1].matrix[3] = 1;
  refuse(moved, options, "bodies/1");
  shapes::write_obj(scene.bodies[0].mesh, shapes::sphere({0, 0, 0}, 4.5, 4));
  refuse(scene, options, "inputs/0");
  shapes::write_obj(scene.bodies[0].mesh, shapes::sphere({0, 0, 0}, 4, 4));
  options.resume = true;  // and after all that it can still go on
  REQUIRE(mesh_quietly(scene, folder / "g.tcell", options)["resumed_chunks"] > 0);
}

TEST_CASE("A damaged checkpoint or partial file is an error, not a wrong grid") {
  const TempFolder folder;
  const Scene scene = scene_to_kill(folder);
  MeshOptions options = options_to_kill();
  run_and_die(scene, folder / "g.tcell", options, 150);
  options.resume = true;
  for (const std::filesystem::path& path : {checkpoint_path(folder / "g.tcell"), folder / "g.tcell.partial"}) {
    const std::string bytes = bytes_of(path);
    for (const size_t at : {size_t{0}, bytes.size() / 3, size_t{100}}) {
      std::string flipped = bytes;
      flipped[at] ^= 4;
      std::ofstream(path, std::ios::binary) << flipped;
      REQUIRE_THROWS_AS(mesh_quietly(scene, folder / "g.tcell", options), FormatError);
      std::ofstream(path, std::ios::binary) << bytes;
    }
  }
}

TEST_CASE("A run that fails or is interrupted leaves no checkpoint") {
  const TempFolder folder;
  const Scene scene = scene_to_kill(folder);
  std::atomic<bool> stop{false};
  int calls = 0;
  REQUIRE_THROWS_AS(mesh(
                        scene, folder / "g.tcell", options_to_kill(), [&](const char*, double, double) { stop = ++calls == 50; }, stop),
                    Interrupted);
  REQUIRE_FALSE(std::filesystem::exists(checkpoint_path(folder / "g.tcell")));
  REQUIRE_FALSE(std::filesystem::exists(folder / "g.tcell.partial"));
}

}  // namespace
}  // namespace teracell::mesher

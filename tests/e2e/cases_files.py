"""Files: damage is noticed, and whatever goes wrong, outputs appear whole or not at all."""
import fcntl
import os
import random
import signal
import subprocess

import solids
from program import PROGRAM, Case, limit_files, teracell

BOX = solids.binary_stl(solids.box_facets((0.0, 0.0, 0.0), (4.0, 3.0, 2.0)))
SLICE = ["slice", "d.tcell", "--axis", "z", "--index", 11, "-o", "s.npy"]


OLD = os.path.join(os.path.dirname(os.path.abspath(__file__)), "format-2.1.tcell")  # `sample stadium` with --cells 100


class OldFiles(Case):
    def test_a_file_of_format_2_has_the_cells_of_one_that_is_made_today_and_is_packed_as_it_is(self):
        self.run_ok("sample", "stadium", "-o", "stadium")
        self.run_ok("mesh", "stadium/scene.json", "--cells", 100, "-o", "new.tcell")
        self.run_ok("pack", OLD, "-o", "packed.tcell")
        self.assertEqual([self.json_of("info", file)["file"]["version"] for file in (OLD, "new.tcell", "packed.tcell")], ["2.1", "3.2", "3.2"])
        for file in (OLD, "packed.tcell"):
            self.assertIn("sound", self.run_ok("verify", file).out)
            self.assertIn("the grids are equal", self.run_ok("diff", file, "new.tcell").out)


class Damage(Case):
    def setUp(self):
        super().setUp()
        self.run_ok("sample", "stadium", "-o", "stadium")
        self.run_ok("mesh", "stadium/scene.json", "--cells", "100,80,20", "-o", "g.tcell")
        self.whole = self.bytes("g.tcell")

    def test_any_flipped_bit_is_found_by_verify_and_never_changes_a_slice_unnoticed(self):
        self.write("d.tcell", self.whole)
        self.run_ok(*SLICE)
        expected = self.bytes("s.npy")
        rng = random.Random(3)
        places = [0, 9, 31, len(self.whole) - 1, len(self.whole) - 128, *(rng.randrange(len(self.whole)) for _ in range(70))]
        for place in places:
            damaged = bytearray(self.whole)
            damaged[place] ^= 1 << rng.randrange(8)
            self.write("d.tcell", damaged)
            os.unlink(self.path("s.npy")) if os.path.exists(self.path("s.npy")) else None
            said = self.refused(1, "d.tcell", "verify", "d.tcell")
            self.assertLessEqual(said.count(" chunk ("), 1, said)
            r = teracell(*SLICE, cwd=self.folder)
            if r.status == 0:
                self.assertEqual(self.bytes("s.npy"), expected, f"byte {place}")
            else:
                self.assert_refused(r, 1, "d.tcell")
                self.assertFalse(os.path.exists(self.path("s.npy")), "no slice of a damaged file")
        self.no_debris()

    def test_no_command_overwrites_what_it_reads(self):
        os.link(self.path("g.tcell"), self.path("k.npy"))
        for output in ("g.tcell", "./g.tcell"):
            self.refused(2, ["overwritten"], "export", "g.tcell", "--format", "raw", "-o", output)
        self.refused(2, ["overwritten"], "slice", "g.tcell", "--axis", "z", "--index", 3, "-o", "k.npy")
        # A link under the temporary name of the output must not redirect it either.
        self.write("precious", b"precious")
        for target, status, phrase in (("g.tcell", 2, "overwritten"), ("precious", 1, "x.npy.partial")):
            os.symlink(target, self.path("x.npy.partial"))
            self.assert_refused(teracell("slice", "g.tcell", "--axis", "z", "--index", 3, "-o", "x.npy", cwd=self.folder), status, phrase)
            os.unlink(self.path("x.npy.partial"))
        self.assertEqual(self.bytes("precious"), b"precious")
        self.assertEqual(self.bytes("g.tcell"), self.whole)

    def test_a_picture_in_three_dimensions_is_whole_or_not_there(self):
        self.run_ok("render", "g.tcell", "-o", "v.jpg", "--size", "64,48", "--cut", "y=0", "--materials", "grandstand,structure")
        self.assertEqual(self.bytes("v.jpg")[:3], b"\xff\xd8\xff")
        self.refused(2, "ends in .png, .jpg or .jpeg", "render", "g.tcell", "-o", "v.gif")
        self.refused(2, ["--materials", "found 'wood'"], "render", "g.tcell", "-o", "v.png", "--materials", "wood")
        self.refused(2, ["--from, --at: expected two points"], "render", "g.tcell", "-o", "v.png", "--from", "1,2,3", "--at", "1,2,3")
        os.link(self.path("g.tcell"), self.path("k.png"))
        self.refused(2, ["overwritten"], "render", "g.tcell", "-o", "k.png")
        self.write("d.tcell", self.whole[: len(self.whole) // 2])
        self.refused(1, ["d.tcell", "cut short"], "render", "d.tcell", "-o", "v.png")
        self.assertFalse(os.path.exists(self.path("v.png")))
        self.no_debris()

    def test_any_truncation_is_found(self):
        size = len(self.whole)
        for length in (0, 1, 31, 32, 159, 160, size // 3, size // 2, size - 128, size - 1):
            self.write("d.tcell", self.whole[:length])
            for args in (["verify", "d.tcell"], ["info", "d.tcell"], SLICE):
                self.refused(1, ["d.tcell", "cut short"], *args)
        self.write("d.tcell", self.whole + b"\0")
        self.refused(1, "d.tcell", "info", "d.tcell")

    def test_files_of_other_programs(self):
        self.write("d.tcell", BOX)
        for args in (["info", "d.tcell"], ["verify", "d.tcell"], ["stats", "d.tcell"], SLICE):
            self.refused(1, ["d.tcell", "not a teracell file"], *args)
        self.refused(1, ["no.tcell", "No such file"], "info", "no.tcell")
        self.refused(1, ["stadium", "folder"], "info", "stadium")


class Outputs(Case):
    def setUp(self):
        super().setUp()
        self.write("box.stl", BOX)
        self.run_ok("mesh", "box.stl", "--cells", 12, "-o", "g.tcell")

    def every_writer(self, name):
        """Commands that write `name`, each with the ending of its format."""
        return [["mesh", "box.stl", "--cells", 10, "-o", name + ".tcell"], ["slice", "g.tcell", "--axis", "z", "--index", 0, "-o", name + ".png"],
                ["slice", "g.tcell", "--axis", "z", "--index", 0, "-o", name + ".npy"], ["export", "g.tcell", "-o", name + ".raw"]]

    def test_a_missing_folder_is_named(self):
        for args in self.every_writer("nowhere/out"):
            self.refused(1, ["nowhere/out", "no folder 'nowhere'"], *args)
        self.refused(1, ["nowhere/r.json", "no folder"], "mesh", "box.stl", "--cells", 10, "-o", "x.tcell", "--report", "nowhere/r.json")
        self.assertFalse(os.path.exists(self.path("x.tcell")), "outputs are checked before the work")

    def test_a_folder_that_takes_no_files(self):
        for args in self.every_writer("/proc/out"):
            self.refused(1, ["/proc/out", "can't create"], *args)

    def test_a_name_that_is_a_folder(self):
        for args in self.every_writer("out"):
            os.mkdir(self.path(args[-1]))
            self.refused(1, [args[-1], "folder"], *args)

    def test_a_second_writer_is_refused(self):
        for args in self.every_writer("g"):
            before = self.bytes(args[-1]) if os.path.exists(self.path(args[-1])) else None
            partial = self.path(args[-1] + ".partial")
            with open(partial, "w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                self.assert_refused(teracell(*args, cwd=self.folder), 1, "another process is writing")
                self.assertTrue(os.path.exists(partial), "the partial file belongs to the other writer")
            self.assertEqual(self.bytes(args[-1]) if os.path.exists(self.path(args[-1])) else None, before)
            self.run_ok(*args)  # a partial file without a writer does not stop it
            self.no_debris()

    def test_what_a_killed_run_has_left_is_named_before_it_is_thrown_away(self):
        mesh = ["mesh", "box.stl", "--cells", 10, "-o", "x.tcell"]
        self.assertEqual(self.run_ok(*mesh).err, "")
        for checkpoint, args, more in ((False, mesh, ""), (True, mesh, ", and --resume would go on with it"), (False, [*mesh, "--shard", "0/1"], "")):
            name = "x.tcell.shard-0-of-1" if "--shard" in args else "x.tcell"
            self.write(f"{name}.partial", "some bytes")
            if checkpoint:
                self.write(f"{name}.resume", "a state")
            said = f"warning: {name}.partial will be thrown away when the grid is begun: a killed run has left it{more}\n"
            failed = teracell(args[0], "none.stl", *args[2:], cwd=self.folder)
            self.assertEqual((failed.status, failed.err.startswith(said), self.bytes(f"{name}.partial")), (1, True, b"some bytes"))
            self.assertEqual(self.run_ok(*args).err, said)
            self.no_debris()
        self.write("x.tcell.partial", "some bytes")
        self.assertEqual(self.run_ok(*mesh, "--resume").err, "warning: x.tcell.partial will be thrown away when the grid is begun: a killed run has left it, "
                         "but no x.tcell.resume to go on from\n")
        for args in [*self.every_writer("y")[1:], ["pack", "x.tcell", "-o", "y.tcell"], ["diff", "x.tcell", "x.tcell", "-o", "y.tcell"]]:
            self.write(f"{args[-1]}.partial", "some bytes")
            self.assertIn(f"warning: {args[-1]}.partial will be thrown away when the file is begun: a killed run has left it\n", self.run_ok(*args).err)
            self.no_debris()

    def test_ctrl_c_leaves_nothing_behind(self):
        kept = self.bytes("g.tcell")
        for sent in (signal.SIGINT, signal.SIGTERM):
            self.interrupt(["mesh", "box.stl", "--cells", "60000,60000,60000", "-o", "g.tcell", "--threads", 1],
                           lambda _: os.path.exists(self.path("g.tcell.partial")), sent)
            self.assertEqual(self.bytes("g.tcell"), kept, "the older file stays")
        self.run_ok("mesh", "box.stl", "--cells", "8000,8000,8000", "-o", "large.tcell")
        self.run_ok("mesh", "box.stl", "--cells", "2000,2000,2000", "-o", "linked.tcell", "--links")
        self.run_ok("mesh", "box.stl", "--cells", "700,700,700", "-o", "small.tcell")  # a file of leaves is begun when all of them are found
        before = set(os.listdir(self.folder))
        formats = [line.split()[0] for line in self.run_ok("export", "--list").out.splitlines() if not line.startswith(" ")]
        self.assertIn("ply", formats)
        for name in formats:
            media = {"openems": ["--epsilon", "box=2"], "openfoam": ["--ranks", 1000], "leaves": ["--refine", 4], "vtu": ["--refine", 4]}.get(name, [])  # 1000: labels that are wide enough
            grid = {"links": "linked.tcell", "leaves": "small.tcell", "vtu": "small.tcell"}.get(name, "large.tcell")
            self.interrupt(["export", grid, "-o", "out", "--format", name, *media], lambda _: set(os.listdir(self.folder)) != before)
            self.assertEqual(set(os.listdir(self.folder)), before, name)
        self.interrupt(["slice", "large.tcell", "--axis", "z", "--index", 3999, "-o", "large.npy"],
                       lambda _: os.path.exists(self.path("large.npy.partial")))
        self.assertFalse(os.path.exists(self.path("large.npy")))

    def full_disk_refuses(self, folder, **options):
        for args in (["mesh", "s/scene.json", "--cells", 1500, "-o", f"{folder}/x.tcell"], ["export", "big.tcell", "-o", f"{folder}/x.raw"],
                     ["slice", "big.tcell", "--axis", "z", "--index", 5, "-o", f"{folder}/x.npy"],
                     ["slice", "big.tcell", "--axis", "z", "--at", 3.5, "-o", f"{folder}/x.png"],
                     ["sample", "stadium", "-o", f"{folder}/stadium"]):
            r = teracell(*args, cwd=self.folder, **options)
            self.assert_refused(r, 1, ["can't write", args[-1]])
            self.assertFalse(os.path.exists(self.path(args[-1])))
        r = teracell("mesh", "many.json", "-o", "x.tcell", "--report", f"{folder}/r.json", cwd=self.folder, **options)
        self.assert_refused(r, 1, [])
        self.assertRegex(r.err, r"r\.json.*x\.tcell is complete")
        self.run_ok("verify", "x.tcell")
        self.assertFalse(os.path.exists(self.path(f"{folder}/r.json")))
        self.no_debris()

    def test_a_full_disk(self):
        self.run_ok("sample", "stadium", "-o", "s")
        self.run_ok("mesh", "s/scene.json", "--cells", 1500, "-o", "big.tcell")
        self.write("many.json", {"grid": {"cells": 3}, "materials": {"a": {}}, "bodies": [{"mesh": "box.stl", "material": "a"}] * 40})
        os.mkdir(self.path("small"))
        self.full_disk_refuses("small", preexec_fn=limit_files, restore_signals=False)
        self.assertEqual(os.listdir(self.path("small")), [])
        if self.mount_small_disk("small"):
            self.full_disk_refuses("small")
            self.assertEqual(os.listdir(self.path("small")), [])

    def test_results_that_can_not_be_printed(self):
        printing = [["--help"], ["--version"], ["info", "g.tcell"], ["info", "g.tcell", "--json"], ["stats", "g.tcell"],
                    ["column", "g.tcell", "--axis", "x", "--at", "1,1", "--json"], ["verify", "g.tcell"], ["mesh", "box.stl", "--cells", 9, "-o", "x.tcell"]]
        for args in printing:
            with open("/dev/full", "w") as full:
                self.assert_unprinted(teracell(*args, cwd=self.folder, stdout=full))
            reader, writer = os.pipe()
            os.close(reader)
            self.assert_unprinted(teracell(*args, cwd=self.folder, stdout=writer))
            os.close(writer)
            self.assert_unprinted(teracell(*args, cwd=self.folder, stdout=None, preexec_fn=lambda: os.close(1)))
        self.no_debris()
        self.run_ok("verify", "x.tcell")

    def assert_unprinted(self, r):
        self.assertEqual(r.status, 1, f"{r.args}: {r.err}")
        self.assert_paragraph(r.err)

    def test_errors_that_can_not_be_printed(self):
        for closed in (lambda: os.close(2), lambda: os.dup2(os.open("/dev/full", os.O_WRONLY), 2)):
            run = lambda *args: subprocess.run([PROGRAM, *args], cwd=self.folder, stdout=subprocess.PIPE, preexec_fn=closed).returncode
            self.assertEqual(run("info", "no.tcell"), 1)
            self.assertEqual(run("mesh", "box.stl", "--cells", "12", "-o", "x.tcell", "--progress", "plain"), 0)
            self.assertEqual(self.bytes("x.tcell"), self.bytes("g.tcell"), "what is printed never lands in the file")

    def test_progress_goes_to_stderr_when_asked_for(self):
        quiet = self.run_ok("mesh", "box.stl", "--cells", 12, "-o", "x.tcell")
        self.assertEqual(quiet.err, "")
        told = self.run_ok("mesh", "box.stl", "--cells", 12, "-o", "x.tcell", "--progress", "plain")
        for word in ("read", "mesh", "%", "MB"):
            self.assertIn(word, told.err)
        for name in ("x.raw", "x.stl"):
            self.assertEqual(self.run_ok("export", "g.tcell", "-o", name).err, "")
            told = self.run_ok("export", "g.tcell", "-o", name, "--progress", "plain")
            for word in ("export", "%", "MB"):
                self.assertIn(word, told.err)

    def test_a_terminal_sees_the_progress_of_an_export(self):
        ours, theirs = os.openpty()
        self.addCleanup(os.close, ours)
        subprocess.run([PROGRAM, "export", "g.tcell", "-o", "x.raw"], cwd=self.folder, stderr=theirs, check=True)
        os.close(theirs)
        seen = b""
        try:  # one read need not give all of it; the end is an error, since nobody holds the other side
            while piece := os.read(ours, 4096):
                seen += piece
        except OSError:
            pass
        seen = seen.decode()
        self.assertIn("export", seen)
        self.assertIn(" %", seen)
        self.assertTrue(seen.endswith("\r\033[K"), "the line is cleared")

"""Failures while a surface is read, closed or spilled: one paragraph says what failed and where, and no file is left behind."""
import gzip
import os
import subprocess
import threading
import time
import unittest

import solids
from program import PROGRAM, Case, limit_files, teracell

READ_FAULT = os.path.join(os.path.dirname(PROGRAM), "tests", "libread_fault.so")  # tests/CMakeLists.txt
STALKS = [f for i in range(120) for f in solids.box_facets((i / 32, i / 32, i / 32), (i / 32 + 0.015625, i / 32 + 0.015625, 5.0))]
OPEN = [f for i, f in enumerate(STALKS) if i % 12]


def spilled(cells):
    """Arguments with which each facet lies in several bins: the more, the more cells there are."""
    return ["--cells", cells, "--axis", "x", "-o", "x.tcell", "--memory", "1K"]


SPILLED = spilled(2000)


class Spilling(Case):
    def setUp(self):
        super().setUp()
        self.write("s.stl", solids.binary_stl(STALKS))
        os.mkdir(self.path("tmp"))

    def fails(self, phrases, *args, mesh="s.stl", cells=2000, **options):
        """The run fails with one paragraph that has the phrases, and leaves no file."""
        before = sorted(os.listdir(self.folder))
        self.refused(1, phrases, "mesh", mesh, *spilled(cells), *args, **options)
        self.assertEqual([n for n in sorted(os.listdir(self.folder)) if n not in before], [])
        self.assertEqual(os.listdir(self.path("tmp")), [])

    def test_the_spilled_file_has_no_name(self):
        self.run_ok("mesh", "s.stl", *SPILLED, "--tmp", "tmp", "--report", "r.json")
        self.assertEqual(os.listdir(self.path("tmp")), [])
        self.run_ok("mesh", "s.stl", "--cells", 2000, "--axis", "x", "-o", "y.tcell")
        self.assertEqual(self.bytes("x.tcell"), self.bytes("y.tcell"))
        self.assertNotIn(b'"spilled_bytes": 0,', self.bytes("r.json"))

    def test_bins_that_fit_into_half_of_the_memory_are_not_spilled(self):
        memory = 150 * (os.path.getsize(self.path("s.stl")) - 84) // 50  # the facets alone would take 256 bytes each of it
        mesh = ["mesh", "s.stl", "--cells", 2000, "--axis", "x", "-o"]
        self.run_ok(*mesh, "x.tcell", "--memory", memory, "--report", "r.json")
        self.run_ok(*mesh, "y.tcell")
        self.assertEqual(self.bytes("x.tcell"), self.bytes("y.tcell"))
        self.assertIn(b'"spilled_bytes": 0,', self.bytes("r.json"))
        self.refused(1, ["engine tree", "--memory"], *mesh, "x.tcell", "--memory", memory, "--engine", "tree")

    def test_a_folder_that_takes_no_files(self):
        self.fails(["nowhere: no folder for temporary files: No such file", "--tmp"], "--tmp", "nowhere")
        self.fails(["s.stl: no folder for temporary files: Not a directory", "--tmp"], "--tmp", "s.stl")
        self.fails(["/proc: ", "temporary files", "--tmp"], "--tmp", "/proc")
        if os.geteuid() == 0:
            return  # root may write everywhere
        os.chmod(self.path("tmp"), 0o500)
        self.fails(["tmp: can't create a temporary file: Permission denied", "--tmp"], "--tmp", "tmp")

    def test_a_full_disk(self):
        full = ["tmp: can't write byte ", "of a temporary file", "--tmp", "--memory"]
        self.fails([*full, "File too large"], "--tmp", "tmp", preexec_fn=limit_files, restore_signals=False)
        self.write("open.stl", solids.binary_stl(OPEN))
        self.fails([*full, "File too large"], "--tmp", "tmp", "--write-caps", "caps.stl", mesh="open.stl", preexec_fn=limit_files, restore_signals=False)
        if self.mount_small_disk("tmp"):
            self.fails(["tmp: expected", "of free space for temporary files", "--tmp"], "--tmp", "tmp")
            subprocess.run(["mount", "-o", "remount,size=96k", self.path("tmp")], check=True)
            self.fails([*full, "No space left"], "--tmp", "tmp", cells=20000)  # facets that lie in several bins take more space than was checked for

    def test_ctrl_c_while_a_large_surface_is_spilled(self):
        end = time.monotonic() + 0.5
        err = self.interrupt(["mesh", "s.stl", "--cells", 200000, "-o", "x.tcell", "--memory", "1K", "--tmp", "tmp", "--threads", 1],
                             lambda _: time.monotonic() > end)
        self.assert_paragraph(err)
        self.assertEqual((sorted(os.listdir(self.folder)), os.listdir(self.path("tmp"))), (["s.stl", "tmp"], []))


class Readings(Case):
    """A surface that doesn't fit into memory is read twice, an open one more often. The tests serve the first reading through a pipe."""

    def meshed(self, name, first, then, *args):
        """Meshes a file that holds `first` when it is opened for the first time, and `then` afterwards. With None it is gone."""
        os.mkfifo(self.path(name))

        def serve():
            with open(self.path(name), "wb") as pipe:  # until the program opens it
                if then is None:
                    os.unlink(self.path(name))
                else:
                    self.write("then", then)
                    os.replace(self.path("then"), self.path(name))
                pipe.write(first)

        server = threading.Thread(target=serve)
        server.start()
        r = teracell("mesh", name, *SPILLED, *args, cwd=self.folder)
        server.join()
        left = set(os.listdir(self.folder)) - {name}
        self.assertEqual(left, {"x.tcell"} if r.status == 0 else set(), r.err)
        for n in (*left, name):
            if os.path.exists(self.path(n)):
                os.unlink(self.path(n))
        return r

    def test_files_that_change_or_vanish_between_two_readings(self):
        other = [tuple(tuple(x + 1 for x in v) for v in f) for f in STALKS]
        for facets in (STALKS, OPEN):
            whole = solids.binary_stl(facets)
            self.assertEqual(self.meshed("a.stl", whole, whole).status, 0)
            for then, phrases in ((solids.binary_stl(other), ["a.stl: the file changed while it was"]), (whole[:-25], ["a.stl", "cut short"]),
                                  (b"solid nothing\nendsolid\n", ["a.stl", "no facet"]), (None, ["a.stl", "No such file"])):
                self.assert_refused(self.meshed("a.stl", whole, then, "--write-caps", "caps.stl"), 1, phrases)

    def test_truncated_gzip(self):
        self.write("s.stl.gz", gzip.compress(solids.binary_stl(STALKS))[:-400])
        self.refused(1, ["s.stl.gz", "cut short", "byte"], "mesh", "s.stl.gz", *SPILLED)
        self.assertEqual(os.listdir(self.folder), ["s.stl.gz"])

    @unittest.skipUnless(os.path.exists(READ_FAULT), "there is no libread_fault.so beside the program; CMake builds it with the tests")
    def test_a_disk_that_fails_while_it_is_read(self):
        for facets in (STALKS, OPEN):
            self.write("s.stl", solids.binary_stl(facets))
            size = len(self.bytes("s.stl"))
            for at in (0, size // 2, size, size + size // 2):  # in the first reading and in the second one
                env = {**os.environ, "LD_PRELOAD": READ_FAULT, "READ_FAULT_PATH": os.path.realpath(self.path("s.stl")), "READ_FAULT_BYTES": str(at),
                       "ASAN_OPTIONS": "verify_asan_link_order=0:" + os.environ.get("ASAN_OPTIONS", "")}
                self.refused(1, [f"s.stl: byte {at % size}: can't be read: Input/output error"], "mesh", "s.stl", *SPILLED,
                             "--write-caps", "caps.stl", env=env)
                self.assertEqual(os.listdir(self.folder), ["s.stl"])

    @unittest.skipUnless(os.path.exists(READ_FAULT), "there is no libread_fault.so beside the program; CMake builds it with the tests")
    def test_a_file_system_without_locks_is_not_another_process(self):
        self.write("s.stl", solids.binary_stl(STALKS))
        env = {**os.environ, "LD_PRELOAD": READ_FAULT, "READ_FAULT_LOCKS": "1",
               "ASAN_OPTIONS": "verify_asan_link_order=0:" + os.environ.get("ASAN_OPTIONS", "")}
        r = teracell("mesh", "s.stl", "--cells", 20, "-o", "x.tcell", cwd=self.folder, env=env)
        self.assert_refused(r, 1, "x.tcell.partial: can't lock: Function not implemented")


class MemoryAndCaps(Case):
    def test_invalid_sizes(self):
        self.write("s.stl", solids.binary_stl(STALKS))
        for size in (-1, "many", "1.5G", "8Q", "G", "18446744073709551616", "16777216T"):
            self.refused(2, ["--memory", "size like 512M", f"'{size}'"], "mesh", "s.stl", "--cells", 20, "-o", "x.tcell", f"--memory={size}")
        for size in ("1K", "1KB", "4MiB", "512M", "99999T"):
            self.run_ok("mesh", "s.stl", "--cells", 20, "-o", "x.tcell", "--memory", size)

    def test_engines_that_search_all_facets_say_what_they_need(self):
        self.write("s.stl", solids.binary_stl(STALKS))
        for engine in ("tree", "brute"):
            self.refused(1, [f"engine {engine}", "--memory", "scan"], "mesh", "s.stl", *SPILLED, "--engine", engine)

    def test_names_for_caps(self):
        self.write("s.stl", solids.binary_stl(OPEN))
        mesh = ["mesh", "s.stl", "--cells", 20, "-o", "x.tcell", "--write-caps"]
        self.refused(2, ["caps.obj", ".stl or .ply"], *mesh, "caps.obj")
        self.refused(2, ["s.stl", "overwritten"], *mesh, "./s.stl")
        self.refused(1, ["nowhere/caps.stl", "no folder"], *mesh, "nowhere/caps.stl")
        self.assertEqual(os.listdir(self.folder), ["s.stl"])

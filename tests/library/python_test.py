"""Arguments, errors, signals and threads of the Python package."""
import errno
import os
import pathlib
import pickle
import shutil
import signal
import subprocess
import sys
import textwrap
import unittest

import numpy
import teracell

from support import ENVIRONMENT, folder, grids


class Assemblies(unittest.TestCase):
    def test_parts_are_told_of_and_meshed_by_name(self):
        (folder / "two.off").write_text("OFF\n4 4 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
        found = teracell.info(folder / "two.off")
        self.assertEqual((found["format"], found["unit"], found["box"]), ("off", None, [0, 0, 0, 2, 2, 2]))
        self.assertEqual([(p["path"], p["closed"]) for p in found["parts"]], [("/mesh 1", True)])
        self.assertAlmostEqual(found["parts"][0]["volume"], 8 / 6)
        grid = teracell.mesh(folder / "two.off", folder / "two.tcell", units="mm", by_part=True, cells=40)
        self.assertEqual((grid.units, [m.name for m in grid.materials]), ("mm", ["air", "two"]))
        self.assertEqual(teracell.info(folder / "two.tcell")["units"], "mm")
        with self.assertRaisesRegex(ValueError, "units: expected m, cm"):
            teracell.mesh(folder / "two.off", folder / "two.tcell", units="parsec")


class Planes(unittest.TestCase):
    def test_planes_are_made_without_meshing_and_those_that_meshing_makes(self):
        (folder / "two.off").write_text("OFF\n4 4 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
        scene = {"units": "mm", "grid": {"auto": {"finest": 0.1, "coarsest": 1, "fixed": {"x": [0.05, 0.35, 0.48]}, "growth": 1.2}},
                 "materials": {"air": {}, "tin": {}}, "bodies": [{"name": "two", "mesh": "two.off", "material": "tin"}]}
        made = teracell.planes(scene, folder=folder)
        grid = teracell.mesh(scene, folder / "planes.tcell", folder=folder)
        for axis, planes in zip("xyz", (made.x, made.y, made.z)):
            self.assertEqual(planes.dtype, numpy.float64)
            numpy.testing.assert_array_equal(planes, next(a.planes for a in grid.axes if a.name == axis))
        self.assertEqual(made.breaches, grid.info["planes"]["breaches"])
        self.assertIn("no plane for a face of body 'two' at 0", made.warnings[0])
        for wrong, words in (({"grid": {}}, "bodies"), (folder / "none.json", "none.json"), (folder / "planes.tcell", "planes.tcell: ")):
            with self.assertRaisesRegex((ValueError, OSError), words):
                teracell.planes(wrong, folder=folder)


class Arguments(unittest.TestCase):
    def test_absurd_arguments_are_value_errors_in_words_of_the_package(self):
        grid = teracell.open(grids[0])
        box = (0, 0, 0, 4, 4, 4)
        for call, words in (
            (lambda: grid.stats((0, 0, 0, 1, 1, 2**70)), "box: expected -9007199254740992 to"),
            (lambda: grid.stats((0, 0, 0, 1, 1, 10**5000)), "box: expected .* found a value of the type int"),
            (lambda: grid.stats((0, 0, 0, 1, 1)), "box: expected 6 whole numbers"),
            (lambda: grid.stats(7), "box: expected 6 whole numbers, found 7"),
            (lambda: grid.uniform((0, 0, 0, 1, 1, 1.5)), "box: expected a whole number, found 1.5"),
            (lambda: grid.runs("abcdef"), "box: expected a whole number, found 'a'"),
            (lambda: grid.level(2**40), "level: expected 0 to"),
            (lambda: grid.level(-1), "level: expected 0 to"),
            (lambda: grid.level("0"), "level: expected a whole number"),
            (lambda: grid.read(box, threads=None), "threads: expected a whole number, found None"),
            (lambda: grid.read(box, threads=2**40), "threads: expected 0 to 1024"),
            (lambda: grid.read(box, halo=(1, 2)), "halo: expected one or 3 whole numbers"),
            (lambda: grid.read(box, halo=(1, 2, 3, 4)), "halo: expected one or 3 whole numbers"),
            (lambda: grid.read(box, halo=None), "halo: expected"),
            (lambda: grid.read(box, halo=2**60), "halo: expected 0 to"),
            (lambda: grid.read(box, halo=-1), "halo: expected 0 to"),
            (lambda: grid.read(box, outside=1.7), "outside: expected a whole number, found 1.7"),
            (lambda: grid.read(box, outside=-1), "outside: expected 0 to"),
            (lambda: grid.read(box, outside=2**32), "outside: expected 0 to 4294967295"),
            (lambda: grid.read(box, order="K"), "order: expected 'C' or 'F'"),
            (lambda: grid.read(box, out=[[[0]]]), "out: expected an array of NumPy"),
            (lambda: grid.column("w", (0, 0)), "axis: expected 'z', 'y', 'x'"),
            (lambda: grid.column(3, (0, 0)), "axis: expected 0 to 2"),
            (lambda: grid.column("z", (0, 2**70)), "at: expected"),
            (lambda: grid.column("z", 5), "at: expected 2 whole numbers"),
            (lambda: teracell.mesh({}, folder / "m.tcell", pad=2**70), "pad: expected 0 to"),
            (lambda: teracell.mesh({}, folder / "m.tcell", cells=(1, 2)), "cells: expected one or 3 whole numbers"),
            (lambda: teracell.mesh({}, folder / "m.tcell", cells=2**70), "cells: expected 1 to"),
            (lambda: teracell.mesh({}, folder / "m.tcell", cells=0.5), "cells: expected one or 3 whole numbers, found 0.5"),
            (lambda: teracell.mesh({}, folder / "m.tcell", step=10**400), "step: expected a number"),
            (lambda: teracell.mesh({}, folder / "m.tcell", threads=-1), "threads: expected 0 to 1024"),
            (lambda: teracell.mesh({}, folder / "m.tcell", memory=2**70), "memory: expected"),
            (lambda: teracell.mesh({}, folder / "m.tcell", progress=5), "progress: expected a function"),
        ):
            with self.assertRaisesRegex(teracell.UsageError, words) as caught:
                call()
            self.assertLess(len(str(caught.exception)), 300)
        for key in (2**70, -(2**70), (0, 0, 10**5000)):
            with self.assertRaises(IndexError):
                grid[key]
        numpy.testing.assert_array_equal(grid[1 :: 2**70, 0, 0], grid[1:2, 0, 0])  # as NumPy

    def test_numpy_2_may_say_whether_it_wants_a_copy(self):
        level = teracell.open(grids[0]).level(3)
        for copy in (None, True):
            numpy.testing.assert_array_equal(level.__array__(copy=copy), level[...])
        self.assertEqual(level.__array__(numpy.float32, copy=True).dtype, numpy.float32)
        with self.assertRaises(ValueError):
            level.__array__(copy=False)


class Paths(unittest.TestCase):
    def test_a_path_may_be_bytes_and_need_not_be_utf_8(self):
        name = os.fsencode(folder) + b"/gr\xfcn \xc3\xa4.tcell"
        shutil.copy(grids[0], name)
        expected = teracell.open(grids[0])[5]
        for path in (name, os.fsdecode(name), pathlib.Path(os.fsdecode(name))):
            grid = teracell.open(path)
            numpy.testing.assert_array_equal(grid[5], expected)
            self.assertEqual(os.fsencode(grid.path), name)
            self.assertTrue(repr(grid).encode())
        report = teracell.mesh(os.fsencode(folder / "stadium/scene.json"), os.fsencode(folder) + b"/\xff.tcell", cells=20).report
        self.assertTrue(report)
        with self.assertRaises(teracell.IoError) as caught:
            teracell.open(name + b"\xfe")
        self.assertIn(os.fsdecode(name + b"\xfe"), str(caught.exception))

    def test_a_path_with_a_nul_names_no_other_file(self):
        for path in (str(grids[0]) + "\0", os.fsencode(grids[0]) + b"\0.bak"):
            with self.assertRaisesRegex(ValueError, "NUL"):
                teracell.open(path)
            with self.assertRaisesRegex(ValueError, "NUL"):
                teracell.Partition(path)
            with self.assertRaisesRegex(ValueError, "NUL"):
                teracell.mesh(folder / "stadium/scene.json", path, cells=9)
            with self.assertRaisesRegex(ValueError, "NUL"):
                teracell.mesh(path, folder / "m.tcell", cells=9)

    def test_an_io_error_is_an_os_error_with_the_number_of_the_system(self):
        for call in (lambda: teracell.open(folder / "none.tcell"), lambda: teracell.Partition(folder / "none.json"),
                     lambda: teracell.mesh(folder / "none.json", folder / "m.tcell", cells=9),
                     lambda: teracell.mesh(folder / "none.stl", folder / "m.tcell", cells=9),
                     lambda: teracell.info(folder / "none.stl"), lambda: teracell.planes(folder / "none.json")):
            with self.assertRaises(FileNotFoundError) as caught:
                call()
            self.assertIsInstance(caught.exception, teracell.IoError)
            self.assertIsInstance(pickle.loads(pickle.dumps(caught.exception)), FileNotFoundError)
            self.assertEqual(caught.exception.errno, errno.ENOENT)
            self.assertRegex(str(caught.exception), r"none\.\w+: can't .*No such file")
            self.assertFalse(str(caught.exception).startswith("["), "the words of the command line")
        with self.assertRaises(IsADirectoryError) as caught:
            teracell.open(folder)
        self.assertIsInstance(caught.exception, teracell.IoError)
        self.assertIn("expected a file, found a folder", str(caught.exception))


def python(script, *args):
    return subprocess.run([sys.executable, "-c", textwrap.dedent(script), *map(str, args)], capture_output=True, text=True, env=ENVIRONMENT)


class Threads(unittest.TestCase):
    def test_ctrl_c_ends_the_filling_of_what_lies_outside(self):
        done = python("""
            import signal, sys, numpy, teracell
            grid = teracell.open(sys.argv[1])
            out = numpy.zeros((1600, 1600, 1600), numpy.uint8)  # pages that nobody has touched
            signal.setitimer(signal.ITIMER_REAL, 0.1)
            signal.signal(signal.SIGALRM, signal.default_int_handler)
            try:
                grid.read((5000, 0, 0, 6600, 1600, 1600), out=out, outside=7)
            except KeyboardInterrupt:
                print(out[0, 0, 0], out[-1, -1, -1])
        """, grids[0])
        self.assertEqual((done.stdout, done.stderr), ("7 0\n", ""), "stopped on the way")

    def test_daemon_threads_that_read_let_the_interpreter_end(self):
        script = """
            import sys, threading, time, teracell
            grid = teracell.open(sys.argv[1])
            box = (-20, -20, -20) + tuple(n + 20 for n in grid.shape)
            def read():
                while True:
                    grid.read(box, threads=int(sys.argv[2]))
                    grid.stats()
            for _ in range(3):
                threading.Thread(target=read, daemon=True).start()
            time.sleep(0.1)
            print("end")
        """
        for _ in range(6):
            for threads in (1, 2):
                done = python(script, grids[0], threads)
                self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "end\n", ""))

    def test_a_task_of_dask_reads_with_one_thread(self):
        grid = teracell.open(grids[0])
        native, seen = grid._native, []

        class Recorder:
            hash = native.hash

            def read(self, *args):
                seen.append(args[-1])
                return native.read(*args)

        grid._file.native = Recorder()
        grid.dask(chunks=64)[:70, :70].sum().compute()
        self.assertGreater(len(seen), 3)
        self.assertEqual(set(seen), {1})
        grid[0]
        self.assertEqual(seen[-1], 0)


if __name__ == "__main__":
    unittest.main()

"""Grids behind addresses in C (by way of ctypes) and Python: the cells of the file, or an error."""
import ctypes
import os
import pickle
import sys
import unittest

import numpy
import teracell

from support import PREFIX, PROGRAM, folder, run

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "e2e"))
from origin import Origin  # noqa: E402


class Addresses(unittest.TestCase):
    def setUp(self):
        self.path = folder / "far.tcell"
        if not self.path.exists():
            run(PROGRAM, "mesh", folder / "stadium/scene.json", "--cells", "400", "-o", self.path)  # so large that its end is not all of it
        self.origin = Origin(dict.fromkeys(["/g.tcell", "/bucket/g.tcell"], self.path.read_bytes()))
        self.addCleanup(self.origin.close)
        self.address = self.origin.url + "/g.tcell"

    def test_the_cells_of_the_file(self):
        expected = teracell.open(self.path)
        for grid in [teracell.open(self.address), teracell.open(self.address, cache_dir=folder / "kept", cache_dir_size=10**6),
                     teracell.open("s3://bucket/g.tcell", endpoint=self.origin.url)]:
            numpy.testing.assert_array_equal(grid[...], expected[...])
            numpy.testing.assert_array_equal(grid.level(1)[...], expected.level(1)[...])
            copy = pickle.loads(pickle.dumps(grid))
            self.assertEqual(copy.path, grid.path)
            numpy.testing.assert_array_equal(pickle.loads(pickle.dumps(copy.level(1)))[...], expected.level(1)[...])
            numpy.testing.assert_array_equal(grid.level(1).dask(chunks=16).compute(), expected.level(1)[...])
        self.assertTrue(os.listdir(folder / "kept"))

    def test_errors(self):
        with self.assertRaisesRegex(teracell.UsageError, "https://"):
            teracell.open("http://192.0.2.1/g.tcell")
        with self.assertRaisesRegex(teracell.UsageError, "cache_dir_size: expected 1 to"):
            teracell.open(self.address, cache_dir_size=0)
        for kind in (teracell.IoError, FileNotFoundError):
            with self.assertRaisesRegex(kind, "status 404"):
                teracell.open(self.origin.url + "/none.tcell")
        self.origin.mode = "forbidden"
        for kind in (teracell.IoError, PermissionError):
            with self.assertRaisesRegex(kind, "status 403"):
                teracell.open(self.address)

    def test_older_programs_know_fewer_members(self):
        library = ctypes.CDLL(PREFIX + "/lib/libteracell.so")
        grid = ctypes.c_void_p()
        for source, size in [(None, 0), (b"\0" * 8, 8)]:
            self.assertEqual(library.tc_open_source(self.address.encode(), source, ctypes.c_size_t(size), ctypes.byref(grid)), 0)
            library.tc_close(grid)


if __name__ == "__main__":
    unittest.main()

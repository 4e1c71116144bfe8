"""Grids as those who know NumPy, h5py and Zarr expect them to be."""
import base64
import html.parser
import importlib.metadata
import random
import re
import struct
import subprocess
import sys
import unittest
import zlib

import numpy
import teracell

from support import ENVIRONMENT, folder, grids


def pyramid(name, grid):
    """A grid with a pyramid in it."""
    (folder / "pyramid.off").write_text("OFF\n4 4 0\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
    scene = {"units": "mm", "grid": grid, "materials": {"air": {}, "<steel>": {"color": "#ff8800"}},
             "bodies": [{"name": "p", "mesh": "pyramid.off", "material": "<steel>"}]}
    return teracell.mesh(scene, folder / name, folder=folder)


class Closing(unittest.TestCase):
    def test_with_closes_a_grid_and_its_levels(self):
        with teracell.open(grids[0]) as grid:
            level = grid.level(1)
            self.assertFalse(grid.closed)
            cells, lazy = grid[5], level.dask()
        self.assertTrue(grid.closed)
        grid.close()  # again
        for ask in (lambda: grid[5], lambda: level[0], lambda: grid.level(2), lambda: grid.stats(), lambda: grid.units, lambda: grid == 1,
                    lambda: grid.__enter__(), lambda: lazy.compute()):
            with self.assertRaisesRegex(ValueError, "x.tcell: the grid is closed"):
                ask()
        self.assertIn("closed", repr(grid))
        self.assertEqual((level.ndim, grid.materials[0].name), (3, "air"))
        numpy.testing.assert_array_equal(teracell.open(grids[0])[5], cells)

    def test_the_file_is_closed_at_once(self):
        script = """
            import os, sys, teracell
            count = lambda: len(os.listdir("/proc/self/fd"))
            before = count()
            with teracell.open(sys.argv[1]) as grid:
                level = grid.level(1)
                level[...]
                print(count() - before)
            print(count() - before)
        """
        done = subprocess.run([sys.executable, "-c", re.sub("^ {12}", "", script, flags=re.M), grids[0]], env=ENVIRONMENT, capture_output=True, text=True)
        self.assertEqual((done.stdout, done.stderr), ("1\n0\n", ""))


class Facts(unittest.TestCase):
    def test_sizes_in_cells_and_bytes(self):
        level = teracell.open(grids[0]).level(1)
        self.assertEqual((level.ndim, level.size, level.nbytes, len(level)), (3, level[...].size, level[...].nbytes, level.shape[0]))

    def test_origin_and_spacing_give_the_planes(self):
        grid = teracell.open(grids[0])
        for level in (grid, grid.level(3)):
            for axis, origin, spacing in zip(level.axes, level.origin, level.spacing):
                numpy.testing.assert_allclose(axis.planes[:-1], origin + spacing * numpy.arange(len(axis.planes) - 1))

    def test_a_graded_grid_has_an_origin_and_no_spacing(self):
        grid = pyramid("graded.tcell", {"x": {"planes": [0, 0.1, 0.3, 0.7, 2]}, "y": {"planes": [-1, 1, 3]}, "z": {"planes": [0, 1, 3]}})
        self.assertEqual(grid.origin, (0, -1, 0))
        with self.assertRaisesRegex(ValueError, "the cells along x differ in width: see the planes in `axes`"):
            grid.spacing


class Comparisons(unittest.TestCase):
    def test_a_comparison_is_an_array_of_booleans(self):
        grid = teracell.open(grids[1])
        for level in (grid, grid.level(2)):
            cells = level[...]
            for found, expected in (
                (level == 1, cells == 1),
                (level != 1, cells != 1),
                (level < 2, cells < 2),
                (level <= 2, cells <= 2),
                (level > 1.5, cells > 1.5),
                (1 <= level, cells >= 1),
                (level == cells[0], cells == cells[0]),
                (level == level, cells == cells),
                (cells == level, cells == cells),
                (level == None, cells == 99),  # noqa: E711
                (level == "grandstand", cells == 2),
                (level != grid.materials["grandstand"], cells != 2),
            ):
                self.assertEqual(found.dtype, bool)
                numpy.testing.assert_array_equal(found, expected)
        numpy.testing.assert_array_equal(grid[grid == "explosive"], 1)

    def test_names_have_no_order_and_must_be_known(self):
        grid = teracell.open(grids[1])
        with self.assertRaises(TypeError):
            grid < "air"
        with self.assertRaisesRegex(ValueError, "expected a name of air, .* found 'cheese'"):
            grid == "cheese"

    def test_a_grid_is_itself_as_a_key(self):
        grid, other = teracell.open(grids[0]), teracell.open(grids[0])
        self.assertEqual({grid: 1, other: 2}[grid], 1)
        self.assertEqual([other, grid].index(other), 0)

    def test_a_grid_larger_than_memory_says_what_to_do_instead(self):
        grid = pyramid("huge.tcell", {"cells": [1_000_000, 1000, 1000]})
        for ask in (lambda: grid == 1, lambda: grid[...], lambda: numpy.asarray(grid), lambda: grid[[0] * 1_000_000]):
            with self.assertRaisesRegex(MemoryError, r"select a box, g\[z0:z1") as caught:
                ask()
            self.assertIsInstance(caught.exception, teracell.TooLargeError)
        self.assertEqual((grid[:9, :9, :9] == 1).sum(), grid.stats((0, 0, 0, 9, 9, 9))[1].cells)


class Lists(unittest.TestCase):
    def test_lists_arrays_and_masks_select_what_numpy_selects(self):
        rng = numpy.random.default_rng(5)
        choose = random.Random(5).choice

        def part(n, count):
            kind = choose(["list", "list", "array", "mask", "number", "slice", "slice"])
            if kind == "list":
                return rng.integers(-n, n, count).tolist()
            if kind == "array":
                return rng.integers(-n, n, (2, count)).astype(choose([numpy.int8, numpy.int64]))
            if kind == "mask":
                mask = numpy.zeros(n, bool)
                mask[rng.permutation(n)[:count]] = True
                return mask
            return int(rng.integers(-n, n)) if kind == "number" else slice(None, None, choose([1, 3, -1, -2]))

        for path in grids:
            for level in (teracell.open(path).level(1), teracell.open(path).level(6)):
                cells = level[...]
                for _ in range(150):
                    count = choose([1, 2, 5]) if min(cells.shape) >= 5 else 1
                    key = [part(n, count) for n in cells.shape[: choose([1, 2, 3])]]
                    if choose([True, False]):
                        key.insert(choose(range(len(key) + 1)), choose([None, Ellipsis]))
                    if Ellipsis in [k for k in key if not isinstance(k, (list, numpy.ndarray))] and len(key) < 4:
                        key = [Ellipsis]
                    self.assert_same(level, cells, tuple(key))

    def test_lattices_points_and_masks_of_boxes(self):
        grid = teracell.open(grids[2])
        cells = grid[...]
        ascending = numpy.arange(25)
        for key in (
            [], [3], [5, 1, 5, -1], ([],), ([], [], slice(3)), numpy.int64(4), numpy.array(4), range(3),
            (0, slice(None), [7, 2]), ([7, 2], slice(None), 0), (None, [1], ..., None, [2]), (slice(None), [1], ..., 5), (slice(2), [1, 0], ..., [4, 2]), (0, 1, 2, ...),
            numpy.ix_([4, 1], range(0, 90, 7), [3, 140]), numpy.ix_([4, 1, 7], [50, 3, 4], [3, 140, 9]),
            (ascending, ascending, ascending), (ascending[:, None], ascending), (ascending, slice(None, None, -7), ascending),
            cells == 2, cells > 9, (cells[:, :, 0] == 3,), (slice(None), cells[0] == 3), (slice(None, None, -2), cells[0] == 3),
            numpy.ones(cells.shape, bool), (cells[:, 0, 0] == 0, 4, [1]),
        ):
            self.assert_same(grid, cells, key)

    def test_wrong_lists_are_index_errors(self):
        grid = teracell.open(grids[0])
        n = grid.shape[0]
        for key, words in (
            ([n], f"index {n} is out of bounds for axis 0 with size {n}"),
            ([-n - 1, 0], "out of bounds"),
            ([0.5], "whole numbers or booleans"),
            (["air"], "whole numbers or booleans"),
            ([[0], [1, 2]], "expected a list"),
            (([1, 2], [1, 2, 3]), "could not be broadcast together with shapes .2,. .3,."),
            (([0], [0], [0], [0]), "too many indices"),
            (numpy.zeros(grid.shape + (1,), bool), "too many indices"),
            (numpy.zeros((n, 2), bool), "boolean index did not match"),
        ):
            with self.assertRaisesRegex(IndexError, words):
                grid[key]

    def test_few_cells_are_read_for_few_that_are_selected(self):
        grid = teracell.open(grids[0])
        native, read = grid._native, []

        class Recorder:
            def read(self, level, first, step, out, *more):
                read.append(out.size)
                native.read(level, first, step, out, *more)

        ends = [0, grid.shape[0] - 1], [0, grid.shape[1] - 1], [0, grid.shape[2] - 1]
        for key, most in ((tuple(ends), 8), (([0, -1],), 2 * grid[0].size), (([1], slice(None), [0, 149]), 2 * grid.shape[1]), ([], 0)):
            grid._file.native, read[:] = Recorder(), []
            grid[key]
            grid._file.native = native
            self.assertLessEqual(sum(read), most)

    def test_points_of_a_trillion_cells_are_read_without_the_cells_between(self):
        grid = pyramid("trillion.tcell", {"cells": [10_000, 10_000, 10_000]})
        points = numpy.random.default_rng(1).integers(0, 10_000, (3, 300))
        found = grid[tuple(points)]
        diagonal = grid[points[0], points[0]]
        self.assertEqual(diagonal.shape, (300, 10_000))
        for at, label in list(zip(points.T, found))[:20]:
            self.assertEqual(grid[tuple(at)], label)
        self.assertIn("1,000,000,000,000", grid._repr_html_())

    def assert_same(self, level, cells, key):
        expected, found = cells[key], level[key]
        self.assertEqual((numpy.shape(found), found.dtype), (numpy.shape(expected), expected.dtype), key)
        numpy.testing.assert_array_equal(found, expected, str(key))


class Materials(unittest.TestCase):
    def test_materials_are_found_by_id_and_by_name(self):
        materials = teracell.open(grids[0]).materials
        self.assertEqual(materials.names, [m.name for m in materials])
        self.assertEqual(materials["structure"], materials[3])
        self.assertEqual([m.name for m in materials[:2]], ["air", "explosive"])
        self.assertTrue("air" in materials and materials[1] in materials and "cheese" not in materials)
        with self.assertRaisesRegex(KeyError, "expected a name of air, explosive"):
            materials["cheese"]


class Notebook(unittest.TestCase):
    def test_a_grid_is_shown_with_facts_and_three_slices_of_its_colours(self):
        grid = pyramid("shown.tcell", {"cells": [60, 40, 20], "min": [0, 0, 0], "max": [3, 2, 1]})
        page = grid._repr_html_()
        html.parser.HTMLParser().feed(page)
        for words in ("60 × 40 × 20 = 48,000", "48,000 bytes", "3 × 2 × 1 mm", grid.hash, "&lt;steel&gt;", "z = 0.525 mm"):
            self.assertIn(words, page)
        pictures = [base64.b64decode(data) for data in re.findall("data:image/png;base64,([^']*)'", page)]
        self.assertEqual([struct.unpack(">II", p[16:24]) for p in pictures], [(60, 40), (60, 20), (40, 20)])
        lines = numpy.frombuffer(zlib.decompress(pictures[0][41:]), numpy.uint8).reshape(40, 1 + 4 * 60)[:, 1:].reshape(40, 60, 4)
        numpy.testing.assert_array_equal((lines == (255, 136, 0, 255)).all(axis=2)[::-1], grid[10] == 1)
        self.assertIn("1 of 0 to", grid.level(1)._repr_html_())


class Package(unittest.TestCase):
    def test_the_installed_package_says_its_version_and_that_it_is_typed(self):
        self.assertEqual(importlib.metadata.version("teracell"), teracell.__version__)
        place = next(iter(teracell.__path__))
        for file in ("py.typed", "__init__.pyi", "_materials.pyi"):
            with open(f"{place}/{file}"):
                pass


if __name__ == "__main__":
    unittest.main()

"""Debian's python3-zarr reads the folders and zips that `teracell export --zarr-version 2` writes."""
import glob
import os
import unittest
import zipfile

import numpy
import zarr

from support import FOLDER, GRIDS, Case, exported, levels, teracell

REGION = (7, 5, 3, 200, 150, 9)  # x, y, z; below the size of both grids


def written(grid, name, *more):
    path = os.path.join(FOLDER, name)
    if not os.path.exists(path):
        teracell("export", f"{grid}.tcell", "-o", name, "--zarr-version", 2, *more)
    return path


class ZarrExport(Case):
    def stores(self, grid):
        yield written(grid, f"{grid}.v2.zarr")
        with zarr.storage.ZipStore(written(grid, f"{grid}.v2.zarr.zip"), mode="r") as store:
            yield store

    def test_every_level_is_as_exported(self):
        for grid in GRIDS:
            for store in self.stores(grid):
                for opened in (zarr.open_group(store, mode="r"), zarr.open_consolidated(store, mode="r")):
                    self.assertEqual(sorted(opened.array_keys()), sorted(map(str, levels(grid))))
                    for level in levels(grid):
                        array = opened[str(level)]
                        self.assertEqual((array.fill_value, array.compressor.codec_id), (0, "zstd"))
                        self.assert_same(array[:], exported(grid, level))

    def test_a_region_with_other_numbers(self):
        lo, hi = REGION[:3], REGION[3:]
        for grid in GRIDS:
            materials = [m["name"] for m in GRIDS[grid]["materials"]]
            numbers = numpy.arange(len(materials), dtype=numpy.uint32) * 70000 + 5
            path = written(grid, f"{grid}.part.zarr", "--region", ",".join(map(str, REGION)), "--map", ",".join(f"{m}={n}" for m, n in zip(materials, numbers)))
            group = zarr.open(path, mode="r")
            for level in levels(grid):
                box = tuple(slice(lo[d] >> level, -(-hi[d] >> level)) for d in (2, 1, 0))
                self.assertEqual(group[str(level)].fill_value, numbers[0])
                self.assert_same(group[str(level)][:], numbers[exported(grid, level)[box]])

    def test_chunks_of_background_are_not_there(self):
        for grid in GRIDS:
            array, expected = zarr.open(written(grid, f"{grid}.v2.zarr"), mode="r")["0"], exported(grid, 0)
            nonzero = 0
            for z, y, x in numpy.ndindex(*array.cdata_shape):
                c = array.chunks
                nonzero += bool(expected[z * c[0]:(z + 1) * c[0], y * c[1]:(y + 1) * c[1], x * c[2]:(x + 1) * c[2]].any())
            there = glob.glob(os.path.join(FOLDER, f"{grid}.v2.zarr", "0", "*", "*", "*"))
            self.assertEqual(len(there), nonzero)

    def test_zips_of_both_versions_are_sound(self):
        for grid in GRIDS:
            teracell("export", f"{grid}.tcell", "-o", f"{grid}.python.ozx")
            for name in (f"{grid}.python.ozx", f"{grid}.v2.zarr.zip"):
                with zipfile.ZipFile(written(grid, name)) as archive:
                    self.assertIsNone(archive.testzip())
                    self.assertEqual({i.compress_type for i in archive.infolist()}, {zipfile.ZIP_STORED})


if __name__ == "__main__":
    unittest.main()

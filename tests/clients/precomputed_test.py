"""Reads all blocks of every size of Neuroglancer's precomputed volumes, as their specification says. The viewer itself, in
neuroglancer_test.mjs, asks only for what it shows."""
import itertools
import json
import unittest

import numpy

from support import GRIDS, Case, exported, get, levels


def ends(size, step):
    return [(lo, min(lo + step, size)) for lo in range(0, size, step)]


def read_blocks(grid, scale, block, dtype):
    """The level [z][y][x] from its blocks. A block must have exactly the bytes of its part of the volume."""
    nx, ny, nz = scale["size"]
    cells = numpy.full((nz, ny, nx), 0xFF, dtype)
    for (x0, x1), (y0, y1), (z0, z1) in itertools.product(*map(ends, scale["size"], block)):
        bytes_ = get(f"precomputed/{grid}/{scale['key']}/{x0}-{x1}_{y0}-{y1}_{z0}-{z1}")
        cells[z0:z1, y0:y1, x0:x1] = numpy.frombuffer(bytes_, dtype).reshape(z1 - z0, y1 - y0, x1 - x0)
    return cells


class Precomputed(Case):
    def info(self, grid):
        return json.loads(get(f"precomputed/{grid}/info"))

    def test_every_level_is_as_exported_in_blocks_of_every_size(self):
        for grid in GRIDS:
            info = self.info(grid)
            self.assertEqual((info["@type"], info["type"], info["num_channels"]), ("neuroglancer_multiscale_volume", "segmentation", 1))
            self.assertEqual(len(info["scales"]), len(levels(grid)))
            for level, scale in enumerate(info["scales"]):
                expected = exported(grid, level)
                self.assertEqual((scale["encoding"], scale["voxel_offset"]), ("raw", [0, 0, 0]))
                self.assertEqual(scale["size"], list(expected.shape[::-1]))
                for block in scale["chunk_sizes"]:
                    # A thick level has too many flat blocks. Those of the next level test the same.
                    if numpy.prod([len(ends(n, b)) for n, b in zip(scale["size"], block)]) > 1000:
                        continue
                    with self.subTest(grid=grid, level=level, block=block):
                        self.assert_same(read_blocks(grid, scale, block, numpy.dtype(info["data_type"])), expected)

    def test_segments_have_the_materials_names_and_volumes(self):
        for grid in GRIDS:
            properties = json.loads(get(f"precomputed/{grid}/{self.info(grid)['segment_properties']}/info"))["inline"]
            self.assertEqual(properties["ids"], [str(m["id"]) for m in GRIDS[grid]["materials"][1:]])
            names = next(p for p in properties["properties"] if p["type"] == "label")["values"]
            self.assertEqual(names, [m["name"] for m in GRIDS[grid]["materials"][1:]])
        steps = [axis["step"] for axis in GRIDS["stadium"]["grid"]["axes"]]
        cells = numpy.bincount(exported("stadium", 0).ravel())[1:]
        properties = json.loads(get("precomputed/stadium/segprops/info"))["inline"]["properties"]
        volumes = next(p for p in properties if p["id"] == "volume_m3")["values"]
        numpy.testing.assert_allclose(volumes, cells * numpy.prod(steps), rtol=1e-9)

    def test_other_blocks_are_missing(self):
        for path in ("s0/0-256_0-256_0-2", "s0/0-255_0-256_0-1", "s0/0-256_0-256_61-62", "s0/256-512_0-241_0-1", "s99/0-1_0-1_0-1", "s0/", "0/0-1"):
            self.assert_missing(f"precomputed/stadium/{path}")


if __name__ == "__main__":
    unittest.main()

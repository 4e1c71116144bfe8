"""Meep runs on the permittivities that `teracell export --profile meep` writes, and has them where they belong."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import warnings

warnings.filterwarnings("ignore", message="The value of the smallest subnormal")  # Meep computes with them as zero
import meep
import numpy

PROGRAM = sys.argv.pop(1)
EPSILON = [1, 2.25, 9.5]
SIZE, CELLS = (12, 8, 5), (24, 16, 10)


def box_obj(lo, hi):
    corners = [[(hi if i >> d & 1 else lo)[d] for d in range(3)] for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return "".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "".join("f " + " ".join(str(i + 1) for i in q) + "\n" for q in quads)


class Meep(unittest.TestCase):
    def test_permittivities_are_where_the_cells_are(self):
        folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, folder)
        (folder / "corner.obj").write_text(box_obj((0, 0, 0), (3, 2, 1.5)))  # in one corner, and no two sides alike
        (folder / "bar.obj").write_text(box_obj((2, 3, 2), (10, 5, 4)))
        (folder / "s.json").write_text(json.dumps({
            "grid": {"min": [0, 0, 0], "max": SIZE, "cells": CELLS}, "background": "air", "materials": {"air": {}, "teflon": {}, "glass": {}},
            "bodies": [{"mesh": "corner.obj", "material": "teflon"}, {"mesh": "bar.obj", "material": "glass"}]}))
        run = lambda *args: subprocess.run([PROGRAM, *map(str, args)], check=True, capture_output=True)
        run("mesh", folder / "s.json", "-o", folder / "g.tcell")
        run("export", folder / "g.tcell", "-o", folder / "g.npy")
        run("export", folder / "g.tcell", "-o", folder / "eps.h5", "--profile", "meep", "--epsilon", "air=1,teflon=2.25,glass=9.5")
        expected = numpy.array(EPSILON)[numpy.load(folder / "g.npy")].transpose()  # [x][y][z]
        self.assertEqual(expected.shape, CELLS)

        meep.verbosity(0)
        source = meep.Source(meep.GaussianSource(0.3, fwidth=0.2), component=meep.Ez, center=meep.Vector3(1, 1, 0))
        simulation = meep.Simulation(cell_size=meep.Vector3(*SIZE), resolution=4, epsilon_input_file=f"{folder / 'eps.h5'}:eps", eps_averaging=False,
                                     sources=[source])
        simulation.run(until=3)
        self.assertTrue(numpy.isfinite(simulation.get_array(component=meep.Ez)).all())
        self.assertGreater(numpy.abs(simulation.get_array(component=meep.Ez)).max(), 0)
        compared = {epsilon: 0 for epsilon in EPSILON}
        for x, y, z in numpy.ndindex(*[n - 2 for n in CELLS]):
            around = expected[x:x + 3, y:y + 3, z:z + 3]  # between cells Meep interpolates
            if around.min() != around.max():
                continue
            centre = [(i + 1.5) * SIZE[d] / CELLS[d] - SIZE[d] / 2 for d, i in enumerate((x, y, z))]
            self.assertAlmostEqual(simulation.get_epsilon_point(meep.Vector3(*centre)).real, around[1, 1, 1], places=6, msg=str((x, y, z)))
            compared[around[1, 1, 1]] += 1
        self.assertTrue(all(compared.values()), compared)


if __name__ == "__main__":
    unittest.main()

"""VTK and teem read what `teracell export` writes: cell by cell, and where the cells lie."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

PROGRAM = sys.argv.pop(1)


def run(*args):
    return subprocess.run([str(a) for a in args], check=True, capture_output=True).stdout


# A block in a corner, none of whose sides is like another, and one that lies across.
SCENE = {"units": "mm", "bodies": [{"name": "corner", "mesh": "corner.stl", "material": "steel"}, {"name": "bar", "mesh": "bar.stl", "material": "brass"}],
         "materials": {"air": {"color": "#00000000"}, "steel": {"color": "#8899aa"}, "brass": {"color": "#ccaa33"}}, "background": "air"}
UNIFORM = {"min": [-1, 2, 5], "max": [11, 10, 10], "cells": [24, 16, 10]}
GRADED = {**UNIFORM, "x": {"planes": [-1, -0.5, 0.25, 1, 2, 3, 4.5, 6, 8, 11]}}


def box_stl(path, lo, hi):
    corner = [[(hi if i >> d & 1 else lo)[d] for d in range(3)] for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    lines = ["solid box"]
    for a, b, c, d in quads:
        for triangle in ((a, b, c), (a, c, d)):
            lines += ["facet normal 0 0 0", "outer loop"] + ["vertex " + " ".join(map(str, corner[i])) for i in triangle] + ["endloop", "endfacet"]
    path.write_text("\n".join(lines + ["endsolid box"]) + "\n")


def setUpModule():
    global folder, grids
    folder = pathlib.Path(tempfile.mkdtemp())
    unittest.addModuleCleanup(shutil.rmtree, folder)
    box_stl(folder / "corner.stl", (-1, 2, 5), (2, 4, 6))
    box_stl(folder / "bar.stl", (1, 3, 7), (9, 4.6, 8.1))
    grids = []
    for name, axes in (("uniform", UNIFORM), ("graded", GRADED)):
        (folder / f"{name}.json").write_text(json.dumps({**SCENE, "grid": axes}))
        for axis in "xz":
            grids.append((name, folder / f"{name}-{axis}.tcell"))
            run(PROGRAM, "mesh", folder / f"{name}.json", "--axis", axis, "-o", grids[-1][1])


def exported(grid, name, *more):
    run(PROGRAM, "export", grid, "-o", folder / name, *more)
    return folder / name


class Vtk(unittest.TestCase):
    def read(self, reader, path):
        reader.SetFileName(str(path))
        reader.Update()
        data = reader.GetOutput()
        self.assertGreater(data.GetNumberOfCells(), 0)
        return data

    def cells(self, data):
        n = [max(1, k - 1) for k in data.GetDimensions()]
        return vtk_to_numpy(data.GetCellData().GetArray("material")).reshape(n[::-1])

    def test_every_cell_has_its_material_and_its_place(self):
        for kind, grid in grids:
            for more in ((), ("--region", "1,2,3,8,9,7"), ("--level", "1")):
                cells = numpy.load(exported(grid, "a.npy", *more))
                self.assertTrue({0, 2} <= set(numpy.unique(cells)) and (more or 1 in cells), "the test sees the materials")
                readers = [(vtk.vtkXMLRectilinearGridReader(), "a.vtr")]
                if kind == "uniform":
                    readers.append((vtk.vtkXMLImageDataReader(), "a.vti"))
                for reader, name in readers:
                    data = self.read(reader, exported(grid, name, *more))
                    numpy.testing.assert_array_equal(self.cells(data), cells)
                    names = data.GetFieldData().GetAbstractArray("materials")
                    self.assertEqual([names.GetValue(i) for i in range(names.GetNumberOfValues())], ["air", "steel", "brass"])
                    if not more:
                        self.assertEqual([round(b, 9) for b in data.GetBounds()], [-1, 11, 2, 10, 5, 10])
                    found = data.GetCell(data.GetNumberOfCells() - 1).GetBounds()
                    if not more:
                        self.assertEqual(round(found[1], 9), 11)

    def test_planes_are_those_of_the_scene(self):
        data = self.read(vtk.vtkXMLRectilinearGridReader(), exported(grids[2][1], "p.vtr"))
        self.assertEqual(vtk_to_numpy(data.GetXCoordinates()).tolist(), GRADED["x"]["planes"])
        self.assertEqual(vtk_to_numpy(data.GetYCoordinates()).tolist(), [2 + 0.5 * i for i in range(17)])

    def test_numbers_of_a_map(self):
        cells = numpy.load(exported(grids[0][1], "m.npy"))
        found = self.cells(self.read(vtk.vtkXMLImageDataReader(), exported(grids[0][1], "m.vti", "--map", "air=0,steel=700,brass=70000")))
        numpy.testing.assert_array_equal(found, numpy.array([0, 700, 70000])[cells])

    def test_a_graded_grid_is_refused_by_vti_and_nrrd(self):
        for name in ("g.vti", "g.nrrd"):
            said = subprocess.run([PROGRAM, "export", grids[2][1], "-o", folder / name], capture_output=True, text=True)
            self.assertEqual(said.returncode, 2)
            self.assertIn("vtr", said.stderr)


class Teem(unittest.TestCase):
    def test_unu_reads_cells_and_places(self):
        path = exported(grids[1][1], "t.nrrd")
        head = run("teem-unu", "head", path).decode()
        self.assertIn("sizes: 24 16 10", head)
        self.assertIn("space origin: (-0.75,2.25,5.25)", head)
        run("teem-unu", "save", "-f", "nrrd", "-e", "raw", "-i", path, "-o", folder / "u.nhdr")
        numpy.testing.assert_array_equal(numpy.fromfile(folder / "u.raw", numpy.uint8).reshape(10, 16, 24), numpy.load(exported(grids[1][1], "t.npy")))


if __name__ == "__main__":
    unittest.main()

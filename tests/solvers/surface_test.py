"""admesh and VTK read the surfaces that `teracell export` writes and find them closed, and meshing them gives the same cells back."""
import json
import re
import unittest

import numpy
import vtk

from support import PROGRAM, exported, folder, obj, read, run

GRADED = [-150, -149, -147, *range(-144, 90, 3), 90.5, *range(92, 151, 2)]


def scene_with(name, bodies, axes):
    scene = json.loads((folder / "stadium" / "scene.json").read_text())
    grid = {**scene["grid"], **axes}
    scene = {**scene, "grid": grid, "bodies": bodies or scene["bodies"]}
    (folder / "stadium" / name).write_text(json.dumps(scene))
    return folder / "stadium" / name


def setUpModule():
    global grids
    run(PROGRAM, "sample", "stadium", "-o", folder / "stadium")
    grids = []
    for name, axes in (("uniform", {"cells": [200, 160, 40]}), ("graded", {"cells": [100, 140, 50], "x": {"planes": GRADED}})):
        grids.append((folder / f"{name}.tcell", axes))
        run(PROGRAM, "mesh", scene_with("s.json", None, axes), "-o", grids[-1][0])


def edges(surface, kind):
    """How many edges of this kind VTK finds."""
    finder = vtk.vtkFeatureEdges()
    finder.SetInputData(surface)
    for each in ("Boundary", "Feature", "NonManifold", "Manifold"):
        getattr(finder, each + "EdgesOn" if each == kind else each + "EdgesOff")()
    finder.ColoringOff()
    finder.Update()
    return finder.GetOutput().GetNumberOfCells()


class Surfaces(unittest.TestCase):
    def test_admesh_finds_stl_closed_and_turned_outwards(self):
        for grid, _ in grids:
            for more in ((), ("--region", "3,20,2,80,90,30"), ("--level", "1"), ("--material", "structure"), ("--smooth", "4")):
                said = run("admesh", "--exact", exported(grid, "a.stl", *more))
                facets = int(re.search(r"Number of facets +: +(\d+)", said)[1])
                self.assertGreater(facets, 1000)
                self.assertRegex(said, r"Total disconnected facets +: +0 +0\n")
                for thing in ("Degenerate facets", "Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards edges", "Normals fixed"):
                    self.assertRegex(said, thing + r" +: +0\n", more)
                self.assertGreater(float(re.search(r"Volume +: +(\S+)", said)[1]), 0)

    def test_vtk_finds_no_open_edge_and_in_ply_no_fork(self):
        for grid, _ in grids:
            for more in ((), ("--material", "structure,grandstand"), ("--smooth", "4")):
                ply = read(vtk.vtkPLYReader(), exported(grid, "v.ply", *more))
                stl = read(vtk.vtkSTLReader(), exported(grid, "v.stl", *more))  # joins points that have the same coordinates
                self.assertEqual(ply.GetNumberOfCells(), stl.GetNumberOfCells())
                self.assertGreater(ply.GetNumberOfCells(), 0)
                self.assertEqual([edges(ply, "Boundary"), edges(ply, "NonManifold"), edges(stl, "Boundary")], [0, 0, 0], more)
                self.assertEqual(2 * edges(ply, "Manifold"), 3 * ply.GetNumberOfCells())
                if not more:
                    self.assertGreater(edges(stl, "NonManifold"), 0, "the test sees cells that touch along an edge alone")

    def test_the_volume_is_that_of_the_cells(self):
        grid, _ = grids[0]
        mass = vtk.vtkMassProperties()
        mass.SetInputData(read(vtk.vtkPLYReader(), exported(grid, "m.ply")))
        cells = numpy.load(exported(grid, "m.npy"))
        self.assertAlmostEqual(mass.GetVolume() / (numpy.count_nonzero(cells) * 1.5**3), 1, places=4)

    def test_a_cube_of_many_blocks_has_its_faces_and_no_more(self):
        """The block in its middle and those far from it are skipped."""
        (folder / "stadium" / "cube.obj").write_text(obj((0, 0, 0), (384, 384, 384)))
        scene = scene_with("cube.json", [{"name": "cube", "mesh": "cube.obj", "material": "structure"}], {"min": [0] * 3, "max": [640] * 3, "cells": [640] * 3})
        run(PROGRAM, "mesh", scene, "-o", folder / "cube.tcell")
        data = exported(folder / "cube.tcell", "cube.stl").read_bytes()
        facets = numpy.frombuffer(data[84:], numpy.dtype([("f", "<f4", (4, 3)), ("attribute", "<u2")]))["f"]
        self.assertEqual(len(facets), 6 * 2 * 384**2)
        a, b, c = (facets[:, i].astype(float) for i in (1, 2, 3))
        self.assertEqual(numpy.einsum("ij,ij", a, numpy.cross(b, c)) / 6, 384**3)
        header = exported(folder / "cube.tcell", "cube.ply").read_bytes()[:2000]
        self.assertIn(b"element vertex %d\n" % (385**3 - 383**3), header)

    def test_meshing_the_surface_gives_the_same_cells(self):
        for grid, axes in grids:
            cells = numpy.load(exported(grid, "c.npy"))
            for name, chosen, more in (("s.stl", cells != 0, ()), ("s.ply", cells != 0, ()), ("s.ply", cells == 2, ("--material", "grandstand")),
                                       ("s.ply", cells != 0, ("--smooth", "1")), ("s.stl", cells != 0, ("--smooth", "20"))):
                surface = exported(grid, name, *more)
                scene = scene_with("back.json", [{"name": "all", "mesh": str(surface), "material": "structure"}], axes)
                for axis in "xyz":
                    run(PROGRAM, "mesh", scene, "--axis", axis, "--closing", "strict", "-o", folder / "back.tcell")
                    back = numpy.load(exported(folder / "back.tcell", "back.npy"))
                    self.assertEqual(numpy.count_nonzero((back != 0) != chosen), 0, (name, more, axis))


if __name__ == "__main__":
    unittest.main()

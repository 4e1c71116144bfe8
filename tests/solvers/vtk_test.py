"""VTK and teem read what `teracell export` writes: cell by cell, and where the cells lie."""
import unittest

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from support import GRADED, exported, folder, metal_grids, mixed_metals, parts_of, read, refused, run

grids = metal_grids()


class Vtk(unittest.TestCase):
    def cells(self, data):
        n = [max(1, k - 1) for k in data.GetDimensions()]
        return vtk_to_numpy(data.GetCellData().GetArray("material")).reshape(n[::-1])

    def test_every_cell_has_its_material_and_its_place(self):
        for kind, grid, more, cells in parts_of(grids):
            readers = [(vtk.vtkXMLRectilinearGridReader(), "a.vtr")]
            if kind == "uniform":
                readers.append((vtk.vtkXMLImageDataReader(), "a.vti"))
            for reader, name in readers:
                data = read(reader, exported(grid, name, *more))
                numpy.testing.assert_array_equal(self.cells(data), cells)
                names = data.GetFieldData().GetAbstractArray("materials")
                self.assertEqual([names.GetValue(i) for i in range(names.GetNumberOfValues())], ["air", "steel", "brass"])
                if not more:
                    self.assertEqual([round(b, 9) for b in data.GetBounds()], [-1, 11, 2, 10, 5, 10])
                    self.assertEqual(round(data.GetCell(data.GetNumberOfCells() - 1).GetBounds()[1], 9), 11)

    def test_planes_are_those_of_the_scene(self):
        data = read(vtk.vtkXMLRectilinearGridReader(), exported(grids[2][1], "p.vtr"))
        self.assertEqual(vtk_to_numpy(data.GetXCoordinates()).tolist(), GRADED["x"]["planes"])
        self.assertEqual(vtk_to_numpy(data.GetYCoordinates()).tolist(), [2 + 0.5 * i for i in range(17)])

    def test_numbers_of_a_map(self):
        cells = numpy.load(exported(grids[0][1], "m.npy"))
        found = self.cells(read(vtk.vtkXMLImageDataReader(), exported(grids[0][1], "m.vti", "--map", "air=0,steel=700,brass=70000")))
        numpy.testing.assert_array_equal(found, numpy.array([0, 700, 70000])[cells])

    def test_shares_of_materials_in_mixed_cells(self):
        grid, shares = mixed_metals()
        self.assertGreater(len(numpy.unique(shares["brass"])), 2)
        for reader, name in ((vtk.vtkXMLRectilinearGridReader(), "s.vtr"), (vtk.vtkXMLImageDataReader(), "s.vti")):
            data = read(reader, exported(grid, name, "--fractions"))
            found = {data.GetCellData().GetArrayName(i) for i in range(data.GetCellData().GetNumberOfArrays())}
            self.assertEqual(found, {"material", "fraction of air", "fraction of steel", "fraction of brass"})
            for material, expected in {**shares, "air": 1 - shares["steel"] - shares["brass"]}.items():
                numpy.testing.assert_array_equal(vtk_to_numpy(data.GetCellData().GetArray(f"fraction of {material}")), expected.ravel().astype("f4"))
            numpy.testing.assert_array_equal(self.cells(data), numpy.load(exported(grid, "s.npy")))

    def test_a_graded_grid_is_refused_by_vti_and_nrrd(self):
        for name in ("g.vti", "g.nrrd"):
            self.assertIn("vtr", refused(grids[2][1], name))


class Teem(unittest.TestCase):
    def test_unu_reads_cells_and_places(self):
        path = exported(grids[1][1], "t.nrrd")
        head = run("teem-unu", "head", path)
        self.assertIn("sizes: 24 16 10", head)
        self.assertIn("space origin: (-0.75,2.25,5.25)", head)
        run("teem-unu", "save", "-f", "nrrd", "-e", "raw", "-i", path, "-o", folder / "u.nhdr")
        numpy.testing.assert_array_equal(numpy.fromfile(folder / "u.raw", numpy.uint8).reshape(10, 16, 24), numpy.load(exported(grids[1][1], "t.npy")))


if __name__ == "__main__":
    unittest.main()

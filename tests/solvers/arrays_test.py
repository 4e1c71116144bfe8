"""VTK reads MetaImage, and small readers read Palabos' text and raw cells by their header: cell by cell, and where the cells lie."""
import unittest

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from support import GRADED, PARTS, UNIFORM, exported, folder, metal_grids, parts_of, read, refused

grids = metal_grids()
NAMES = ["air", "steel", "brass"]


def header_of(path):
    lines = path.with_name(path.name + ".txt").read_text().splitlines()
    return dict(line.split(": ", 1) for line in lines if not line.startswith("#"))


def planes_of(header, axis, cells):
    if f"{axis} planes" in header:
        return [float(p) for p in header[f"{axis} planes"].split()]
    return [float(header[f"{axis} first plane"]) + float(header[f"{axis} step"]) * i for i in range(cells + 1)]


class MetaImage(unittest.TestCase):
    def test_vtk_reads_every_cell_and_its_place(self):
        for _, grid, more, cells in parts_of(grids[:2]):
            for name in ("a.mhd", "a.mha"):
                image = read(vtk.vtkMetaImageReader(), exported(grid, name, *more))
                self.assertEqual(image.GetDimensions(), cells.shape[::-1])
                numpy.testing.assert_array_equal(vtk_to_numpy(image.GetPointData().GetScalars()).reshape(cells.shape), cells)
                first = {(): (0, 0, 0), PARTS[1]: (1, 2, 3), PARTS[2]: (0, 0, 0)}[more]
                step = 1.0 if more == PARTS[2] else 0.5
                self.assertEqual(image.GetSpacing(), (step,) * 3)
                self.assertEqual(image.GetOrigin(), tuple(UNIFORM["min"][d] + (first[d] + 0.5) * step for d in range(3)))

    def test_numbers_of_all_sizes(self):
        cells = numpy.load(exported(grids[0][1], "m.npy"))
        for steel, kind in ((255, numpy.uint8), (256, numpy.uint16), (70000, numpy.uint32)):
            image = read(vtk.vtkMetaImageReader(), exported(grids[0][1], "m.mhd", "--map", f"air=1,steel={steel},brass=0"))
            found = vtk_to_numpy(image.GetPointData().GetScalars())
            self.assertEqual(found.dtype, kind)
            numpy.testing.assert_array_equal(found.reshape(cells.shape), numpy.array([1, steel, 0])[cells])

    def test_a_graded_grid_is_refused(self):
        for name in ("g.mhd", "g.mha"):
            path = folder / name
            self.assertIn("mhd has uniform axes", refused(grids[2][1], name))
            self.assertFalse(path.exists() or path.with_suffix(".raw").exists())


class Headers(unittest.TestCase):
    def check(self, header, grid, kind, more):
        cells = numpy.load(exported(grid, "h.npy", *more))
        self.assertEqual([int(n) for n in header["sizes"].split()], list(cells.shape[::-1]))
        self.assertEqual([header[f"material {i}"] for i in range(3)], NAMES)
        self.assertEqual(header["units"], "mm")
        if not more:
            expected = GRADED["x"]["planes"] if kind == "graded" else [-1 + 0.5 * i for i in range(25)]
            self.assertEqual(planes_of(header, "x", cells.shape[2]), expected)
            self.assertEqual(planes_of(header, "z", cells.shape[0]), [5 + 0.5 * i for i in range(11)])
        return cells

    def test_raw_cells_are_read_by_their_header_alone(self):
        for kind, grid in grids:
            for more in PARTS:
                path = exported(grid, "h.raw", "--header", *more)
                header = header_of(path)
                self.assertEqual((header["file"], header["type"], header["order"]), ("h.raw", "uint8", "x fastest, z slowest"))
                found = numpy.fromfile(path, header["type"]).reshape([int(n) for n in header["sizes"].split()][::-1])
                numpy.testing.assert_array_equal(found, self.check(header, grid, kind, more))

    def test_palabos_reads_x_slowest(self):
        for kind, grid in grids:
            for more in PARTS:
                path = exported(grid, "h.dat", "--header", *more)
                header = header_of(path)
                cells = self.check(header, grid, kind, more)
                numbers = iter(path.read_text().split())  # as Palabos: for iX, for iY, for iZ: file >> value
                nx, ny, nz = (int(n) for n in header["sizes"].split())
                found = numpy.array([[[int(next(numbers)) for _ in range(nz)] for _ in range(ny)] for _ in range(nx)])
                self.assertIsNone(next(numbers, None))
                numpy.testing.assert_array_equal(found, cells.transpose(2, 1, 0))


if __name__ == "__main__":
    unittest.main()

"""openEMS runs on the boxes that `teracell export --format openems` writes, and has the materials where the cells are."""
import subprocess
import unittest

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from support import dielectric_grid, exported, folder, read

EPSILON, KAPPA = [1, 2.25, 9.5], [0, 0, 0.25]
X = [0, 0.5, 1.25, 2, 3, 3.5, 4.5, 6, 8, 10, 11, 12]
# What is the user's: an excitation, so that something happens, and a field that is written.
OURS = """      <Excitation Name="e" Type="0" Excite="0,1,0"><Primitives><Box Priority="9"><P1 X="4.5" Y="6" Z="1"/><P2 X="4.5" Y="7" Z="1"/></Box></Primitives></Excitation>
      <DumpBox Name="Et" DumpType="0" DumpMode="0" FileType="0"><Primitives><Box Priority="0"><P1 X="0" Y="0" Z="0"/><P2 X="12" Y="8" Z="5"/></Box></Primitives></DumpBox>
    </Properties>"""


class OpenEms(unittest.TestCase):
    def compute(self, grid, *media):
        xml = exported(grid, "g.xml", "--format", "openems", *media).read_text()
        for old, new in (('NumberOfTimesteps="0"', 'NumberOfTimesteps="30"'), ('f0="0" fc="0"', 'f0="1e10" fc="1e10"'), ("    </Properties>", OURS)):
            self.assertEqual(xml.count(old), 1)
            xml = xml.replace(old, new)
        (folder / "run.xml").write_text(xml)
        said = subprocess.run(["openEMS", "run.xml", "--engine=basic", "--debug-material", "--debug-PEC"], cwd=folder, capture_output=True, text=True)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        self.assertIn("Time for 30 iterations", said.stdout)
        self.assertNotIn("Unused primitive", said.stderr)

    def test_materials_are_where_the_cells_are(self):
        for axes in ({}, {"x": {"planes": X}}):
            grid = dielectric_grid(**axes)
            self.compute(grid, "--epsilon", "teflon=2.25,glass=9.5", "--sigma", "glass=0.25")
            data = read(vtk.vtkXMLRectilinearGridReader(), folder / "material_dump.vtr")
            planes = [vtk_to_numpy(c) * 1000 for c in (data.GetZCoordinates(), data.GetYCoordinates(), data.GetXCoordinates())]
            numpy.testing.assert_allclose(planes[2], axes.get("x", {"planes": [i / 2 for i in range(25)]})["planes"])
            cells = numpy.load(exported(grid, "g.npy"))
            for name, values in (("epsilon", EPSILON), ("kappa", KAPPA)):
                found = vtk_to_numpy(data.GetPointData().GetArray(name)).reshape(*[p.size for p in planes], 3)
                for axis in range(3):  # of the array: z, y, x. An edge has the mean of the four cells around it, by their areas.
                    expected = numpy.array(values)[cells]
                    inner = [slice(1, -1)] * 3  # not the border, around which there are no four cells
                    inner[axis] = slice(0, -1)
                    for across in {0, 1, 2} - {axis}:
                        shape = [-1 if d == across else 1 for d in range(3)]
                        width = numpy.diff(planes[across]).reshape(shape)
                        below, above = range(cells.shape[across] - 1), range(1, cells.shape[across])
                        sums = (expected * width).take(below, across) + (expected * width).take(above, across)
                        expected = sums / (width.take(below, across) + width.take(above, across))
                    numpy.testing.assert_allclose(found[(*inner, 2 - axis)], expected, rtol=1e-6)
                self.assertEqual({round(float(v), 9) for v in numpy.unique(found)} & set(values), set(values), "the test sees the materials")
            field = read(vtk.vtkXMLRectilinearGridReader(), sorted(folder.glob("Et_*.vtr"))[-1])
            field = vtk_to_numpy(field.GetPointData().GetArray(0))
            self.assertTrue(numpy.isfinite(field).all())
            self.assertGreater(numpy.abs(field).max(), 0)

    def test_perfect_conductors(self):
        self.compute(dielectric_grid(), "--epsilon", "teflon=2.25,glass=1", "--sigma", "glass=inf")
        data = read(vtk.vtkXMLPolyDataReader(), folder / "PEC_dump.vtp")
        points = vtk_to_numpy(data.GetPoints().GetData()) * 1000
        inside = ((points > 0) & (points < [12, 8, 5])).all(axis=1)  # the border of the domain conducts as well
        numpy.testing.assert_allclose([points[inside].min(0), points[inside].max(0)], [[2, 3, 2], [10, 5, 4]], rtol=1e-5)


if __name__ == "__main__":
    unittest.main()

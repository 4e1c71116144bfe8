"""openEMS runs on the boxes that `teracell export --format openems` writes, and has the materials where the cells are."""
import json
import re
import subprocess
import unittest

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from support import PROGRAM, dielectric_grid, exported, folder, obj, read, run

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


# A patch antenna of 32 by 40 mm on 1.6 mm of FR4, above a perfect ground.
HEIGHT, PATCH, SUBSTRATE = 1.6, (16, 20), 30
PORT = f"""      <Excitation Name="e" Type="0" Excite="0,0,1"><Primitives><Box Priority="9"><P1 X="-6" Y="0" Z="0"/><P2 X="-6" Y="0" Z="{HEIGHT}"/></Box></Primitives></Excitation>
      <LumpedElement Name="r" Direction="2" Caps="0" R="50"><Primitives><Box Priority="9"><P1 X="-6" Y="0" Z="0"/><P2 X="-6" Y="0" Z="{HEIGHT}"/></Box></Primitives></LumpedElement>
      <ProbeBox Name="voltage" Type="0" Weight="-1"><Primitives><Box Priority="0"><P1 X="-14" Y="0" Z="0"/><P2 X="-14" Y="0" Z="{HEIGHT}"/></Box></Primitives></ProbeBox>
    </Properties>"""


def lines(*stretches):
    """Planes by hand: (from, to, first width, last width) each, widths growing by at most 1.3 towards the middle, up to 5."""
    out = set()
    for lo, hi, first, last in stretches:
        up, down = [0.0], [0.0]
        while up[-1] + down[-1] < hi - lo:
            side = up if first <= last else down
            side.append(side[-1] + (first if side is up else last))
            first, last = (min(1.3 * first, 5), last) if side is up else (first, min(1.3 * last, 5))
        scale = (hi - lo) / (up[-1] + down[-1])
        out |= {round(lo + scale * x, 9) for x in up} | {round(hi - scale * x, 9) for x in down}
    return sorted(out)


def by_hand():
    """The same antenna by CSXCAD's primitives, with lines as people place them: thirds at the edges of the metal."""
    third = 0.4
    across = [lines((-80, -30, 5, 1.2), (-30, -e - 2 * third, 1.2, 0.8), (-e - 2 * third, -e + third, 1.2, 1.2), (-e + third, feed, 0.8, 0.8),
                    (feed, e - third, 0.8, 0.8), (e - third, e + 2 * third, 1.2, 1.2), (e + 2 * third, 30, 0.8, 1.2), (30, 80, 1.2, 5))
              for e, feed in ((PATCH[0], -6), (PATCH[1], 0))]
    up = sorted({0, 0.4, 0.8, 1.2, *lines((HEIGHT, 60, 0.5, 5))})
    grid = "".join(f"<{name}Lines>{','.join(map(str, of))}</{name}Lines>" for name, of in zip("XYZ", (*across, up)))
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<openEMS><FDTD NumberOfTimesteps="0" endCriteria="1e-5"><Excitation Type="0" f0="0" fc="0"/><BoundaryCond xmin="0"/></FDTD>
  <ContinuousStructure CoordSystem="0"><RectilinearGrid DeltaUnit="0.001" CoordSystem="0">{grid}</RectilinearGrid>
    <Properties>
      <Material Name="fr4"><Property Epsilon="4.3"/><Primitives><Box Priority="0"><P1 X="-30" Y="-30" Z="0"/><P2 X="30" Y="30" Z="{HEIGHT}"/></Box></Primitives></Material>
      <Metal Name="patch"><Primitives><Box Priority="10"><P1 X="-16" Y="-20" Z="{HEIGHT}"/><P2 X="16" Y="20" Z="{HEIGHT}"/></Box></Primitives></Metal>
    </Properties></ContinuousStructure></openEMS>"""


class MadePlanes(unittest.TestCase):
    def resonance(self, name, xml):
        """In GHz: where the spectrum of the voltage below the patch, once the pulse is over, has its peak."""
        xml = re.sub(r'NumberOfTimesteps="\d+"', 'NumberOfTimesteps="12000"', xml)
        xml = re.sub(r'f0="0" fc="0"', 'f0="2.2e9" fc="1e9"', xml)
        xml = re.sub(r"<BoundaryCond[^>]*/>", '<BoundaryCond xmin="2" xmax="2" ymin="2" ymax="2" zmin="0" zmax="2"/>', xml)
        here = folder / name
        here.mkdir()
        (here / "run.xml").write_text(xml.replace("    </Properties>", PORT, 1))
        said = subprocess.run(["openEMS", "run.xml", "--engine=multithreaded"], cwd=here, capture_output=True, text=True)
        self.assertEqual(said.returncode, 0, said.stdout + said.stderr)
        t, voltage = numpy.loadtxt(here / "voltage", comments="%").T
        late = slice(len(t) // 6, None)
        frequency = numpy.linspace(1.5e9, 3e9, 1501)
        spectrum = numpy.exp(-2j * numpy.pi * numpy.outer(frequency, t[late])) @ (voltage[late] * numpy.hanning(len(t[late])))
        return frequency[numpy.abs(spectrum).argmax()] / 1e9

    def test_a_patch_antenna_resonates_as_it_does_with_lines_by_hand(self):
        """Its own surface: 35 um of copper, of which the cells above the substrate are."""
        (folder / "fr4.obj").write_text(obj((-SUBSTRATE, -SUBSTRATE, 0), (SUBSTRATE, SUBSTRATE, HEIGHT)))
        (folder / "patch.obj").write_text(obj((-PATCH[0], -PATCH[1], HEIGHT), (*PATCH, HEIGHT + 0.035)))
        auto = {"finest": 0.4, "coarsest": 5, "growth": 1.4, "snap": "thirds", "metals": ["copper"], "resolution": {"fr4": {"across": 4}},
                "fixed": {"x": [-6], "y": [0]}}
        scene = {"units": "mm", "grid": {"auto": auto, "min": [-80, -80, 0], "max": [80, 80, 60]}, "materials": {"air": {}, "fr4": {}, "copper": {}},
                 "bodies": [{"name": "substrate", "mesh": "fr4.obj", "material": "fr4"},
                            {"name": "patch", "mesh": "patch.obj", "material": "copper", "priority": 1, "thin": "keep"}]}
        (folder / "patch.json").write_text(json.dumps(scene))
        run(PROGRAM, "mesh", folder / "patch.json", "-o", folder / "patch.tcell")
        planes = json.loads(run(PROGRAM, "info", folder / "patch.tcell", "--json"))["planes"]
        self.assertEqual(planes["breaches"], [])
        xml = exported(folder / "patch.tcell", "patch.xml", "--format", "openems", "--epsilon", "fr4=4.3,copper=1", "--sigma", "copper=inf").read_text()
        made, hand = self.resonance("made", xml), self.resonance("hand", by_hand())
        self.assertTrue(2.0 < hand < 2.35, hand)
        self.assertLess(abs(made / hand - 1), 0.02, (made, hand))


if __name__ == "__main__":
    unittest.main()

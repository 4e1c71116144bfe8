"""OpenFOAM checks meshes of `teracell export --format openfoam`, and computes on them: the same on ranks as alone."""
import itertools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy

from support import PROGRAM, obj

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools/examples/blast"))
from foam import HEADER, SCHEMES, SOLUTION, THERMO  # noqa: E402

# Warm on one side, cold at the block; nothing passes elsewhere.
TEMPERATURE = """dimensions [0 0 0 1 0 0 0]; internalField uniform 300;
boundaryField { ".*" { type zeroGradient; } "procBoundary.*" { type processor; value uniform 300; }
xmin { type fixedValue; value uniform 400; } copper { type fixedValue; value uniform 250; } }
"""
GAS = {
    "constant/thermophysicalProperties": THERMO,
    "constant/turbulenceProperties": "simulationType laminar;",
    "system/controlDict": "application rhoCentralFoam; startFrom startTime; startTime 0; stopAt endTime; endTime 4e-5; deltaT 5e-7; writeControl timeStep;"
                          "writeInterval 80; writeFormat ascii; writePrecision 14; timePrecision 6; adjustTimeStep no;",
    "system/fvSchemes": SCHEMES,
    "system/fvSolution": SOLUTION,
}
PLANES = {"x": [0.2 * i + 0.01 * i * i for i in range(25)], "y": [0.5 * i for i in range(19)], "z": [0.3 * i for i in range(17)]}
BOXES = [("copper", (4.9, 0, 0), (10.6, 3.2, 1.4)),   # in a corner, and across each axis of another size
         ("steel", (2.1, 5.2, 1.6), (4.2, 7.8, 3.9)),   # a casing ...
         ("air", (2.8, 6.1, 2.2), (3.6, 7.1, 3.1))]     # ... around air that nothing reaches


def values(path, width=1):
    """The numbers of a field's cells."""
    text = pathlib.Path(path).read_text()
    found = re.search(r"internalField\s+nonuniform List<\w+>\s+(\d+)\s*\(", text)
    numbers = text[found.end():text.index("boundaryField")].translate(str.maketrans("();", "   ")).split()
    result = numpy.array(numbers, dtype=float)
    assert len(result) == int(found[1]) * width
    return result.reshape(-1, width) if width > 1 else result


class OpenFoam(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="teracell-openfoam-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        for i, (_, lo, hi) in enumerate(BOXES):
            self.write(f"{i}.obj", obj(lo, hi))
        bodies = [{"name": f"body{i}", "mesh": f"{i}.obj", "material": material} for i, (material, _, _) in enumerate(BOXES)]
        grid = {axis: {"planes": planes} for axis, planes in PLANES.items()}
        self.write("scene.json", json.dumps({"units": "cm", "grid": grid, "materials": {"air": {}, "copper": {}, "steel": {}}, "bodies": bodies}))
        self.teracell("mesh", "scene.json", "-o", "g.tcell")
        self.teracell("export", "g.tcell", "-o", "g.npy")
        self.cells = numpy.load(os.path.join(self.folder, "g.npy"))
        self.assertEqual(set(self.cells.flat), {0, 1, 2})

    def write(self, name, text):
        path = pathlib.Path(self.folder, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def run_ok(self, *command):
        done = subprocess.run(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, f"{' '.join(command)}:\n{done.stdout[-4000:]}")
        return done.stdout

    def teracell(self, *args):
        return self.run_ok(str(PROGRAM), *args)

    def foam(self, case, *command, ranks=1):
        environment = "source /usr/share/openfoam/etc/bashrc >/dev/null 2>&1; export WM_PROJECT_DIR=/usr/share/openfoam"
        mpi = "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; exec mpirun --oversubscribe -np %d" % ranks if ranks > 1 else "exec"
        parallel = ["-parallel"] if ranks > 1 else []
        return self.run_ok("bash", "-c", f'{environment}; {mpi} "$@"', "foam", *command, "-case", case, *parallel)

    def test_what_the_page_of_formats_shows_runs_at_once(self):
        page = (pathlib.Path(__file__).resolve().parents[2] / "tools/export/EXPORTS.md").read_text()
        export, fields = re.search(r"^## OpenFOAM\n.*?^```\n(.*?)^```.*?^```\n(.*?)^```", page, re.S | re.M).groups()
        environment = "source /usr/share/openfoam/etc/bashrc >/dev/null 2>&1; export WM_PROJECT_DIR=/usr/share/openfoam"
        commands = f"{environment}; teracell() {{ '{PROGRAM}' \"$@\"; }}; set -e\n{export}\n{fields}"
        said = self.run_ok("bash", "-c", commands)
        self.assertIn("case: system/controlDict, system/fvSchemes, system/fvSolution are written", said)
        self.assertIn("Mesh OK", said)
        temperatures = values(os.path.join(self.folder, "case", "1", "T"))
        self.assertTrue(300 < temperatures.max() <= 400 and temperatures.min() >= 300 - 1e-6, temperatures)

    def test_other_first_solvers_run_with_the_same_dictionaries(self):
        case = self.case("first", "--drop-unreachable")
        self.write(f"{case}/0/U", HEADER.format("volVectorField", "U") + "dimensions [0 1 -1 0 0 0 0]; internalField uniform (0 0 0); boundaryField {"
                   '".*" { type slip; } xmin { type fixedValue; value uniform (1 0 0); } xmax { type zeroGradient; } }')
        self.write(f"{case}/0/p", HEADER.format("volScalarField", "p") + "dimensions [0 2 -2 0 0 0 0]; internalField uniform 0; boundaryField {"
                   '".*" { type zeroGradient; } xmax { type fixedValue; value uniform 0; } }')
        self.write(f"{case}/constant/transportProperties", HEADER.format("dictionary", "transportProperties") + "DT [0 2 -1 0 0 0 0] 1e-3; nu [0 2 -1 0 0 0 0] 1e-3;")
        for solver in ("potentialFoam", "scalarTransportFoam", "icoFoam"):
            self.assertIn("\nEnd\n", self.foam(case, solver))

    def case(self, name, *options, ranks=1):
        """A case with a mesh for one rank, and one for several."""
        self.write(f"{name}/constant/transportProperties", HEADER.format("dictionary", "transportProperties") + "DT [0 2 -1 0 0 0 0] 5e-6;")
        self.write(f"{name}/0/T", HEADER.format("volScalarField", "T") + TEMPERATURE)
        self.teracell("export", "g.tcell", "--format", "openfoam", "-o", name, *options)
        if ranks > 1:
            self.teracell("export", "g.tcell", "--format", "openfoam", "-o", name, *options, "--ranks", str(ranks))
            for rank in range(ranks):
                self.write(f"{name}/processor{rank}/0/T", HEADER.format("volScalarField", "T") + TEMPERATURE)
        return name

    def expect_mesh(self, text, cells, regions=1):
        self.assertEqual(int(re.search(r"^\s*cells:\s+(\d+)", text, re.M)[1]), cells)
        self.assertEqual(int(re.search(r"^\s*hexahedra:\s+(\d+)", text, re.M)[1]), cells)
        found = re.search(r"Number of regions: (\d+)", text)
        self.assertEqual(int(found[1]), regions)
        self.assertNotIn("***", text)
        if regions == 1:
            self.assertIn("\nMesh OK.", text)

    def test_a_mesh_of_the_background_is_sound(self):
        air = int((self.cells == 0).sum())
        text = self.foam(self.case("whole", ranks=3), "checkMesh")
        self.assertEqual(int(re.search(r"Number of regions: (\d+)", text)[1]), 2)  # the casing's inside is one
        self.assertEqual(int(re.search(r"^\s*cells:\s+(\d+)", text, re.M)[1]), air)

    def test_without_the_unreachable_it_is_one_region_alone_and_on_ranks(self):
        cavity = (self.cells == 2)
        z, y, x = numpy.nonzero(cavity)
        inner = (self.cells[z.min():z.max() + 1, y.min():y.max() + 1, x.min():x.max() + 1] == 0).sum()
        self.assertGreater(inner, 0)
        reached = int((self.cells == 0).sum() - inner)
        case = self.case("reached", "--drop-unreachable", ranks=3)
        self.expect_mesh(self.foam(case, "checkMesh", "-allTopology", "-allGeometry"), reached)
        self.expect_mesh(self.foam(case, "checkMesh", "-allTopology", "-allGeometry", ranks=3), reached)

    def test_cells_lie_where_the_grid_has_them(self):
        case = self.case("centres")
        self.foam(case, "postProcess", "-func", "writeCellCentres", "-time", "0")
        axes = [0.01 * (numpy.array(p[1:]) + numpy.array(p[:-1])) / 2 for p in (PLANES["x"], PLANES["y"], PLANES["z"])]
        z, y, x = numpy.nonzero(self.cells == 0)  # x fastest
        numpy.testing.assert_allclose(values(os.path.join(self.folder, case, "0", "C"), 3), numpy.stack([axes[0][x], axes[1][y], axes[2][z]], axis=1), rtol=1e-9)

    def test_zones_are_the_materials(self):
        case = self.case("zones", "--zones", ranks=4)
        for ranks in (1, 4):
            text = self.foam(case, "checkMesh", ranks=ranks)
            self.expect_mesh(text, self.cells.size)
            for number, material in enumerate(("air", "copper", "steel")):
                self.assertEqual(int(re.search(rf"^\s*{material}\s+(\d+)", text, re.M)[1]), int((self.cells == number).sum()), (ranks, material))

    def test_walls_are_patches_of_the_surface_alone_and_on_ranks(self):
        numbers = itertools.count()
        text = pathlib.Path(self.folder, "0.obj").read_text()
        self.write("0.obj", re.sub("^f ", lambda _: f"g side{next(numbers)}\nf ", text, flags=re.M))
        self.teracell("mesh", "scene.json", "-o", "g.tcell", "--links")
        air = int((self.cells == 0).sum())
        for ranks in (1, 3):
            text = self.foam(self.case("patches", "--patches", ranks=3) if ranks == 1 else "patches", "checkMesh", "-allTopology", "-allGeometry", ranks=ranks)
            self.expect_mesh(text, air, regions=2 if ranks == 1 else int(re.search(r"Number of regions: (\d+)", text)[1]))
        boundary = pathlib.Path(self.folder, "patches/constant/polyMesh/boundary").read_text()
        names = re.findall(r"^    (\w+)\n    {", boundary, re.M)
        self.assertTrue({"xmin", "xmax", "ymin", "ymax", "zmin", "zmax", "body1", "body2"} < set(names), names)
        self.assertGreaterEqual(sum(name.startswith("side") for name in names), 3)
        self.assertNotIn("copper", names)

    def test_a_solver_computes_the_same_on_ranks_as_alone(self):
        alone = self.case("alone", "--drop-unreachable")
        self.foam(alone, "laplacianFoam")
        expected = values(os.path.join(self.folder, alone, "1", "T"))
        self.assertGreater(expected.max() - expected.min(), 50)
        ranks = self.case("ranks", "--drop-unreachable", ranks=3)
        self.foam(ranks, "laplacianFoam", ranks=3)
        self.foam(ranks, "reconstructPar")
        numpy.testing.assert_allclose(values(os.path.join(self.folder, ranks, "1", "T")), expected, rtol=1e-7)

    def write_gas(self, folder, pressures):
        """Gas at rest with a pressure for each cell, between slip walls."""
        listed = f"nonuniform List<scalar> {len(pressures)} (" + " ".join(map(repr, pressures.tolist())) + ")"
        for name, kind, dimensions, inside, walls in (("p", "volScalarField", "[1 -1 -2 0 0 0 0]", listed, "zeroGradient"),
                                                      ("T", "volScalarField", "[0 0 0 1 0 0 0]", "uniform 300", "zeroGradient"),
                                                      ("U", "volVectorField", "[0 1 -1 0 0 0 0]", "uniform (0 0 0)", "slip")):
            self.write(f"{folder}/0/{name}", HEADER.format(kind, name) + f"dimensions {dimensions}; internalField {inside}; boundaryField {{"
                       f'".*" {{ type {walls}; }} }}')

    def test_a_charge_bursts_the_same_on_ranks_as_alone_and_no_gas_is_lost(self):
        air, middle = self.cells == 0, [numpy.array(p[1:]) / 2 + numpy.array(p[:-1]) / 2 for p in PLANES.values()]
        z, y, x = numpy.nonzero(air)  # the order of cells
        far = (middle[0][x] - 5.5) ** 2 + (middle[1][y] - 4.2) ** 2 + (middle[2][z] - 2.3) ** 2
        pressures = numpy.where(far < 1.0, 5e6, 1e5)
        self.assertGreater((pressures > 1e5).sum(), 20)
        cases = {ranks: self.case(f"gas{ranks}", ranks=ranks) for ranks in (1, 3)}
        for ranks, case in cases.items():
            for file, text in GAS.items():
                self.write(f"{case}/{file}", HEADER.format("dictionary", file.split("/")[1]) + text)
            self.write_gas(case, pressures)
            if ranks > 1:
                shutil.rmtree(os.path.join(self.folder, case, "processor0", "0"))  # decomposePar must have made it
                self.foam(case, "decomposePar", "-fields")  # by the numbers that the parts have in the whole mesh
            self.foam(case, "rhoCentralFoam", ranks=ranks)
            if ranks > 1:
                self.foam(case, "reconstructPar")
        result = {ranks: {name: values(os.path.join(self.folder, case, "4e-05", name)) for name in ("p", "rho")} for ranks, case in cases.items()}
        for name, field in result[1].items():
            numpy.testing.assert_allclose(result[3][name], field, rtol=1e-9)
        widths = [numpy.diff(p) for p in PLANES.values()]
        volume = widths[0][x] * widths[1][y] * widths[2][z]
        before = (pressures * volume).sum() / (8314.47 / 28.96 * 300)
        self.assertAlmostEqual((result[1]["rho"] * volume).sum() / before, 1, places=4)  # OpenFOAM's gas constant has more digits
        moved = numpy.abs(result[1]["p"] / pressures - 1) > 0.01
        self.assertGreater(moved.sum(), 4 * (far < 1.0).sum())


if __name__ == "__main__":
    unittest.main()

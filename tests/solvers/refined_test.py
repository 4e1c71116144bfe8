"""What p4est, VTK and OpenFOAM make of refined grids."""
import json
import math
import pathlib
import re
import shutil
import subprocess
import unittest

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from support import PROGRAM, folder, run

HEADER = "FoamFile {{ version 2.0; format ascii; class {}; object {}; }}\n"
SNAP = """castellatedMesh false; snap true; addLayers false;
geometry { ball.obj { type triSurfaceMesh; name ball; } }
castellatedMeshControls { maxLocalCells 1000000; maxGlobalCells 1000000; minRefinementCells 0; nCellsBetweenLevels 2; features ();
  refinementSurfaces { ball { level (0 0); } } resolveFeatureAngle 30; refinementRegions {} locationInMesh (0.5 0.5 0.5); allowFreeStandingZoneFaces true; }
snapControls { nSmoothPatch 3; tolerance 2.0; nSolveIter 30; nRelaxIter 5; }
addLayersControls { relativeSizes true; layers {} expansionRatio 1.0; finalLayerThickness 0.3; minThickness 0.1; nGrow 0; featureAngle 60; nRelaxIter 3;
  nSmoothSurfaceNormals 1; nSmoothNormals 3; nSmoothThickness 10; maxFaceThicknessRatio 0.5; maxThicknessToMedialRatio 0.3; minMedianAxisAngle 90;
  nBufferCellsNoExtrude 0; nLayerIter 50; }
meshQualityControls { maxNonOrtho 65; maxBoundarySkewness 20; maxInternalSkewness 4; maxConcave 80; minVol 1e-13; minTetQuality 1e-15; minArea -1;
  minTwist 0.02; minDeterminant 0.001; minFaceWeight 0.05; minVolRatio 0.01; minTriangleTwist -1; nSmoothScale 4; errorReduction 0.75; }
mergeTolerance 1e-6;
"""


def ball(centre, radius, rings=24):
    """A closed ball as OBJ."""
    points = [(0, 0, radius)]
    for i in range(1, rings):
        for j in range(2 * rings):
            a, b = math.pi * i / rings, math.pi * j / rings
            points.append((radius * math.sin(a) * math.cos(b), radius * math.sin(a) * math.sin(b), radius * math.cos(a)))
    points.append((0, 0, -radius))
    at = lambda i, j: 1 if i == 0 else len(points) if i == rings else 2 + (i - 1) * 2 * rings + j % (2 * rings)  # noqa: E731
    faces = [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for i in range(rings) for j in range(2 * rings)]
    return "".join(f"v {x + centre[0]} {y + centre[1]} {z + centre[2]}\n" for x, y, z in points) + \
        "".join("f " + " ".join(str(p) for p in dict.fromkeys(face)) + "\n" for face in faces)


def foam(case, *command, ranks=1):
    environment = "source /usr/share/openfoam/etc/bashrc >/dev/null 2>&1; export WM_PROJECT_DIR=/usr/share/openfoam"
    mpi = "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; exec mpirun --oversubscribe -np %d" % ranks if ranks > 1 else "exec"
    parallel = ["-parallel"] if ranks > 1 else []
    return run("bash", "-c", f'{environment}; {mpi} "$@"', "foam", *command, "-case", case, *parallel)


class Refined(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        (folder / "ball.obj").write_text(ball((3.1, 4.2, 3.6), 2.3))
        bodies = [{"name": "ball", "mesh": "ball.obj", "material": "lead"}]
        graded = [0.1 * i + 0.0005 * i * i for i in range(81)]
        for name, grid in (("cube", {"min": [0, 0, 0], "max": [8, 8, 8], "cells": [64, 64, 64]}),
                           ("brick", {"min": [0, 0, 0], "max": [12, 8, 8], "cells": [96, 64, 64]}),
                           ("graded", {"x": {"planes": graded}, "y": {"min": 0, "max": 8, "cells": 61}, "z": {"min": 0, "max": 8, "cells": 64}})):
            scene = {"units": "m", "grid": grid, "materials": {"air": {}, "lead": {}}, "bodies": bodies}
            (folder / f"{name}.json").write_text(json.dumps(scene))
            run(PROGRAM, "mesh", folder / f"{name}.json", "-o", folder / f"{name}.tcell")

    def leaves(self, name, *options):
        run(PROGRAM, "export", folder / f"{name}.tcell", "--format", "leaves", "-o", folder / "leaves.npy", *options)
        return numpy.load(folder / "leaves.npy")

    def test_p4est_builds_the_same_forest_and_calls_it_balanced(self):
        program = folder / "p4est_forest"
        run("mpicc", "-O1", pathlib.Path(__file__).with_suffix("").parent / "p4est_forest.c", "-o", program, "-lp4est", "-lsc")
        for name, coarsest, roots in (("cube", 6, (1, 1, 1)), ("cube", 3, (8, 8, 8)), ("brick", 5, (3, 2, 2))):
            leaves = self.leaves(name, "--refine", f"{coarsest},1")
            text = "\n".join([f"{coarsest} {roots[0]} {roots[1]} {roots[2]}", *(" ".join(map(str, leaf.tolist()[:4])) for leaf in leaves)])
            done = subprocess.run([program], input=text, capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (0, f"{len(leaves)} leaves\n"), (name, coarsest, done.stderr))
            self.assertGreater(len(set(leaves["level"])), 3)

    def test_vtk_reads_cells_levels_and_materials(self):
        for name in ("cube", "graded"):
            run(PROGRAM, "export", folder / f"{name}.tcell", "--refine", "4,2", "-o", folder / "leaves.vtu")
            leaves = self.leaves(name, "--refine", "4,2")
            reader = vtk.vtkXMLUnstructuredGridReader()
            reader.SetFileName(str(folder / "leaves.vtu"))
            sizes = vtk.vtkCellSizeFilter()
            sizes.SetInputConnection(reader.GetOutputPort())
            sizes.Update()
            found = sizes.GetOutput()
            data = {array: vtk_to_numpy(found.GetCellData().GetArray(array)) for array in ("level", "material", "Volume")}
            numpy.testing.assert_array_equal(data["level"], leaves["level"])
            numpy.testing.assert_array_equal(data["material"], leaves["label"])
            stats = json.loads(run(PROGRAM, "stats", folder / f"{name}.tcell", "--json"))["materials"]
            for material in stats:
                self.assertAlmostEqual(data["Volume"][leaves["label"] == material["id"]].sum() / material["volume"], 1, 9)
            # Points are shared, and lie where the leaves' corners do.
            self.assertLess(found.GetNumberOfPoints(), 2 * len(leaves))
            corners = vtk_to_numpy(found.GetPoints().GetData())
            self.assertEqual(len(numpy.unique(corners, axis=0)), len(corners))

    def case(self, name, grid, *options, ranks=1):
        case = folder / name
        shutil.rmtree(case, ignore_errors=True)
        run(PROGRAM, "export", folder / f"{grid}.tcell", "--format", "openfoam", "-o", case, *options, *(("--ranks", str(ranks)) if ranks > 1 else ()))
        return case

    def test_checkmesh_finds_nothing_but_what_castellated_meshes_have(self):
        for name, grid, options, ranks in (("whole", "cube", ("--refine", "4,2"), 1), ("coarser", "cube", ("--refine", "6,1", "--want", "interface=1"), 1),
                                           ("parts", "cube", ("--refine", "4,2"), 4), ("stretched", "graded", ("--refine", "3,2"), 1),
                                           ("corner", "brick", ("--refine", "4,2", "--region", "5,9,3,61,63,50"), 1),
                                           ("both", "cube", ("--refine", "4,2", "--zones"), 1)):
            said = foam(self.case(name, grid, *options, ranks=ranks), "checkMesh", "-allTopology", ranks=ranks)
            self.assertIn("\nMesh OK.", said, name)
            said = foam(folder / name, "checkMesh", "-allGeometry", ranks=ranks)
            failed = [line for line in said.splitlines() if "***" in line and "Concave cells" not in line and "small determinant" not in line]
            self.assertEqual(failed, [], name)

    def test_a_solver_runs_and_snappyhexmesh_snaps(self):
        case = self.case("snap", "cube", "--refine", "4,2")
        (case / "constant/triSurface").mkdir()
        shutil.copy(folder / "ball.obj", case / "constant/triSurface")
        (case / "system/snappyHexMeshDict").write_text(HEADER.format("dictionary", "snappyHexMeshDict") + SNAP)
        cells = int(re.search(r"cells:\s+(\d+)", foam(case, "checkMesh"))[1])
        levels = self.leaves("cube", "--refine", "4,2")
        said = foam(case, "snappyHexMesh", "-overwrite")
        self.assertIn("Finished meshing without any errors", said)
        self.assertIn(f"Snapped mesh : cells:{cells}", said)
        told = re.search(r"Cells per refinement level:\n((?:\s+\d+\t\d+\n)+)", said)[1]
        air = levels[levels["label"] == 0]
        self.assertEqual({int(a): int(b) for a, b in re.findall(r"(\d+)\t([1-9]\d*)", told)}, {4 - int(n): int((air["level"] == n).sum()) for n in set(air["level"])})
        # Heat from one side to the other: what is left is a straight line but for the ball.
        case = self.case("heat", "cube", "--refine", "4,2", "--fluid", "air,lead")
        (case / "0").mkdir()
        (case / "constant/transportProperties").write_text(HEADER.format("dictionary", "transportProperties") + "DT [0 2 -1 0 0 0 0] 1e3;")
        (case / "0/T").write_text(HEADER.format("volScalarField", "T") + "dimensions [0 0 0 1 0 0 0]; internalField uniform 0; boundaryField { "
                                  '".*" { type zeroGradient; } xmin { type fixedValue; value uniform 0; } xmax { type fixedValue; value uniform 8; } }')
        foam(case, "laplacianFoam")
        text = (case / "1/T").read_text()
        values = numpy.array(text[text.index("(") + 1:text.index(")")].split(), float)
        middle = numpy.minimum((levels["i"] + 0.5) * 2.0**levels["level"], 64) / 8
        self.assertLess(abs(values - middle).max(), 0.1)


if __name__ == "__main__":
    unittest.main()

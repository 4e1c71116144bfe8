#!/usr/bin/python3
"""What a refined mesh costs: `teracell mesh` and `teracell export --format openfoam --refine`, beside snappyHexMesh's castellation of the same surface to the
same level.

Usage: tools/bench/refine.py SURFACE.obj [--box X0,Y0,Z0,X1,Y1,Z1] [--base NX,NY,NZ] [--level L] [--layers N] [--inside X,Y,Z] [--rounds N]. It builds
teracell, runs both in turn, and prints cells, seconds of processor time and megabytes, and the ratio of cells per second (medians). The defaults
are those of the motorbike. Takes Debian's package openfoam.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

from common import TERACELL, build

HEADER = "FoamFile {{ version 2.0; format ascii; class dictionary; object {}; }}\n"
SNAPPY = """castellatedMesh true; snap false; addLayers false;
geometry {{ surface.obj {{ type triSurfaceMesh; name surface; }} }}
castellatedMeshControls {{ maxLocalCells 100000000; maxGlobalCells 100000000; minRefinementCells 0; nCellsBetweenLevels {layers}; features ();
  refinementSurfaces {{ surface {{ level ({level} {level}); }} }} resolveFeatureAngle 30; refinementRegions {{}} locationInMesh ({inside});
  allowFreeStandingZoneFaces true; }}
snapControls {{ nSmoothPatch 3; tolerance 2.0; nSolveIter 30; nRelaxIter 5; }}
addLayersControls {{ relativeSizes true; layers {{}} expansionRatio 1.0; finalLayerThickness 0.3; minThickness 0.1; nGrow 0; featureAngle 60; nRelaxIter 3;
  nSmoothSurfaceNormals 1; nSmoothNormals 3; nSmoothThickness 10; maxFaceThicknessRatio 0.5; maxThicknessToMedialRatio 0.3; minMedianAxisAngle 90;
  nBufferCellsNoExtrude 0; nLayerIter 50; }}
meshQualityControls {{ maxNonOrtho 65; maxBoundarySkewness 20; maxInternalSkewness 4; maxConcave 80; minVol 1e-13; minTetQuality 1e-15; minArea -1;
  minTwist 0.02; minDeterminant 0.001; minFaceWeight 0.05; minVolRatio 0.01; minTriangleTwist -1; nSmoothScale 4; errorReduction 0.75; }}
mergeTolerance 1e-6;
"""
FOAM = 'source /usr/share/openfoam/etc/bashrc >/dev/null 2>&1; export WM_PROJECT_DIR=/usr/share/openfoam; exec "$@"'


def measured(*command):
    """Seconds of processor time, megabytes at most, and what it said."""
    with tempfile.NamedTemporaryFile("r") as times:
        done = subprocess.run(["/usr/bin/time", "-f", "%U %S %M", "-o", times.name, *map(str, command)], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{command}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
        user, system, kilobytes = map(float, times.read().split())
    return user + system, kilobytes / 1024, done.stdout


def snappy(folder, surface, o, box, base):
    (folder / "system").mkdir(parents=True)
    (folder / "constant/triSurface").mkdir(parents=True)
    shutil.copy(surface, folder / "constant/triSurface/surface.obj")
    lo, hi = box[:3], box[3:]
    corners = " ".join(f"({x} {y} {z})" for z in (lo[2], hi[2]) for x, y in ((lo[0], lo[1]), (hi[0], lo[1]), (hi[0], hi[1]), (lo[0], hi[1])))
    for name, text in (("controlDict", "application snappyHexMesh; startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep;"
                        "writeInterval 1; writeFormat binary;"),
                       ("fvSchemes", "gradSchemes { default Gauss linear; } divSchemes {} laplacianSchemes { default Gauss linear corrected; }"), ("fvSolution", ""),
                       ("blockMeshDict", f"scale 1; vertices ({corners}); blocks (hex (0 1 2 3 4 5 6 7) ({' '.join(map(str, base))}) simpleGrading (1 1 1));"
                        "edges (); boundary (); mergePatchPairs ();"),
                       ("snappyHexMeshDict", SNAPPY.format(level=o.level, layers=o.layers, inside=o.inside.replace(",", " ")))):
        (folder / "system" / name).write_text(HEADER.format(name) + text)
    measured("bash", "-c", FOAM, "foam", "blockMesh", "-case", folder)
    seconds, megabytes, said = measured("bash", "-c", FOAM, "foam", "snappyHexMesh", "-overwrite", "-case", folder)
    return int(re.findall(r"^Refined mesh : cells:(\d+)", said, re.M)[-1]), seconds, megabytes


def teracell(folder, surface, o, box, base):
    folder.mkdir()
    fine = [n << o.level for n in base]
    scene = {"units": "m", "grid": {"min": box[:3], "max": box[3:], "cells": fine}, "materials": {"air": {}, "body": {}},
             "bodies": [{"name": "body", "mesh": str(surface), "material": "body", "kind": "sheet"}]}
    (folder / "scene.json").write_text(json.dumps(scene))
    first = measured(TERACELL, "mesh", folder / "scene.json", "-o", folder / "g.tcell")
    second = measured(TERACELL, "export", folder / "g.tcell", "--format", "openfoam", "--refine", f"{o.level},{o.layers}", "-o", folder / "case")
    owner = (folder / "case/constant/polyMesh/owner").read_bytes()[:2000]
    return int(re.search(rb"nCells:(\d+)", owner)[1]), first[0] + second[0], max(first[1], second[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("surface")
    parser.add_argument("--box", default="-5,-4,0,15,4,8")
    parser.add_argument("--base", default="20,8,8")
    parser.add_argument("--level", type=int, default=6)
    parser.add_argument("--layers", type=int, default=3)
    parser.add_argument("--inside", default="3.001,3.001,0.43")
    parser.add_argument("--rounds", type=int, default=3)
    o = parser.parse_args()
    box, base = [float(x) for x in o.box.split(",")], [int(n) for n in o.base.split(",")]
    build("", "teracell")
    rates = {"snappyHexMesh": [], "teracell": []}
    print(f"{'':14} {'cells':>10} {'CPU s':>7} {'MB':>5} {'cells/s':>10}")
    for _ in range(o.rounds):
        folder = pathlib.Path(tempfile.mkdtemp())
        for name, run in (("snappyHexMesh", snappy), ("teracell", teracell)):
            cells, seconds, megabytes = run(folder / name, os.path.abspath(o.surface), o, box, base)
            rates[name].append(cells / seconds)
            print(f"{name:14} {cells:10} {seconds:7.2f} {megabytes:5.0f} {cells / seconds:10.0f}", flush=True)
        shutil.rmtree(folder)
    print(f"ratio {statistics.median(rates['teracell']) / statistics.median(rates['snappyHexMesh']):.1f}")


if __name__ == "__main__":
    main()

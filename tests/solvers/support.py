"""What the tests of solvers share: the program, a folder, and scenes of blocks with their grids and exports."""
import atexit
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "e2e"))
from solids import ascii_stl, obj  # noqa: E402

if len(sys.argv) < 2:
    sys.exit(f"Usage: {sys.argv[0]} PATH_TO_TERACELL")
PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
folder = pathlib.Path(tempfile.mkdtemp(prefix="teracell-solvers-"))
atexit.register(shutil.rmtree, folder, True)

# A block in a corner, none of whose sides is like another, and one that lies across.
METALS = {"units": "mm", "background": "air", "materials": {"air": {"color": "#00000000"}, "steel": {"color": "#8899aa"}, "brass": {"color": "#ccaa33"}}}
METAL_BLOCKS = {"steel": ((-1, 2, 5), (2, 4, 6)), "brass": ((1, 3, 7), (9, 4.6, 8.1))}
UNIFORM = {"min": [-1, 2, 5], "max": [11, 10, 10], "cells": [24, 16, 10]}
GRADED = {**UNIFORM, "x": {"planes": [-1, -0.5, 0.25, 1, 2, 3, 4.5, 6, 8, 11]}}
# The same for solvers that want permittivities, in a domain that begins at 0.
DIELECTRICS = {"units": "mm", "background": "air", "materials": {"air": {}, "teflon": {}, "glass": {}}}
DIELECTRIC_BLOCKS = {"teflon": ((0, 0, 0), (3, 2, 1.5)), "glass": ((2, 3, 2), (10, 5, 4))}
SIZE, CELLS = (12, 8, 5), (24, 16, 10)


def run(*args, **more):
    done = subprocess.run([str(a) for a in args], capture_output=True, text=True, **more)
    if done.returncode != 0:
        raise AssertionError(f"{args} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def mesh(name, scene, blocks, grid, *more):
    """The grid of a scene with a block, from one corner to the other, of each material."""
    for material, (lo, hi) in blocks.items():
        (folder / f"{material}.obj").write_text(obj(lo, hi))
    bodies = [{"name": material, "mesh": f"{material}.obj", "material": material} for material in blocks]
    (folder / f"{name}.json").write_text(json.dumps({**scene, "grid": grid, "bodies": bodies}))
    run(PROGRAM, "mesh", folder / f"{name}.json", "-o", folder / f"{name}.tcell", *more)
    return folder / f"{name}.tcell"


def metal_grids():
    """(kind, grid): uniform and graded axes, with rays along x and along z."""
    return [(kind, mesh(f"{kind}-{axis}", METALS, METAL_BLOCKS, axes, "--axis", axis))
            for kind, axes in (("uniform", UNIFORM), ("graded", GRADED)) for axis in "xz"]


def dielectric_grid(**axes):
    return mesh("dielectrics", DIELECTRICS, DIELECTRIC_BLOCKS, {"min": (0, 0, 0), "max": SIZE, "cells": CELLS, **axes})


PARTS = ((), ("--region", "1,2,3,8,9,7"), ("--level", "1"))


def parts_of(grids):
    """(kind, grid, options of `export`, cells): each grid of metal_grids() as a whole, a box of it, and a coarser level."""
    for kind, grid in grids:
        for more in PARTS:
            cells = numpy.load(exported(grid, "a.npy", *more))
            assert {0, 2} <= set(numpy.unique(cells)) and (more or 1 in cells), "the test sees the materials"
            yield kind, grid, more, cells


SAMPLES = (4, 8, 2)


def mixed_metals():
    """A grid with fractions, and the shares of steel and brass in its cells, [z][y][x]. Blocks that don't overlap have separable ones."""
    shares = {}
    for material, (lo, hi) in METAL_BLOCKS.items():
        along = []
        for d in range(3):
            n, step = UNIFORM["cells"][d] * SAMPLES[d], (UNIFORM["max"][d] - UNIFORM["min"][d]) / UNIFORM["cells"][d] / SAMPLES[d]
            points = UNIFORM["min"][d] + (numpy.arange(n) + 0.5) * step
            along.append(((lo[d] <= points) & (points < hi[d])).reshape(-1, SAMPLES[d]).mean(axis=1))
        shares[material] = numpy.einsum("x,y,z->zyx", *along)
    return mesh("mixed", METALS, METAL_BLOCKS, UNIFORM, "--fractions", ",".join(map(str, SAMPLES))), shares


def exported(grid, name, *more):
    run(PROGRAM, "export", grid, "-o", folder / name, *more)
    return folder / name


def refused(grid, name, *more):
    """What `export` says when it refuses."""
    done = subprocess.run([PROGRAM, "export", grid, "-o", folder / name, *more], capture_output=True, text=True)
    assert done.returncode == 2, done
    return done.stderr


def read(reader, path):
    """What a reader of VTK makes of a file."""
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()

"""What the tests of the installed library share: its place, programs that use it, and the stadium as a grid for each axis of rays."""
import atexit
import json
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy

PREFIX = os.environ["PREFIX"]
PROGRAM = PREFIX + "/bin/teracell"
SOURCES = pathlib.Path(__file__).parent
EXAMPLES = SOURCES.parent.parent / "tools/examples"
ENVIRONMENT = {**os.environ, "PKG_CONFIG_PATH": PREFIX + "/lib/pkgconfig", "LD_LIBRARY_PATH": PREFIX + "/lib"}


def run(*args, **more):
    done = subprocess.run([str(a) for a in args], env=ENVIRONMENT, capture_output=True, **more)
    if done.returncode != 0:
        raise AssertionError(f"{args} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def exported(path, level):
    run(PROGRAM, "export", path, "--level", level, "-o", folder / "all.npy")
    return numpy.load(folder / "all.npy")


def random_box(rng, shape, beyond=6):
    """(z0, y0, x0, z1, y1, x1), half of them reaching outside."""
    lo, hi = [], []
    outside = rng.random() < 0.5
    for n in shape:
        a, b = sorted(rng.randint(-beyond, n + beyond) if outside else rng.randint(0, n) for _ in range(2))
        lo.append(a), hi.append(max(b, a + 1))
    return (*lo, *hi)


def cut(cells, box, outside, dtype):
    """What a box must hold, by NumPy alone."""
    out = numpy.full([box[d + 3] - box[d] for d in range(3)], outside, dtype)
    lo = [max(0, box[d]) for d in range(3)]
    hi = [min(cells.shape[d], box[d + 3]) for d in range(3)]
    if all(a < b for a, b in zip(lo, hi)):
        out[tuple(slice(a - box[d], b - box[d]) for d, (a, b) in enumerate(zip(lo, hi)))] = cells[tuple(slice(a, b) for a, b in zip(lo, hi))]
    return out


def compiled(source, *flags):
    """A program of one source file against the installed library, by pkg-config."""
    package = "teracell-fortran" if source.suffix == ".f90" else "teracell"
    compiler = {".c": ["cc", "-std=c11"], ".cpp": ["c++", "-std=c++20"], ".f90": ["gfortran"]}[source.suffix]
    program = folder / (source.stem + source.suffix.replace(".", "-"))
    run(*compiler, "-Wall", "-O1", source, *run("pkg-config", "--cflags", "--libs", package, text=True).split(), *flags, "-o", program)
    return program


def stadium_scene():
    """The scene of the stadium, for grids elsewhere; no seam is stitched."""
    scene = json.loads((folder / "stadium/scene.json").read_text())
    for body in scene["bodies"]:
        body["mesh"] = str(folder / "stadium" / body["mesh"])
        body["stitch"] = 0
    return scene


def cmake_project(name, languages, *lines):
    """Builds a project that finds the package, and returns its folder."""
    project = folder / name
    project.mkdir()
    head = [f"cmake_minimum_required(VERSION 3.20)\nproject(p {languages})\nfind_package(teracell 0.1 REQUIRED)\n"]
    (project / "CMakeLists.txt").write_text("\n".join([*head, *lines, ""]))
    run("cmake", "-G", "Ninja", "-S", project, "-B", project / "build", "-DCMAKE_PREFIX_PATH=" + PREFIX)
    run("cmake", "--build", project / "build")
    return project / "build"


folder = pathlib.Path(tempfile.mkdtemp())
atexit.register(shutil.rmtree, folder)
grids = [folder / f"{axis}.tcell" for axis in "xyz"]
run(PROGRAM, "sample", "stadium", "-o", folder / "stadium")
for path in grids:
    run(PROGRAM, "mesh", folder / "stadium/scene.json", "--cells", "150", "--axis", path.stem, "-o", path)

"""The figures of T. Ma, T. Ma, L. Hao (MSAM 2020) measured here: time and memory of every engine
against facets and cells. README.md beside this file says what they show.

There are two inputs: the bust (--mesh, an OBJ file) in its cubic domain, and the sample stadium. For fewer facets their
vertices are clustered; for more, their facets are cut into four. The engines take turns, and everything is run --runs times
with one thread. Writes points.csv with the medians, and the pictures.
"""
import csv
import json
import math
import os
import pathlib
import statistics
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "bench"), str(HERE.parent / "bench/peers")]
from common import TERACELL, build, parser, peer  # noqa: E402
from cubic_scene import cubic_scene  # noqa: E402

COLUMNS = ["input", "engine", "facets", "n", "cells", "rays", "crossings", "cast_seconds", "run_seconds", "peak_bytes"]
AXIS = {"bust": "z", "stadium": "x"}  # of the rays, in every run
MOST_TESTS = 4.7e9  # rays times facets for the brute engine: 15 s

# How the facets are made. ("cut", k): each is cut into four, k times. ("clustered", k): vertices are clustered in cubes, with k
# cubes along the domain (bust) or k metres wide (stadium).
BUST = [("clustered", 6), ("clustered", 12), ("clustered", 24), ("clustered", 64), ("cut", 0), ("cut", 1), ("cut", 2), ("cut", 3)]
STADIUM = [("clustered", 30), ("clustered", 10), ("clustered", 4), ("cut", 0), ("cut", 1), ("cut", 2)]
FACETS_N = 1000                # cells along the longest axis while facets vary
PER_RAY_N = (464, 2154)        # two more n; their difference is the cost of the rays alone
BUST_N = [46, 100, 215, 464, 1000, 2154, 4642, 10000]  # while cells vary: 10^5 to 10^12
STADIUM_N = [100, 215, 464, 1000, 2108, 4642]          # 2108: 1.5e9 cells, as many as the paper's


def cases():
    """(input, how its facets are made, n, engine), engines in turn."""
    for how in BUST:
        for n in (PER_RAY_N[0], FACETS_N, PER_RAY_N[1]):
            yield from (("bust", how, n, engine) for engine in ("tree", "slice", "scan"))
        yield "bust", how, FACETS_N, "brute"
    for how in STADIUM:
        yield from (("stadium", how, FACETS_N, engine) for engine in ("tree", "slice", "scan", "brute"))
    for name, cells in (("bust", BUST_N), ("stadium", STADIUM_N)):
        for n in cells:
            yield from ((name, ("cut", 0), n, engine) for engine in ("tree", "slice", "scan", "brute"))


FACET = struct.Struct("<12fH")  # of a binary STL: normal, three vertices, two unused bytes


def cluster(stl, edge):
    """Replaces all vertices in a cube of `edge` by the first of them, and drops facets that lose a side by this. A closed surface
    stays closed, because each edge keeps as many facets on one side as on the other. A surface that would vanish is not changed."""
    first, kept = {}, []
    for row in FACET.iter_unpack(stl.read_bytes()[84:]):
        corners = [first.setdefault(tuple(x // edge for x in row[i:i + 3]), row[i:i + 3]) for i in (3, 6, 9)]
        if len(set(corners)) == 3:
            kept.append(FACET.pack(0, 0, 0, *corners[0], *corners[1], *corners[2], 0))
    if kept:
        stl.write_bytes(bytes(80) + struct.pack("<I", len(kept)) + b"".join(kept))


class Inputs:
    """Makes each surface once, and scenes with them."""

    def __init__(self, mesh, folder):
        self.mesh, self.folder, self.made = mesh, pathlib.Path(folder), {}
        subprocess.run([TERACELL, "sample", "stadium", "-o", self.folder / "stadium"], check=True, stdout=subprocess.DEVNULL)

    def template(self, name, n):
        """A scene with the unchanged surfaces."""
        if name == "bust":
            return cubic_scene(self.mesh, n)
        scene = json.loads((self.folder / "stadium/scene.json").read_text())
        scene["grid"]["cells"] = n
        for body in scene["bodies"]:
            body["mesh"] = str(self.folder / "stadium" / body["mesh"])
        return scene

    def surfaces(self, name, how):
        """The files of the bodies, and their number of facets."""
        if (name, how) not in self.made:
            scene, files, (way, amount) = self.template(name, 1000), [], how
            for i, body in enumerate(scene["bodies"]):
                files.append(self.folder / f"{name}-{way}-{amount}-{i}.stl")
                subprocess.run([peer("subdivide"), body["mesh"], files[-1], str(amount if way == "cut" else 0)], check=True)
                if way == "clustered":
                    domain = scene["grid"]["max"][0] - scene["grid"]["min"][0]
                    cluster(files[-1], domain / amount if name == "bust" else amount)
            self.made[name, how] = files, sum((file.stat().st_size - 84) // FACET.size for file in files)
        return self.made[name, how]

    def scene(self, name, how, n):
        """A scene file and its number of facets. The grid does not depend on how the facets are made."""
        files, facets = self.surfaces(name, how)
        scene = self.template(name, n)
        for body, file in zip(scene["bodies"], files):
            body["mesh"] = str(file)
        path = self.folder / "scene.json"
        path.write_text(json.dumps(scene))
        return path, facets


def grid_of(scene, n):
    """The number of cells along each axis, as teracell makes them: cubes, n along the longest."""
    grid = json.loads(scene.read_text())["grid"]
    extent = [b - a for a, b in zip(grid["min"], grid["max"])]
    return [max(1, math.ceil(e * n / max(extent) - 1e-6)) for e in extent]


def measure(inputs, name, how, n, engine):
    """One run as a row of COLUMNS; None if it would take too long."""
    scene, facets = inputs.scene(name, how, n)
    cells = grid_of(scene, n)
    rays = cells[1] * cells[2] if AXIS[name] == "x" else cells[0] * cells[1]
    if engine == "brute" and rays * facets > MOST_TESTS:
        return None
    grid, report = inputs.folder / "grid.tcell", inputs.folder / "report.json"
    # A process starts with the peak memory of its parent, so a small shell is put in between.
    with open(inputs.folder / "errors", "w+") as errors:
        process = subprocess.Popen(["sh", "-c", '"$@"; exit $?', "sh", TERACELL, "mesh", scene, "-o", grid, "--engine", engine, "--axis", AXIS[name],
                                    "--threads", "1", "--report", report, "--progress", "none"], stdout=subprocess.DEVNULL, stderr=errors)
        _, status, used = os.wait4(process.pid, 0)
        if status != 0:
            errors.seek(0)
            sys.exit(f"\nteracell mesh of {name}, {how}, n = {n}, engine {engine}: {errors.read()}")
    found = json.loads(report.read_text())
    seconds = {phase["name"]: phase["seconds"] for phase in found["phases"]}
    run = used.ru_utime + used.ru_stime
    # Phases are in wall time. This is the share of it that the run had a core; `finish` is left out, because it mostly waits for the disk.
    share = min(1, run / (seconds["read"] + seconds["prepare"] + seconds["cast"]))
    return [name, engine, facets, n, cells[0] * cells[1] * cells[2], rays, found["crossings"], seconds["cast"] * share, run,
            found["peak_memory_bytes"]]


def print_table(points):
    """Prints the seconds of casting, tree / scan, for each number of facets and each grid."""
    cast = {(p[2], p[3], p[1]): p[-3] for p in points if p[0] == "bust"}
    grids = sorted({*PER_RAY_N, FACETS_N})
    print("| facets |" + "".join(f" {n}^3 |" for n in grids) + "\n|---:|" + "---:|" * len(grids))
    for facets in sorted({facets for facets, _, _ in cast}):
        print(f"| {facets:,} |" + "".join(f" {cast[facets, n, 'tree']:.2f} / {cast[facets, n, 'scan']:.2f} |" for n in grids))


def main(arguments):
    options_of = parser("tools/bench/run paper", __doc__, runs=3)
    options_of.add_argument("-o", "--output", default="paper-out", metavar="FOLDER", help="for the pictures (default paper-out)")
    options = options_of.parse_args(arguments)
    build("gnuplot-nox", "teracell", "subdivide")
    rows = {}
    with tempfile.TemporaryDirectory() as folder:
        inputs = Inputs(options.mesh, folder)
        for turn in range(options.runs):
            for i, case in enumerate(dict.fromkeys(cases())):
                print(f"\rround {turn + 1} of {options.runs}, {i:3}: {' '.join(map(str, case)):60}", end="", file=sys.stderr, flush=True)
                row = measure(inputs, *case)
                if row:
                    rows.setdefault(case, []).append(row)
    print(file=sys.stderr)
    points = [same[0][:-3] + [statistics.median(column) for column in zip(*(row[-3:] for row in same))] for same in sorted(rows.values())]
    os.makedirs(options.output, exist_ok=True)
    with open(os.path.join(options.output, "points.csv"), "w", newline="") as f:
        table = csv.writer(f, lineterminator="\n")
        table.writerow(COLUMNS)
        for point in points:
            table.writerow(point[:-3] + [f"{point[-3]:.4f}", f"{point[-2]:.4f}", int(point[-1])])
    subprocess.run(["gnuplot", HERE / "figures.gp"], cwd=options.output, check=True)
    print_table(points)
    print(f"{options.output}: points.csv and {len([p for p in os.listdir(options.output) if p.endswith('.svg')])} pictures")

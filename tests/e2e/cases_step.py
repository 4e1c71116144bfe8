"""STEP: names, volumes, units and cells of models that OpenCASCADE wrote; the cache of facets; a CAD kernel that crashes, hangs or is missing.

The models are written by step_models and the hostile files by hostile.py, both in tests/step. Every test has a cache of its own.
"""
import atexit
import concurrent.futures
import contextlib
import fractions
import functools
import glob
import gzip
import json
import math
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import program
import solids
from program import Case, Result

sys.path.insert(0, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "step"))
import hostile  # noqa: E402

FOLDER = os.path.dirname(program.PROGRAM)
KERNEL, MAKER = os.path.join(FOLDER, "teracell-step"), os.path.join(FOLDER, "tests", "step_models")
CURVED = ("sphere", "torus", "cylinders", "nested", "pipe", "bolts", "bspline")
SOUND = CURVED + ("assembly", "units", "metres", "sheet", "mirrored", "validated", "lying")
MILLIMETRES = {"mm": 1, "inch": 25.4, "in": 25.4, "m": 1000}
HASH_BYTES = 16  # behind each entry of the cache


@functools.cache
def models():
    """The folder of the models, and what they hold."""
    folder = tempfile.mkdtemp(prefix="teracell-step-models-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder, json.loads(subprocess.run([MAKER, folder], check=True, capture_output=True).stdout)


def model(name):
    return os.path.join(models()[0], name + ".step")


@unittest.skipUnless(os.path.exists(KERNEL) and os.path.exists(MAKER), "no teracell-step beside the program, or no tests/step_models: CMake builds them with TERACELL_STEP")
class StepCase(Case):
    def setUp(self):
        super().setUp()
        self.cache = self.path("cache")
        self.env = dict(os.environ, XDG_CACHE_HOME=self.cache)

    def teracell(self, *args, program_path=None, env=None, **options):
        args = [program_path or program.PROGRAM, *map(str, args)]
        return Result(args, subprocess.run(args, cwd=self.folder, env=env or self.env, capture_output=True, stdin=subprocess.DEVNULL, timeout=120, **options))

    def run_ok(self, *args, **options):
        r = self.teracell(*args, **options)
        self.assertEqual(r.status, 0, f"{r.args}: {r.err}")
        return r

    def json_of(self, *args, **options):
        return json.loads(self.run_ok(*args, "--json", **options).out)

    def files_of(self, *names, **options):
        """What `info` says of each model."""
        return self.json_of("info", *[n if "." in n else model(n) for n in names], **options)["files"]

    def copy(self, name):
        shutil.copy(model(name), self.path(name + ".step"))
        return name + ".step"

    def program_with(self, script=None):
        """A copy of the program with this kernel beside it, or none."""
        os.mkdir(self.path("bin"))
        copy = self.path("bin/teracell")
        shutil.copy(program.PROGRAM, copy)
        if script:
            self.write("bin/teracell-step", "#!/bin/sh\n" + script)
            os.chmod(self.path("bin/teracell-step"), 0o755)
        return copy

    def logged_program(self):
        """A copy of the program, and a function that tells how often its kernel was started."""
        log = self.write("log", "")
        return self.program_with(f'echo start >> "{self.path(log)}"\nexec "{KERNEL}" "$@"\n'), lambda: self.bytes(log).count(b"\n")

    def entries(self, cache=None):
        """The entries of the cache, by file: bytes without the hash. Nothing else is in it but locks."""
        out = {}
        for path in glob.glob(os.path.join(cache or self.cache, "teracell", "cad", "*")):
            self.assertRegex(os.path.basename(path), r"^[0-9a-f]{32}\.(cad|cad-lock)$")
            if path.endswith(".cad"):
                with open(path, "rb") as file:
                    out[path] = file.read()[:-HASH_BYTES]
        return out

    def kernels(self):
        """The CAD kernels at work for this test."""
        out = []
        for path in glob.glob("/proc/[0-9]*"):
            with contextlib.suppress(OSError):
                with open(path + "/environ", "rb") as environ, open(path + "/cmdline", "rb") as line:
                    if self.folder.encode() in environ.read() and not line.read().split(b"\0")[0].endswith(b"/teracell"):
                        out.append(int(os.path.basename(path)))
        return out

    def expect_no_kernels(self):
        self.wait_until(lambda: not self.kernels(), "the end of the CAD kernels", 2)

    def mesh_scene(self, name, scene, **options):
        self.write(name + ".json", scene)
        self.run_ok("mesh", name + ".json", "-o", name + ".tcell", "--report", name + ".report.json", **options)
        return self.read_json(name + ".report.json")

    def expect_equal_grids(self, first, second):
        self.assertIn("the grids are equal", self.run_ok("diff", first, second).out)

    def cells(self, grid):
        return {m["name"]: m["cells"] for m in self.json_of("stats", grid)["materials"]}


def scene_of(bodies, lo, hi, cells, units="mm", **keys):
    return {"units": units, "grid": {"min": lo, "max": hi, "cells": cells}, "materials": {"air": {}, "steel": {}}, "bodies": bodies, **keys}


class StepModels(StepCase):
    def test_info_has_names_colours_materials_and_volumes_that_agree_with_the_exact_ones(self):
        expected = models()[1]
        for name, file in zip(SOUND, self.files_of(*SOUND)):
            parts = expected[name + ".step"]["parts"]
            unit = MILLIMETRES[expected[name + ".step"]["unit"]]
            self.assertEqual((file["format"], MILLIMETRES[file["unit"]]), ("step", unit))
            found = {p["path"]: p for p in file["parts"]}
            self.assertLessEqual(set(found), {p["path"] for p in parts}, name)
            box = [min(p["box"][d] for p in file["parts"]) for d in range(3)] + [max(p["box"][d] for p in file["parts"]) for d in range(3, 6)]
            deflection = unit * 1e-4 * max(box[d + 3] - box[d] for d in range(3))
            if name in ("bolts", "assembly"):  # whose boxes here are those of the first instances
                deflection = 1e-4 * (290 if name == "bolts" else 140)
            looks = lambda p: (p["color"], p["material"])
            for p in parts:
                # One entry stands for all parts of one shape and look.
                same = [q for q in parts if looks(q) == looks(p) and q["volume"] is not None and math.isclose(q["volume"], p["volume"], rel_tol=1e-12)] or [p]
                if name == "mirrored":
                    same = [p]
                f = found[same[0]["path"]]
                where = (name, p["path"])
                self.assertEqual(f["instances"], sum(q["instances"] for q in same), where)
                self.assertEqual(looks(f), looks(p), where)
                self.assertEqual(f["closed"], p["volume"] is not None, where)
                self.assertEqual(f["open_edges"] == 0, f["closed"], where)
                self.assertLessEqual(abs(f["area"] * unit**2 - p["area"]), 0.01 * p["area"], where)
                if p["volume"] is None:
                    self.assertIsNone(f["kernel_volume"], where)
                    continue
                self.assertLessEqual(abs(f["kernel_volume"] * unit**3 - p["volume"]), 1e-4 * p["volume"], where)
                self.assertLessEqual(abs(f["volume"] * unit**3 - p["volume"]), deflection * p["area"] + 1e-9 * p["volume"], where)
            self.assertEqual(sum(p["instances"] for p in parts), sum(f["instances"] for f in file["parts"]), name)
        self.expect_no_kernels()

    def test_the_error_of_the_facets_falls_with_the_deflection_and_stays_within_it(self):
        expected, errors = models()[1], {}
        for deflection in (0.4, 0.1, 0.02):
            self.run_ok("mesh", *[model(m) for m in CURVED], "--cells", 20, "--deflection", deflection, "--angle", 90, "-o", "g.tcell", "--report", "r.json", "--threads", 2)
            for name, file in zip(CURVED, self.read_json("r.json")["inputs"]):
                cad = file["cad"]
                self.assertEqual((cad["deflection"], cad["angle"], len(cad["facets_hash"])), (deflection, 90, 32))
                self.assertTrue(cad["kernel"].startswith("OpenCASCADE "))
                self.assertEqual([p["path"] for p in cad["parts"]], [p["path"] for p in expected[name + ".step"]["parts"]])
                for p, e in zip(cad["parts"], expected[name + ".step"]["parts"]):
                    where = (deflection, p["path"])
                    self.assertEqual((p["closed"], p["faces_without_facets"], p["instances"]), (True, 0, e["instances"]), where)
                    error = abs(p["facet_volume"] - e["volume"])
                    self.assertLessEqual(error, deflection * e["area"], where)
                    errors.setdefault(p["path"], []).append(error)
        for path, falling in errors.items():
            self.assertGreater(falling[0], 1.5 * falling[2], (path, falling))
            self.assertGreaterEqual(falling[0] * 1.001, falling[1], (path, falling))
            self.assertGreaterEqual(falling[1] * 1.001, falling[2], (path, falling))

    def test_boxes_are_those_of_the_exact_surfaces_and_a_deflection_in_cells_follows_from_them(self):
        boxes = []
        for deflection in ("2", "0.1c", "0.05c"):
            self.run_ok("mesh", model("sphere"), "--cells", 22, "--deflection", deflection, "-o", "g.tcell")
            info = self.json_of("info", "g.tcell")
            boxes.append(info["grid"]["min"] + info["grid"]["max"])
            cad = info["report"]["inputs"][0]["cad"]
            self.assertAlmostEqual(cad["deflection"], {"2": 2, "0.1c": 0.1, "0.05c": 0.05}[deflection], places=6)
        self.assertEqual(boxes[0], boxes[1])
        self.assertEqual(boxes[0], boxes[2])
        for value, exact in zip(boxes[0], 3 * [-11] + 3 * [11]):
            self.assertAlmostEqual(value, exact, places=5)
        self.run_ok("mesh", model("sphere"), "--cells", 22, "-o", "g.tcell")
        self.assertAlmostEqual(self.json_of("info", "g.tcell")["report"]["inputs"][0]["cad"]["deflection"], 0.1, places=6)

    def test_every_occurrence_stands_where_its_assembly_puts_it(self):
        self.run_ok("mesh", model("assembly"), "--by-part", "--step", 0.5, "-o", "g.tcell")
        info = self.json_of("info", "g.tcell")
        lo = info["grid"]["min"]
        found = {m["name"]: m["box"] for m in self.json_of("stats", "g.tcell")["materials"]}
        hexagon = [(10 / math.sqrt(3) * math.cos(math.pi / 3 * i), 10 / math.sqrt(3) * math.sin(math.pi / 3 * i), z) for i in range(6) for z in (0, 5)]
        block = lambda x, y, z: [(a, b, c) for a in (0, x) for b in (0, y) for c in (0, z)]
        moved = lambda points, x, y, z: [(p[0] + x, p[1] + y, p[2] + z) for p in points]
        expected = {"/машина/держатель/плита": block(60, 40, 5), "/машина/держатель/левая гайка": moved(hexagon, 10, 10, 5),
                    "/машина/держатель/ナット": moved(hexagon, 50, 10, 5), "/машина/держатель#2/плита": moved(block(60, 40, 5), 0, 0, 50),
                    "/машина/держатель#2/левая гайка": moved(hexagon, 10, 10, 55), "/машина/держатель#2/ナット": moved(hexagon, 50, 10, 55),
                    "/машина/ナット": moved([turned(p) for p in hexagon], 100, 0, 0), "/машина/синяя гайка": moved(hexagon, 100, 40, 0),
                    "/машина/крышка": moved(block(20, 30, 4), 0, 100, 0), "/машина/тройка/ребро": moved(block(10, 2, 6), 0, 0, 100),
                    "/машина/тройка/solid 2": moved(block(8, 8, 8), 16, -4, 96), "/машина/тройка/solid 3": moved(block(4, 4, 9), 28, -2, 100)}
        self.assertEqual(list(found)[1:], list(expected))
        for path, points in expected.items():
            for d in range(3):
                ends = [lo[d] + 0.5 * found[path][d], lo[d] + 0.5 * found[path][d + 3]]
                for end, exact in zip(ends, (min(p[d] for p in points), max(p[d] for p in points))):
                    self.assertLessEqual(abs(end - exact), 0.76, (path, d))

    def test_by_default_facets_of_the_assembly_have_the_volume_of_its_solids(self):
        """Chords of 12 degrees take 0.8 % of a ball and a pin of few cells; plates and nuts are within 0.1 %."""
        self.run_ok("mesh", model("assembly"), "--by-part", "--cells", 100, "-o", "g.tcell")
        parts = {p["path"].rsplit("/", 1)[-1]: p for i in self.json_of("info", "g.tcell")["report"]["inputs"] for p in i["cad"]["parts"]}
        self.assertEqual(len(parts), 8)
        for name, p in parts.items():
            if p["kernel_volume"]:
                bar = 8e-3 if name in ("solid 2", "solid 3") else 1e-3
                self.assertTrue(p["closed"] and abs(p["facet_volume"] / p["kernel_volume"] - 1) < bar, name)

    def test_the_size_of_a_model_changes_no_cell(self):
        """Its lengths become those of a model of micrometres, in millimetres, and of one of kilometres."""
        found = []
        for scale in (1, 2**-20, 2**20):
            self.mesh_scene("g", {"units": "mm", "grid": {"cells": 60}, "materials": {"air": {}, "steel": {}},
                                  "bodies": [{"mesh": model("assembly"), "material": "steel", "scale": scale}]})
            found.append((self.json_of("info", "g.tcell")["grid"]["cells"], self.json_of("stats", "g.tcell")["materials"][1]["cells"]))
        self.assertEqual(found, [found[0]] * 3)

    def test_one_file_in_several_units_is_one_size(self):
        for name, unit in (("units", "in"), ("metres", "m")):
            for units, step, factor in (("mm", 2.54, 1), ("in", 0.1, 1 / 25.4), ("m", 0.00254, 0.001)):
                self.run_ok("mesh", model(name), "--units", units, "--step", step, "-o", "g.tcell")
                info = self.json_of("info", "g.tcell")
                file = info["report"]["inputs"][0]
                self.assertEqual((info["units"], file["unit"]), (units, unit))
                self.assertAlmostEqual(file["factor"], factor * MILLIMETRES[unit], places=12)
                self.assertEqual(info["grid"]["cells"], [12, 22, 32], (name, units))
                solid = self.json_of("stats", "g.tcell")["materials"][1]
                self.assertEqual((solid["cells"], solid["box"]), (6000, [1, 1, 1, 11, 21, 31]), (name, units))
                self.assertAlmostEqual(file["cad"]["parts"][0]["kernel_volume"] / (98322.384 * factor**3), 1, places=9)
        self.run_ok("mesh", model("units"), "--cells", 20, "-o", "g.tcell")
        self.assertEqual(self.json_of("info", "g.tcell")["units"], "in")

    def test_the_report_has_the_volume_of_the_cells_and_by_shares_a_better_one(self):
        errors = []
        for options in ([], ["--fractions", "8,8,8"]):
            self.run_ok("mesh", model("torus"), "--cells", 40, "--deflection", "0.005", *options, "-o", "g.tcell")
            cad = self.json_of("info", "g.tcell")["report"]["inputs"][0]["cad"]
            self.assertEqual(cad["by_shares"], bool(options))
            errors.append(abs(cad["grid_volume"] / (2 * math.pi**2 * 20 * 25) - 1))
            if not options:
                step = self.json_of("info", "g.tcell")["grid"]["axes"][0]["step"]
                self.assertAlmostEqual(cad["grid_volume"] / step**3, self.cells("g.tcell")["torus"], places=3)
        self.assertLess(errors[0], 0.02)
        self.assertLess(errors[1], 0.002)

    def test_a_sender_whose_volume_is_wrong_is_contradicted(self):
        lying, validated = self.files_of("lying", "validated")
        self.assertEqual([f["parts"][0]["sender_volume"] for f in (lying, validated)], [7200, 6000])
        self.assertEqual(validated["warnings"], [])
        self.assertEqual(len(lying["warnings"]), 1)
        for words in ("/lying", "7200", "the sender", "6000"):
            self.assertIn(words, lying["warnings"][0])
        r = self.run_ok("mesh", model("lying"), model("validated"), "--cells", 20, "-o", "g.tcell")
        self.assertIn("7200", r.err)
        self.assertNotIn("/validated", r.err)
        report = self.json_of("info", "g.tcell")["report"]
        self.assertEqual([f["cad"]["parts"][0]["sender_volume"] for f in report["inputs"]], [7200, 6000])
        self.assertEqual(sum("7200" in w for w in report["warnings"]), 1)


def turned(p):
    """By 37 degrees about the axis through (5, -3, 2) along (1, 2, 3): Rodrigues' formula."""
    through, angle = (5, -3, 2), math.radians(37)
    k = [x / math.sqrt(14) for x in (1, 2, 3)]
    v = [a - b for a, b in zip(p, through)]
    cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]]
    along = sum(a * b for a, b in zip(k, v))
    return [t + x * math.cos(angle) + c * math.sin(angle) + a * along * (1 - math.cos(angle)) for t, x, c, a in zip(through, v, cross, k)]


def product_of(a, b):
    """Of two matrices with 12 entries, as the rules of placement say it."""
    out = []
    for row in range(3):
        for column in range(4):
            x = (a[4 * row] * b[column] + a[4 * row + 1] * b[4 + column]) + a[4 * row + 2] * b[8 + column]
            out.append(x + a[4 * row + 3] if column == 3 else x)
    return out


def placed(m, v):
    return tuple(((m[4 * r] * v[0] + m[4 * r + 1] * v[1]) + m[4 * r + 2] * v[2]) + m[4 * r + 3] for r in range(3))


IDENTITY = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]


def kept_facets(entries, factor):
    """From the entries of a cache: (vertices, triangles) of each shape, and (shape, matrix) of each part. `factor`: from millimetres."""
    exactly = lambda x: float(fractions.Fraction(x) * factor)
    outline = next(json.loads(e)["outline"] for e in entries if e.startswith(b'{"outline"'))
    data = next(e for e in entries if e.startswith(b"teracad"))
    size = struct.unpack_from("<Q", data, 8)[0]
    shapes, at = [], 16 + size
    for s in json.loads(data[16:at])["shapes"]:
        flat = struct.unpack_from(f"<{3 * s['vertices']}d", data, at)
        at += 24 * s["vertices"]
        count = sum(g["triangles"] for g in s["groups"])
        numbers = struct.unpack_from(f"<{3 * count}I", data, at)
        at += 12 * count
        shapes.append(([tuple(exactly(x) for x in flat[i:i + 3]) for i in range(0, len(flat), 3)], [numbers[i:i + 3] for i in range(0, len(numbers), 3)]))
    assert at == len(data), (at, len(data))
    parts = []

    def visit(uses, matrix):
        for use in uses:
            m = [exactly(x) if i % 4 == 3 else float(x) for i, x in enumerate(use["matrix"])]
            below = m if matrix is IDENTITY else product_of(matrix, m)
            node = outline["nodes"][use["node"]]
            if node["shape"] is not None:
                parts.append((node["shape"], below))
            visit(node["uses"], below)

    visit(outline["roots"], IDENTITY)
    return shapes, parts


def obj_of(shapes, parts):
    lines, first = [], 1
    for shape, matrix in parts:
        vertices, triangles = shapes[shape]
        lines += ["v %r %r %r" % (v if matrix == IDENTITY else placed(matrix, v)) for v in vertices]
        lines += ["f %d %d %d" % tuple(first + n for n in t) for t in triangles]
        first += len(vertices)
    return "\n".join(lines) + "\n"


class StepCells(StepCase):
    DOMAINS = {"sphere": ([-11, -11, -11], [11, 11, 11]), "torus": ([-26, -26, -6], [26, 26, 6]), "cylinders": ([-6, -6, -1], [12, 6, 21]),
               "nested": ([-16, -16, -16], [16, 16, 16]), "pipe": ([-11, -11, -1], [11, 11, 201]), "bolts": ([-6, -6, -16], [186, 186, 275]),
               "assembly": ([-10, -10, -10], [120, 140, 115])}

    def compare(self, name, units="mm", **body):
        factor = fractions.Fraction(5, 127) if units == "in" else fractions.Fraction(1)
        lo, hi = [[float(x * factor) for x in corner] for corner in self.DOMAINS[name]]
        cells = [190, 181, 97] if name == "bolts" else [101, 97, 89]
        self.env["XDG_CACHE_HOME"] = cache = self.path(f"cache-{name}-{units}")
        body = {"material": "steel", "stitch": 0, **body}
        step = self.mesh_scene("step", scene_of([{"mesh": model(name), "deflection": float(0.3 * factor), **body}], lo, hi, cells, units))
        shapes, parts = kept_facets(self.entries(cache).values(), factor)
        self.write("facets.obj", obj_of(shapes, parts))
        obj = self.mesh_scene("obj", scene_of([{"mesh": "facets.obj", **body}], lo, hi, cells, units))
        self.assertEqual(step["bodies"][0]["facets"], obj["bodies"][0]["facets"], name)
        self.assertGreater(step["bodies"][0]["cells"], 500, name)
        self.assertEqual(step["bodies"][0]["cells"], obj["bodies"][0]["cells"], name)
        self.expect_equal_grids("step.tcell", "obj.tcell")

    def test_cells_are_those_of_the_facets_as_a_mesh(self):
        for name in self.DOMAINS:
            self.compare(name)

    def test_cells_are_those_of_the_facets_in_another_unit_and_place(self):
        self.compare("assembly", "in")
        self.compare("torus", "in", scale=0.9, rotate={"axis": [1, 2, 3], "degrees": 20}, translate=[0.01, 0.02, 0.03])

    def test_step_beside_stl_with_and_without_a_domain(self):
        self.write("box.stl", solids.binary_stl(solids.box_facets((30.0, 0.0, 0.0), (40.0, 50.0, 70.0))))
        self.copy("metres")
        scene = {"units": "mm", "grid": {"step": 2}, "materials": {"air": {}, "steel": {}, "brass": {}}, "label_by": "body",
                 "bodies": [{"name": "step", "mesh": "metres.step", "material": "steel"}, {"name": "stl", "mesh": "box.stl", "material": "brass"}]}
        self.mesh_scene("free", scene)
        info = self.json_of("info", "free.tcell")
        for found, exact in zip(info["grid"]["min"] + info["grid"]["max"], [0, 0, 0, 40, 50.8, 76.2]):
            self.assertLessEqual(abs(found - exact), 4 + 1e-9)
        scene["grid"] = {key: info["grid"][key] for key in ("min", "max", "cells")}
        self.mesh_scene("fixed", scene)
        self.expect_equal_grids("free.tcell", "fixed.tcell")
        cells = self.cells("free.tcell")
        self.assertAlmostEqual(cells["steel"] * 8 / 98322.384, 1, delta=0.1)
        self.assertAlmostEqual(cells["brass"] * 8 / 35000, 1, delta=0.1)
        self.run_ok("mesh", "box.stl", "metres.step", "--units", "mm", "--step", 2, "-o", "bare.tcell")
        bare = self.cells("bare.tcell")
        self.assertEqual([bare["metres"], bare["box"]], [cells["steel"], cells["brass"]])

    def test_shards_have_the_bytes_of_the_whole_each_with_a_cache_of_its_own(self):
        mesh = ("mesh", model("assembly"), "--cells", 150, "--face-patches", "--links", "-o")
        self.run_ok(*mesh, "whole.tcell")
        for caches in (["cache", "cache"], ["cache-0", "cache-1"]):
            for i in (0, 1):
                self.run_ok(*mesh, "s.tcell", "--shard", f"{i}/2", env=dict(self.env, XDG_CACHE_HOME=self.path(caches[i])))
            self.run_ok("merge", "s.tcell.shard-0-of-2", "s.tcell.shard-1-of-2", "-o", "s.tcell")
            self.assertEqual(self.bytes("s.tcell"), self.bytes("whole.tcell"))
            os.remove(self.path("s.tcell"))
        self.run_ok(*mesh, "s.tcell", "--shard", "1/2", "--deflection", "0.5")
        r = self.teracell("merge", "s.tcell.shard-0-of-2", "s.tcell.shard-1-of-2", "-o", "s.tcell")
        self.assert_refused(r, 1, "shard-1-of-2")

    def test_faces_of_a_colour_of_their_own_are_patches_when_asked_for(self):
        areas = []
        for options in ([], ["--face-patches"]):
            self.run_ok("mesh", model("assembly"), "--cells", 150, "--links", *options, "-o", f"{len(options)}.tcell")
            patches = self.json_of("info", f"{len(options)}.tcell")["patches"]
            areas.append({p["name"]: p["area"] for p in patches if "крышка" in p["name"]})
        self.assertEqual(list(areas[0]), ["/машина/крышка"])
        self.assertAlmostEqual(areas[0]["/машина/крышка"], 1600)
        self.assertEqual(set(areas[1]), {"/машина/крышка", "/машина/крышка:red"})
        self.assertAlmostEqual(areas[1]["/машина/крышка:red"], 240)
        self.assertAlmostEqual(sum(areas[1].values()), 1600)
        self.expect_equal_grids("0.tcell", "1.tcell")


class StepNames(StepCase):
    PARTS = ["/машина/держатель/плита", "/машина/держатель/левая гайка", "/машина/держатель/ナット", "/машина/держатель#2/плита",
             "/машина/держатель#2/левая гайка", "/машина/держатель#2/ナット", "/машина/ナット", "/машина/синяя гайка", "/машина/крышка",
             "/машина/тройка/ребро", "/машина/тройка/solid 2", "/машина/тройка/solid 3"]

    def test_a_scene_to_edit_a_body_for_each_part_and_globs_take_the_same_cells(self):
        self.copy("assembly")
        out = self.run_ok("scene", "assembly.step", "--cells", 100, "-o", "edit.json").out
        self.assertIn("edit.json: 12 bodies", out)
        self.assertIn("guessed", out)
        edit = self.read_json("edit.json")
        self.assertEqual(edit["units"], "mm")
        self.assertEqual([b["part"] for b in edit["bodies"]], self.PARTS)
        self.assertEqual([b["material"] for b in edit["bodies"][:3]], ["Алюминий", "Steel", "Steel"])
        self.run_ok("mesh", "edit.json", "-o", "edit.tcell")
        self.run_ok("mesh", "assembly.step", "--by-part", "--cells", 100, "-o", "by.tcell")
        by, edited = self.cells("by.tcell"), self.cells("edit.tcell")
        self.assertEqual(list(by)[1:], self.PARTS)
        self.assertEqual(edited["Алюминий"], by[self.PARTS[0]] + by[self.PARTS[3]])
        self.assertEqual(edited["Steel"], sum(n for path, n in by.items() if path.endswith(("гайка", "ナット"))))
        grid = {key: self.json_of("info", "by.tcell")["grid"][key] for key in ("min", "max", "cells")}
        for part, taken in (("*гайка", ("гайка",)), ("ナット", ("ナット",)), ("/машина/*/ナット", ("держатель/ナット", "держатель#2/ナット")),
                            ("/машина/держатель#2/*", ("#2/плита", "#2/левая гайка", "#2/ナット")), ("solid ?", ("solid 2", "solid 3"))):
            self.mesh_scene("glob", {"units": "mm", "grid": grid, "materials": {"air": {}, "steel": {}},
                                     "bodies": [{"mesh": "assembly.step", "part": part, "material": "steel"}]})
            self.assertEqual(self.cells("glob.tcell")["steel"], sum(n for path, n in by.items() if path.endswith(taken)), part)
        r = self.teracell("mesh", self.write("none.json", {"units": "mm", "materials": {"steel": {}}, "grid": grid, "bodies": [
            {"mesh": "assembly.step", "part": "болт", "material": "steel"}]}), "-o", "none.tcell")
        self.assert_refused(r, 1, ["assembly.step", "болт"])

    def test_names_are_those_of_occurrences_else_of_products_escaped_and_numbered(self):
        m = hostile.Model()
        escaped = lambda name: "\\X2\\" + name.encode("utf-16-be").hex().upper() + "\\X0\\"
        root, cube = m.product("root"), m.product(escaped("бр"), hostile.cube)
        twin, odd = m.product("twin", hostile.cube), m.product("a/b [1]*", hostile.cube)
        at = lambda x: m.axes((x, 0, 0))
        m.place(root, cube, at(0))
        m.place(root, cube, at(2), name=escaped("ナット"))
        for x, name in ((4, ""), (6, ""), (8, "twin"), (10, "twin#2")):
            m.place(root, twin, at(x), name=name)
        m.place(root, odd, at(12))
        m.place(root, odd, at(14), name="it''s; #1", identifier="17", description="not a name")
        self.write("names.step", m.text())
        self.run_ok("mesh", "names.step", "--by-part", "--step", 0.5, "-o", "g.tcell")
        names = list(self.cells("g.tcell"))[1:]
        self.assertEqual(names, ["/root/бр", "/root/ナット", "/root/twin", "/root/twin#3", "/root/twin#4", "/root/twin#2", r"/root/a\/b \[1]\*", "/root/it's; #1"])
        self.assertEqual(set(list(self.cells("g.tcell").values())[1:]), {8})
        self.run_ok("scene", "names.step", "--step", 0.5, "-o", "names.json")
        self.run_ok("mesh", "names.json", "-o", "again.tcell")
        self.assertEqual([b["part"] for b in self.read_json("names.json")["bodies"]], names)


class StepCache(StepCase):
    def test_what_is_kept_needs_no_kernel_and_what_changed_is_made_anew(self):
        copy, starts = self.logged_program()
        self.copy("cylinders")
        info = self.files_of("cylinders.step", program_path=copy)
        first = starts()
        self.assertGreaterEqual(first, 1)
        self.assertEqual(self.files_of("cylinders.step", program_path=copy), info)
        self.assertEqual(starts(), first)
        mesh = ("mesh", "cylinders.step", "--cells", 50, "-o")
        self.run_ok(*mesh, "a.tcell", program_path=copy)
        meshed = starts()
        self.assertGreater(meshed, first)  # its facets are others
        self.run_ok(*mesh, "b.tcell", program_path=copy)
        self.assertEqual(starts(), meshed)
        self.assertEqual(self.bytes("a.tcell"), self.bytes("b.tcell"))
        self.run_ok(*mesh, "c.tcell", "--tmp", ".", program_path=copy)
        self.assertGreater(starts(), meshed)
        self.assertEqual(self.bytes("a.tcell"), self.bytes("c.tcell"))
        meshed = starts()
        text = self.bytes("cylinders.step")
        changed = text.replace(b"CYLINDRICAL_SURFACE('',#", b"CYLINDRICAL_SURFACE('changed',#")
        self.assertNotEqual(changed, text)
        self.write("cylinders.step", changed)
        self.files_of("cylinders.step", program_path=copy)
        self.assertGreater(starts(), meshed)
        self.expect_no_kernels()

    def test_a_kernel_reads_a_file_once_in_a_run(self):
        copy, starts = self.logged_program()
        self.files_of("units", program_path=copy)  # what the kernel's version is, too
        first = starts()
        self.run_ok("mesh", model("assembly"), "--by-part", "--cells", 40, "-o", "a.tcell", program_path=copy)
        self.assertEqual(starts(), first + 1)

    def test_runs_at_once_give_the_same_bytes_and_leave_one_entry(self):
        def mesh(i):
            return self.run_ok("mesh", model("torus"), "--cells", 200, "--deflection", 0.005, "-o", f"{i}.tcell")
        with concurrent.futures.ThreadPoolExecutor(3) as pool:
            list(pool.map(mesh, range(3)))
        for i in (1, 2):
            self.assertEqual(self.bytes("0.tcell"), self.bytes(f"{i}.tcell"))
        self.assertEqual(sum(e.startswith(b"teracad") for e in self.entries().values()), 1)
        self.expect_no_kernels()

    def test_a_damaged_entry_is_made_again_at_once_or_by_the_next_run(self):
        mesh = ("mesh", model("cylinders"), "--cells", 50, "-o", "g.tcell")
        self.run_ok(*mesh)
        expected = self.bytes("g.tcell")
        for path, entry in self.entries().items():
            with open(path, "rb") as file:
                whole = file.read()
            facets = entry.startswith(b"teracad")
            places = [0, len(entry) // 2, len(whole) - 1]
            if facets:
                head = 16 + struct.unpack_from("<Q", entry, 8)[0]
                places += [8, 9, 15, 16, 20, head - 2, head + 7, len(entry) - 1, len(entry) - 12]
            damaged = [(f"byte {i} of {len(whole)}", whole[:i] + bytes([whole[i] ^ 0x15]) + whole[i + 1:]) for i in places]
            damaged += [(f"cut to {n} of {len(whole)}", whole[:n]) for n in (0, 10, 16, 17, len(whole) // 2, len(whole) - 1)]
            damaged.append(("longer", whole + b"more"))
            for how, contents in damaged:
                with self.subTest(entry=entry[:20], how=how):
                    with open(path, "wb") as file:
                        file.write(contents)
                    r = self.teracell(*mesh)
                    if r.status != 0:
                        self.assert_refused(r, 1, "cylinders.step")
                        r = self.teracell(*mesh)
                    said = r.err
                    if r.status != 0:  # so that other ways to damage it are tried, too
                        os.remove(path)
                        self.run_ok(*mesh)
                    self.assertEqual(r.status, 0, f"it is not made again: {said}")
                    self.assertEqual(self.bytes("g.tcell"), expected)

    def test_a_cache_that_can_not_be_written_is_done_without(self):
        mesh = ("mesh", model("cylinders"), "--cells", 50, "-o")
        self.run_ok(*mesh, "a.tcell")
        self.write("file", "")
        self.run_ok(*mesh, "b.tcell", env=dict(self.env, XDG_CACHE_HOME=self.path("file")))
        self.assertEqual(self.bytes("a.tcell"), self.bytes("b.tcell"))
        bare = {k: v for k, v in self.env.items() if k not in ("XDG_CACHE_HOME", "HOME")}
        self.run_ok(*mesh, "c.tcell", env=bare)
        self.assertEqual(self.bytes("a.tcell"), self.bytes("c.tcell"))
        self.assertEqual(set(os.listdir(self.folder)) - {"file", "cache"}, {"a.tcell", "b.tcell", "c.tcell"})


class StepKernel(StepCase):
    def test_hostile_files_end_in_one_line_within_the_limits_and_leave_nothing(self):
        os.mkdir(self.path("files"))
        files = hostile.hostile_files(self.path("files"))

        def info(file):
            began = time.monotonic()
            return file, self.teracell("info", "--json", "--cad-seconds", 5, "--cad-memory", "1G", file[0]), time.monotonic() - began
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for (path, what), r, seconds in pool.map(info, files):
                with self.subTest(os.path.basename(path), what=what):
                    self.assertLess(seconds, 12)
                    if r.status == 0:
                        for part in json.loads(r.out)["files"][0]["parts"]:
                            self.assertTrue(all(map(math.isfinite, part["box"])))
                    else:
                        self.assert_refused(r, 1, os.path.basename(path))
        self.entries()
        self.expect_no_kernels()

    def test_without_the_kernel_the_error_says_how_to_install_it(self):
        copy = self.program_with()
        env = dict(self.env, PATH="/usr/bin:/bin")
        for args in (["info", model("units")], ["mesh", model("units"), "--cells", 20, "-o", "g.tcell"], ["scene", model("units"), "-o", "s.json"]):
            r = self.teracell(*args, program_path=copy, env=env)
            self.assert_refused(r, 1, ["units.step", "teracell-step", "install"])
        self.assertFalse(os.path.exists(self.path("g.tcell")))
        os.mkdir(self.path("elsewhere"))
        os.symlink(KERNEL, self.path("elsewhere/teracell-step"))
        self.run_ok("info", model("units"), program_path=copy, env=dict(env, PATH=":/nowhere:" + self.path("elsewhere")))

    def test_a_kernel_that_crashes_talks_nonsense_or_ends_is_an_error_about_the_file(self):
        copy = self.program_with("exit 0\n")
        hello = "echo '{\"kernel\": \"K\"}'; "
        for number, (script, words) in enumerate((
                ("kill -SEGV $$", "signal 11"), ("exit 3", "status 3"), ("exit 0", "status 0"), ("echo nonsense; sleep 9", "nonsense"),
                ("echo '{\"error\": \"what I say\"}'", "what I say"), ("echo '{\"kernel\": 5}'; sleep 9", "kernel"),
                (hello + "echo '{\"outline\": []}'; sleep 9", "outline"), ("echo '[1]'; sleep 9", ""), (hello + "kill -ABRT $$", "signal 6"),
                (hello + "exec sleep 9", "--cad-seconds"))):
            with self.subTest(script):
                self.write("bin/teracell-step", "#!/bin/sh\n" + script.replace("K", str(number)) + "\n")
                r = self.teracell("mesh", model("units"), "--cells", 20, "--cad-seconds", 1, "-o", "g.tcell", program_path=copy)
                self.assert_refused(r, 1, ["units.step", words])
                self.entries()
                self.no_debris()
        self.write("bin/teracell-step", "no program")
        self.assert_refused(self.teracell("info", model("units"), program_path=copy), 1, ["units.step", "teracell-step"])

    def test_without_memory_no_face_is_left_out_neither_in_this_run_nor_in_the_next_one(self):
        mesh = ("mesh", model("assembly"), "--cells", 20, "--deflection", 1e-3, "--angle", 2, "-o", "g.tcell")
        r = self.teracell(*mesh, "--cad-memory", "150M")
        if r.status != 0:
            self.assert_refused(r, 1, ["assembly.step", "--cad-memory"])
        self.assertNotIn("made no facets", r.err)
        self.entries()
        self.no_debris()
        self.assertNotIn("made no facets", self.run_ok(*mesh).err)

    def start_long(self):
        """A run whose kernel is at work for a minute."""
        words = [program.PROGRAM, "mesh", model("sphere"), "--cells", "20", "--deflection", "0.0001", "-o", "g.tcell"]
        process = subprocess.Popen(words, cwd=self.folder, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        self.wait_until(lambda: glob.glob(self.cache + "/teracell/cad/*.cad-unfinished") or process.poll() is not None, "the making of facets", 60)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        self.assertEqual(len(self.kernels()), 1)
        return process

    def test_an_interrupted_run_ends_soon_with_its_kernel(self):
        process = self.start_long()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
        self.assertEqual((process.returncode, out), (130, ""), err)
        self.assertIn("interrupted", err.splitlines()[-1])
        self.assertEqual(self.kernels(), [])
        self.entries()
        self.no_debris()

    def test_a_killed_run_takes_its_kernel_along(self):
        process = self.start_long()
        process.kill()
        process.communicate(timeout=20)
        self.expect_no_kernels()

    def interrupted_soon(self, copy, *args):
        """Interrupts the program alone, while its kernel is at work. Returns the status."""
        process = subprocess.Popen([copy, *map(str, args)], cwd=self.folder, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        self.wait_until(self.kernels, "a kernel")
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=20)
        self.expect_no_kernels()
        self.no_debris()
        return process.returncode

    def test_a_kernel_that_hangs_ends_with_an_interrupted_run(self):
        copy = self.program_with("exec sleep 60\n")
        self.assertEqual(self.interrupted_soon(copy, "mesh", model("units"), "--cells", 20, "-o", "g.tcell"), 130)
        self.write("spindle.step", hostile.of(hostile.torus(1, 5)))
        self.assertIn(self.interrupted_soon(program.PROGRAM, "info", "spindle.step"), (130, -signal.SIGINT))

    def test_a_product_without_a_name_has_its_kind_and_number(self):
        m = hostile.Model()
        root = m.product("", identifier="")
        for name in ("", " ", "plate"):
            m.place(root, m.product(name, hostile.cube, identifier=name))
        self.write("blank.step", m.text())
        paths = [part["path"] for part in self.files_of("blank.step")[0]["parts"]]
        self.assertEqual(paths, ["/assembly 1/solid 1", "/assembly 1/solid 2", "/assembly 1/plate"])

    def test_a_pattern_that_matches_nothing_is_named_before_there_is_a_grid(self):
        self.write("s.json", json.dumps({"units": "mm", "grid": {"cells": 20}, "materials": {"air": {}, "a": {}}, "background": "air",
                                         "bodies": [{"mesh": model("torus"), "part": "nope*", "material": "a"}]}))
        self.assert_refused(self.teracell("mesh", "s.json", "-o", "g.tcell"), 1, ["torus.step", "no part matches 'nope*'", "1 part:"])

    def test_a_model_smaller_than_the_least_length_of_the_kernel_is_read(self):
        m = hostile.Model("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.NANO.,.METRE.))")
        m.product("tiny", lambda model: hostile.cube(model, size=100))
        self.write("tiny.step", m.text())
        self.assertEqual(self.files_of("tiny.step")[0]["parts"][0]["facets"], 12)

    def test_without_a_cache_that_can_be_used_every_command_works(self):
        self.write("file", b"")
        os.mkdir(self.path("line\nbreak"))
        for env in (dict(self.env, XDG_CACHE_HOME=self.path("file")), {k: v for k, v in self.env.items() if k not in ("HOME", "XDG_CACHE_HOME")}):
            self.run_ok("info", model("units"), env=env)
            self.run_ok("scene", model("units"), "-o", "s.json", "--force", env=env)
            self.run_ok("mesh", "s.json", "-o", "g.tcell", env=env)
            self.run_ok("mesh", model("units"), "--by-part", "--cells", "20", "-o", "g.tcell", env=env)
        r = self.teracell("mesh", model("units"), "--cells", "20", "--tmp", "line\nbreak", "-o", "h.tcell")
        self.assert_refused(r, 1, ["units.step", "line break"])
        self.assertEqual([name for name in os.listdir(self.path("line\nbreak/teracell-cad")) if not name.endswith((".cad", ".cad-lock"))], [])
        self.assertFalse(os.path.exists(self.path("line")))

    def test_a_compressed_file_is_the_same_file_and_a_pipe_is_refused(self):
        self.copy("cylinders")
        self.write("cylinders.step.gz", gzip.compress(self.bytes("cylinders.step")))
        plain, packed = self.files_of("cylinders.step", "cylinders.step.gz")
        self.assertEqual(plain["parts"], packed["parts"])
        self.assertEqual(plain["unit"], packed["unit"])
        self.run_ok("mesh", "cylinders.step.gz", "--cells", 40, "-o", "a.tcell")
        self.run_ok("mesh", "cylinders.step", "--cells", 40, "-o", "b.tcell")
        self.assertEqual(*[list(self.cells(g).values()) for g in ("a.tcell", "b.tcell")])
        os.mkfifo(self.path("pipe"))
        for args in (["info", "pipe"], ["mesh", "pipe", "--cells", 20, "-o", "g.tcell"]):
            with subprocess.Popen(["cp", self.path("cylinders.step"), self.path("pipe")], stderr=subprocess.DEVNULL) as feed:
                self.assert_refused(self.teracell(*args), 1, ["pipe", "expected a file", "STEP"])
                feed.kill()

"""Open surfaces of any shape are closed by caps and described in words. RealSurfaces does the same with surfaces from elsewhere."""
import math
import os
import pathlib
import subprocess
import sys
import unittest

import solids
from program import PROGRAM, Case, teracell

BOX = solids.box_facets((0.0, 0.0, 0.0), (4.0, 3.0, 2.0))
LARGE, SMALL = ((-3.0, -3.0, -3.0), (3.0, 3.0, 3.0)), ((-1.0, -1.0, -2.0), (1.0, 1.0, 2.0))
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/bench"))
from common import MESHES  # noqa: E402


def pipe(n, radius):
    p = [(radius * math.cos(2 * math.pi * i / n), radius * math.sin(2 * math.pi * i / n)) for i in range(n)]
    return [f for a, b in zip(p, p[1:] + p[:1]) for f in (((*a, -3), (*b, -3), (*b, 3)), ((*a, -3), (*b, 3), (*a, 3)))]


def moebius(n):
    def across(i):
        t = 2 * math.pi * i / n
        return tuple(((3 + s * math.cos(t / 2)) * math.cos(t), (3 + s * math.cos(t / 2)) * math.sin(t), s * math.sin(t / 2)) for s in (-1, 1))
    v = [across(i) for i in range(n)]
    v.append(v[0][::-1])
    return [f for a, b in zip(v, v[1:]) for f in ((a[0], b[0], b[1]), (a[0], b[1], a[1]))]


def checkered(n):
    """A box without every other square of its top. The holes touch at corners, and along the rim vertices lie on edges."""
    lo, hi = LARGE
    at = lambda i, j: (lo[0] + 6 * i / n, lo[1] + 6 * j / n, hi[2])
    squares = [(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)) for i in range(n) for j in range(n) if (i + j) % 2 == 0]
    return [f for f in solids.box_facets(lo, hi) if {v[2] for v in f} != {hi[2]}] + [f for a, b, c, d in squares for f in ((a, b, c), (a, c, d))]


FAN = [((0, 0, -3), (0.1, 0.2, 3), (4 * math.cos(1.2 * k), 4 * math.sin(1.2 * k), 0.3 * k)) for k in range(5)]
INNER = solids.box_facets(*SMALL)
TORN = {
    "holes that touch": checkered(6),
    "a Moebius strip": moebius(30),
    "five facets on one edge": FAN,
    "five facets on one edge, three times each": FAN * 3,
    "an open shell in a closed one": solids.box_facets(*LARGE) + [solids.flip(f) for f in INNER[:-2]],
    "an open shell with a flip in a closed one": solids.box_facets(*LARGE) + [solids.flip(INNER[0])] + INNER[1:-2],
    "a pipe, both ends open": pipe(24, 4) + [solids.flip(f) for f in pipe(24, 2)],
    "a pipe in a pipe, both the same way round": pipe(24, 4) + pipe(24, 2),
    "a single triangle": [((-3.0, -3.0, -3.0), (3.0, -2.0, 0.0), (0.0, 4.0, 3.0))],
    "facets without area": [((0, 0, 0), (1, 1, 1), (2, 2, 2)), ((0, 0, 0), (0, 0, 0), (2, 2, 2)), ((1, 1, 1),) * 3],
    "a facet three times": solids.box_facets(*LARGE) + solids.box_facets(*LARGE)[:1] * 2,
    "both ways round, one facet missing": solids.box_facets(*LARGE)[1:] + [solids.flip(f) for f in solids.box_facets(*LARGE)],
}


class OpenSurfaces(Case):
    def cells(self, mesh, fill, *args, memory="1G"):
        self.write("s.json", {"grid": {"min": [-5.3, -5.1, -5.2], "max": [5.3, 5.1, 5.2], "cells": [26, 25, 24]}, "materials": {"m": {}},
                              "bodies": [{"mesh": mesh, "material": "m", "fill": fill}]})
        self.run_ok("mesh", "s.json", "-o", "g.tcell", "--memory", memory, *args)
        return self.export("g.tcell")[1]

    def test_torn_surfaces_have_the_cells_of_surface_and_caps_for_every_axis_and_the_same_file_for_every_memory(self):
        for name, facets in TORN.items():
            self.write("s.ply", solids.ply_of(facets))
            for fill in ("nonzero", "evenodd", "auto"):
                with self.subTest(name, fill=fill):
                    expected = self.cells("s.ply", fill, "--axis", "z", "--write-caps", "caps.ply")
                    for axis in "xyz":
                        self.assertEqual(self.cells("s.ply", fill, "--axis", axis), expected)
                        file = self.bytes("g.tcell")
                        self.assertEqual(self.cells("s.ply", fill, "--axis", axis, memory="1K"), expected)
                        self.assertEqual(self.bytes("g.tcell"), file)
                    caps = solids.read_facets(self.bytes("caps.ply")) if os.path.exists(self.path("caps.ply")) else []
                    if fill == "nonzero":
                        self.assertEqual(solids.open_edges(facets + caps), {})
                    self.write("whole.ply", solids.ply_of(facets + caps))
                    self.assertEqual(self.cells("whole.ply", fill), expected)
                    self.assertEqual(self.json_of("info", "g.tcell")["report"]["bodies"][0]["holes"], [])
                    if caps:
                        os.unlink(self.path("caps.ply"))
        self.no_debris()

    def test_caps_of_several_bodies_never_replace_an_input(self):
        for name in ("a.stl", "caps-a.stl"):
            self.write(name, solids.binary_stl(BOX[:-1]))
        before = self.bytes("caps-a.stl")
        self.refused(2, ["caps-a.stl", "overwritten"], "mesh", "a.stl", "caps-a.stl", "--cells", 20, "-o", "z.tcell", "--write-caps", "caps.stl")
        self.assertEqual(self.bytes("caps-a.stl"), before)

    def test_a_surface_from_a_pipe_that_does_not_fit_into_memory(self):
        self.write("box.stl", solids.binary_stl(BOX))
        command = f"{PROGRAM} mesh <(cat box.stl) --cells 10 -o z.tcell"
        run = lambda *more: subprocess.run(["bash", "-c", " ".join([command, *more])], cwd=self.folder, capture_output=True, timeout=60)
        self.assertEqual(run().returncode, 0)
        refused = run("--memory", "1K")
        self.assertEqual(refused.returncode, 1)
        self.assertIn(b"read twice", refused.stderr)

    def test_two_overlapping_boxes_one_facet_flipped_are_their_union(self):
        boxes = (((0.25, 0.25, 0.25), (3.25, 3.25, 3.25)), ((1.25, 1.25, 1.25), (5.25, 4.25, 6.25)))
        axes = [solids.centres(-1, 0.5, n) for n in (14, 14, 16)]
        expected = solids.cells_of(axes, [(*box, 1) for box in boxes])
        for flipped in range(0, 24, 5):
            facets = [f for box in boxes for f in solids.box_facets(*box)]
            facets[flipped] = solids.flip(facets[flipped])
            self.write("two.stl", solids.binary_stl(facets))
            self.write("s.json", {"grid": {"min": [-1, -1, -1], "max": [6, 6, 7], "step": 0.5}, "materials": {"m": {}}, "bodies": [{"mesh": "two.stl", "material": "m"}]})
            self.run_ok("mesh", "s.json", "-o", "g.tcell")
            self.assertEqual(self.export("g.tcell"), ((16, 14, 14), expected), flipped)

    def test_extreme_coordinates_are_meshed_or_refused(self):
        for factor in (1e74, 1e-73):
            self.write("s.ply", solids.ply_of([tuple(tuple(x * factor for x in v) for v in f) for f in BOX[1:]]))
            self.run_ok("mesh", "s.ply", "--cells", 10, "--pad", 0, "-o", "g.tcell")
            self.assertEqual(self.export("g.tcell")[1].count(1), 10 * 7 * 5)
        self.write("s.ply", solids.ply_of([tuple(tuple(x * 1e75 for x in v) for v in f) for f in BOX[1:]]))
        self.refused(1, ["s.ply", "1e75"], "mesh", "s.ply", "--cells", 10, "-o", "x.tcell")

    def told(self, name, contents, *args):
        """(stderr of mesh, output of info)."""
        self.write(name, contents)
        err = self.run_ok("mesh", name, "--cells", 42, "-o", "g.tcell", *args).err
        return err, self.run_ok("info", "g.tcell").out

    def test_a_hole_is_described_in_words_and_cells(self):
        err, info = self.told("box.stl", solids.binary_stl(BOX[:-2]))
        for phrase in ("body 'box' is open: it has 1 hole (4 edges), closed by a cap of 6 m²", "3.606 m (36.1 cells) across, with a gap of 2.4 m (24 cells), at (4, 1.5, 1)", "whether it should be open"):
            self.assertIn(phrase, err)
        self.assertNotIn("terrain", err)
        self.assertRegex(info, r"holes +3\.606 m across \(36\.1 cells\), gap 2\.4 m \(24 cells\), at \(4, 1\.5, 1\), 4 edges, cap of 6 m²\n")
        self.assertRegex(info, r"inside +of 1 shell: where the surface winds around \(nonzero: facets are oriented alike\)\n")

    def test_a_hole_below_two_cells_is_harmless_and_only_the_largest_are_listed(self):
        spikes = [solids.box_facets((x, 0.0, 0.0), (x + 0.05, 0.05, 0.05))[:-2] for x in range(6, 13)]
        err, info = self.told("box.stl", solids.binary_stl(BOX + [f for s in spikes for f in s]), "--stitch", 0)
        self.assertIn("7 holes (28 edges), closed by caps", err)
        self.assertIn("narrower than 2 cells, so the caps are harmless", err)
        self.assertEqual(info.count(" m across ("), 5)
        self.assertRegex(info, r"and 2 more, none wider than 0\.070\d+ m\n")

    def test_flips_and_duplicates_are_described(self):
        err, info = self.told("flip.stl", solids.binary_stl([solids.flip(BOX[0])] + BOX[1:] + BOX[5:6] * 2))
        self.assertIn("face the opposite way from their neighbours", err)
        self.assertIn("2 duplicate facets, and shells whose inside is decided by parity", err)
        self.assertRegex(info, r"inside +of 1 shell: where a ray out passes the surface an odd number of times \(evenodd")
        self.assertRegex(info, r"flips +neighbours face opposite ways along 6 edges at \(0, 0, 2\)")
        self.assertRegex(info, r"duplicates +2 facets with the vertices of an earlier one: 2 the same way round, 0 the other way\n")
        err, info = self.told("twice.stl", solids.binary_stl(BOX * 2 + [(BOX[0][0], BOX[0][1], BOX[0][0])]))
        self.assertEqual(err, "")
        self.assertRegex(info, r"duplicates +12 facets with the vertices of an earlier one: 12 the same way round, 0 the other way\n")
        self.assertRegex(info, r"degenerate +1 facet without area: they change nothing")

    def test_loose_facets_are_distinguished_from_holes(self):
        err, _ = self.told("soup.stl", solids.binary_stl([tuple((v[0] + 5 * i, v[1], v[2]) for v in f) for i, f in enumerate(BOX)]))
        self.assertIn("No two facets share an edge, so they enclose nothing", err)


@unittest.skipUnless(os.path.isdir(MESHES), "no shared/meshes beside the project")
class RealSurfaces(Case):
    def mesh_of(self, name):
        return pathlib.Path(MESHES, name)

    def test_every_surface_is_meshed_or_refused_in_words(self):
        paths = [path for path in pathlib.Path(MESHES).rglob("*") if path.is_file() and path.suffix != ".md"]
        for path in paths:
            r = teracell("mesh", path, "--cells", 100, "-o", "g.tcell", cwd=self.folder)
            if path.name.startswith("empty"):
                self.assert_refused(r, 1, "holds no facet")
                continue
            self.assertEqual(r.status, 0, f"{path}: {r.err}")
            self.run_ok("verify", "g.tcell")
            report = self.json_of("info", "g.tcell")["report"]
            body = report["bodies"][0]
            broken = body["holes"] or body["flips"] or body["seams"]["number"]
            self.assertEqual(len(report["warnings"]) > 0, bool(broken), path)
            told = "".join(f"warning: {w}\n" for w in report["warnings"])
            self.assertEqual(r.err[:len(told)], told)  # then at most one warning that the file doesn't hold, because it comes from sums that round
            self.assertRegex(r.err[len(told):], r"^(warning: body '.*': look at its caps\. .*\n)?$")

    def test_the_bunny_with_its_caps_is_closed_and_has_the_same_cells_and_volume(self):
        bunny = self.mesh_of("broken/bunny.ply")
        self.refused(1, ["'bunny' is not closed", "223 edges", '"closing": "cap"'], "mesh", bunny, "--cells", 300, "--closing", "strict", "-o", "x.tcell")
        self.run_ok("mesh", bunny, "--cells", 300, "--write-caps", "caps.stl", "-o", "open.tcell")
        holes = self.json_of("info", "open.tcell")["report"]["bodies"][0]["holes"]
        caps = solids.read_facets(self.bytes("caps.stl"))
        self.assertEqual((len(holes), sum(h["edges"] for h in holes), len(caps)), (5, 223, 223))
        whole = solids.binary_stl(solids.read_facets(bunny.read_bytes()) + caps)
        self.write("whole.stl", whole)
        whole = solids.read_facets(whole)
        self.assertEqual(solids.open_edges(whole), {})
        self.assertEqual(self.run_ok("mesh", "whole.stl", "--cells", 300, "-o", "whole.tcell", "--closing", "strict").err, "")
        self.run_ok("export", "open.tcell", "-o", "open.raw")
        self.run_ok("export", "whole.tcell", "-o", "whole.raw")
        self.assertEqual(self.bytes("open.raw"), self.bytes("whole.raw"))
        volume = self.json_of("stats", "open.tcell")["materials"][1]["volume"]
        self.assertAlmostEqual(volume / abs(solids.volume(whole)), 1, delta=0.003)  # its facets face inwards

    def test_caps_in_doubles_need_ply(self):
        obj = "\n".join(self.mesh_of("rocker-arm.obj").read_text().split("\n")[:-40])
        self.write("open.obj", obj)
        self.refused(2, ["'open'", ".ply"], "mesh", "open.obj", "--cells", 60, "-o", "x.tcell", "--write-caps", "caps.stl")
        self.run_ok("mesh", "open.obj", "--cells", 60, "-o", "open.tcell", "--write-caps", "caps.ply")
        facets = solids.read_facets(obj.encode()) + solids.read_facets(self.bytes("caps.ply"))
        self.assertEqual(solids.open_edges(facets), {})
        self.write("whole.ply", solids.ply_of(facets))
        self.run_ok("mesh", "whole.ply", "--cells", 60, "-o", "whole.tcell", "--closing", "strict")
        self.assertEqual(self.export("open.tcell"), self.export("whole.tcell"))

    def assert_same_bytes(self, name, option, values, *args):
        files = []
        for value in values:
            self.run_ok("mesh", self.mesh_of(name), option, value, *args, "-o", "g.tcell")
            files.append(self.bytes("g.tcell"))
        self.assertEqual([f == files[0] for f in files], [True] * len(values), (name, args))

    def test_every_engine_writes_the_same_bytes(self):
        for name in ("rocker-arm.obj", "broken/bunny.ply", "gears.stl"):
            for axis in "yz":
                self.assert_same_bytes(name, "--engine", ("scan", "tree", "slice", "brute"), "--cells", 100, "--axis", axis)

    def test_little_memory_writes_the_same_bytes(self):
        for name in ("rocker-arm.obj", "broken/bunny.ply", "gears.stl", "broken/featuretype.STL"):
            self.assert_same_bytes(name, "--memory", ("1G", "4M", "1K"), "--cells", 200)

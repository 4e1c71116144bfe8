"""Differences of two grids from the outside: held against exported cells, for all axes of rays, and what is said when they can't be compared."""
import collections
import itertools
import os

import solids
from program import Case

PLANES = [0, 0.5, 1, 2, 2.5, 4, 5]


class Diff(Case):
    def setUp(self):
        super().setUp()
        self.write("one.stl", solids.binary_stl(solids.box_facets((1.0, 1.0, 1.0), (4.0, 3.0, 2.0))))
        self.write("two.stl", solids.binary_stl(solids.box_facets((2.0, 0.5, 0.5), (4.5, 2.5, 2.5))))

    def mesh(self, name, bodies, axis, **grid):
        """A grid of bodies [(mesh, material)], with graded cells along x."""
        self.write("s.json", {"grid": {"min": [0, 0, 0], "max": [5, 4, 3], "cells": [6, 16, 12], "x": {"planes": PLANES}, **grid}, "units": "mm",
                              "materials": {n: {} for _, n in bodies},
                              "bodies": [{"mesh": m, "material": n} for m, n in bodies]})
        self.run_ok("mesh", "s.json", "-o", name, "--axis", axis)
        return name

    def names_of(self, grid):
        """The material of every cell, by name, and the shape."""
        shape, cells = self.export(grid)
        names = [m["name"] for m in self.json_of("info", grid)["materials"]]
        return shape, [names[c] for c in cells]

    def by_cells(self, a, b):
        (nz, ny, nx), of_a = self.names_of(a)
        found = collections.defaultdict(list)
        for (z, y, x), from_, to in zip(itertools.product(range(nz), range(ny), range(nx)), of_a, self.names_of(b)[1]):
            if from_ != to:
                found[from_, to].append((x, y, z))
        box = lambda cells: [min(c[d] for c in cells) for d in range(3)] + [max(c[d] for c in cells) + 1 for d in range(3)]
        return nx * ny * nz, {pair: (len(cells), box(cells)) for pair, cells in found.items()}

    def test_changes_are_those_of_the_cells_for_all_axes(self):
        for axis_a, axis_b in itertools.product("xyz", repeat=2):
            a = self.mesh("a.tcell", [("one.stl", "steel"), ("two.stl", "brass")], axis_a)
            b = self.mesh("b.tcell", [("two.stl", "brass"), ("one.stl", "wood")], axis_b)
            told = self.json_of("diff", a, b, "-o", "d.tcell")
            cells, expected = self.by_cells(a, b)
            self.assertEqual({(c["from"], c["to"]): (c["cells"], c["box"]) for c in told["changes"]}, expected)
            self.assertEqual((told["schema"], told["cells"], told["same"]), (1, cells, cells - sum(n for n, _ in expected.values())))
            self.assertEqual([c["cells"] for c in told["changes"]], sorted((c["cells"] for c in told["changes"]), reverse=True))
            self.run_ok("verify", "d.tcell")
            pairs = [f"{x} → {y}" if x != y else "same" for x, y in zip(self.names_of(a)[1], self.names_of(b)[1])]
            self.assertEqual(self.names_of("d.tcell")[1], pairs)
            self.assertEqual(self.json_of("info", "d.tcell")["ray_axis"], axis_a)
        self.assertIn("steel → wood", self.run_ok("info", "d.tcell").out)
        self.run_ok("diff", self.path(a), self.path(b), "-o", "d.tcell")
        self.assertEqual([i["path"] for i in self.json_of("info", "d.tcell")["report"]["inputs"]], [a, b], "without folders of the machine")
        self.no_debris()

    def test_the_table_and_equal_grids(self):
        a = self.mesh("a.tcell", [("one.stl", "steel")], "z")
        b = self.mesh("b.tcell", [("one.stl", "steel")], "x")
        self.assertEqual(self.run_ok("diff", a, b).out, "the grids are equal: all of 1,152 cells have the same material in both\n")
        self.assertEqual(self.json_of("diff", a, b), {"schema": 1, "cells": 1152, "same": 1152, "changes": []})
        self.run_ok("diff", a, b, "-o", "d.tcell")
        self.assertEqual([m["name"] for m in self.json_of("info", "d.tcell")["materials"]], ["same"])
        c = self.mesh("c.tcell", [("two.stl", "steel")], "y")
        told = self.run_ok("diff", a, c, "--threads", 3).out.splitlines()
        self.assertRegex(told[0], r"^[\d,]+ of 1,152 cells differ, [\d,]+ are the same$")
        self.assertRegex(told[1], r"^from +to +cells +box of cells$")
        self.assertEqual(len(told), 4)
        self.assertRegex(told[2], r"^(air|steel) +(steel|air) +\d+   \(\d+, \d+, \d+\) to \(\d+, \d+, \d+\)$")

    def test_grids_of_other_cells(self):
        a = self.mesh("a.tcell", [("one.stl", "steel")], "z")
        for phrases, grid in (
                (["b.tcell", "a.tcell", "line 3 across x", "expected it at 2 mm, found it at 1.5 mm"], {"x": {"planes": [0, 0.5, 1, 1.5, 2.5, 4, 5]}}),
                (["expected 6 cells along x, found 7"], {"x": {"planes": [*PLANES, 6]}}),
                (["line 1 across y", "0.25 mm", "0.2 mm"], {"cells": [6, 20, 12]}),
                (["line 0 across z", "at 0 mm", "at -1 mm"], {"min": [0, 0, -1]})):
            b = self.mesh("b.tcell", [("one.stl", "steel")], "x", **grid)
            self.refused(1, phrases, "diff", a, b, "-o", "d.tcell")

    def test_wrong_usage(self):
        a = self.mesh("a.tcell", [("one.stl", "steel")], "z")
        b = self.mesh("b.tcell", [("two.stl", "steel")], "z")
        self.refused(2, "second", "diff", a)
        self.refused(2, "overwritten", "diff", a, b, "-o", b)
        self.refused(2, "overwritten", "diff", a, b, "-o", a)
        self.refused(2, ["--threads", "1 to 1024"], "diff", a, b, "--threads", 0)
        self.refused(1, "nowhere.tcell", "diff", a, "nowhere.tcell")
        self.refused(1, "one.stl", "diff", a, "one.stl")
        self.refused(1, "nowhere/d.tcell", "diff", a, b, "-o", "nowhere/d.tcell")
        self.refused(1, ["nowhere", "--tmp"], "diff", a, b, "-o", "d.tcell", "--tmp", "nowhere")

    def test_a_damaged_grid_is_named(self):
        a = self.mesh("a.tcell", [("one.stl", "steel")], "z")
        b = self.mesh("b.tcell", [("two.stl", "steel")], "x")
        whole = self.bytes(b)
        self.write("d.tcell", whole[:36] + bytes([whole[36] ^ 64]) + whole[37:])
        self.refused(1, ["d.tcell", "chunk"], "diff", a, "d.tcell")
        self.refused(1, ["d.tcell", "chunk"], "diff", "d.tcell", a, "-o", "e.tcell")

    def test_ctrl_c_leaves_nothing(self):
        for name, mesh in (("a", "one.stl"), ("b", "two.stl")):
            grid = {"min": [0, 0, 0], "max": [5, 4, 3], "cells": [16000, 16000, 16000]}
            self.write("s.json", {"grid": grid, "materials": {"steel": {}}, "bodies": [{"mesh": mesh, "material": "steel"}]})
            self.run_ok("mesh", "s.json", "-o", f"{name}.tcell", "--axis", "z" if name == "a" else "x")
        self.interrupt(["diff", "a.tcell", "b.tcell", "-o", "d.tcell", "--progress", "plain", "--threads", 1], lambda process: process.stderr.read(1))
        self.assertFalse(os.path.exists(self.path("d.tcell")))

"""Scene files: graded axes, priorities, labels by body, transforms, sample points, parts."""
import os

import solids
from program import Case, teracell

A, B = ((0.0, 0.0, 0.0), (4.0, 4.0, 4.0)), ((2.0, 1.0, 1.0), (6.0, 3.0, 5.0))


class Scenes(Case):
    def setUp(self):
        super().setUp()
        self.write("a.stl", solids.binary_stl(solids.box_facets(*A)))
        self.write("b.obj", solids.obj(*B))

    def mesh(self, bodies, grid=None, **more):
        scene = {"units": "mm", "grid": grid or {"min": [-1, -1, -1], "max": [7, 5, 6], "step": 0.5},
                 "materials": {"air": {"color": "#00000000"}, "steel": {"color": "#8899aa"}, "oil": {"color": "#aa7700"}}, "bodies": bodies, **more}
        self.write("s.json", scene)
        return self.run_ok("mesh", "s.json", "-o", "g.tcell")

    def assert_cells(self, boxes, axes=None):
        axes = axes or [solids.centres(-1, 0.5, n) for n in (16, 12, 14)]
        self.assertEqual(self.export("g.tcell"), (tuple(len(axes[d]) for d in (2, 1, 0)), solids.cells_of(axes, boxes)))

    def test_the_higher_priority_wins_and_at_equal_priority_the_later_body(self):
        a, b = {"mesh": "a.stl", "material": "steel"}, {"mesh": "b.obj", "material": "oil"}
        of_a, of_b = (*A, 1), (*B, 2)
        for bodies, weakest_first in (([a, b], [of_a, of_b]), ([b, a], [of_b, of_a]), ([{**a, "priority": 1}, b], [of_b, of_a]),
                                      ([a, {**b, "priority": -3}], [of_b, of_a])):
            self.mesh(bodies)
            self.assert_cells(weakest_first)

    def test_a_body_of_the_background_cuts_a_hole_but_ranks_last_on_coarse_levels(self):
        self.mesh([{"mesh": "a.stl", "material": "steel"}, {"mesh": "b.obj", "material": "air", "priority": 5}])
        self.assert_cells([(*A, 1), (*B, 0)])
        self.assertEqual(self.export("g.tcell", "--level", 4), ((1, 1, 1), b"\x01"))

    def test_labels_by_body_give_the_same_materials(self):
        bodies = [{"name": "left", "mesh": "a.stl", "material": "steel"}, {"name": "right", "mesh": "b.obj", "material": "steel"}]
        self.mesh(bodies)
        alike = [self.export("g.tcell", "--level", level) for level in range(5)]
        column = self.json_of("column", "g.tcell", "--axis", "x", "--at", "5,6")
        stats = self.json_of("stats", "g.tcell")
        self.mesh(bodies, label_by="body")
        self.assertEqual([self.export("g.tcell", "--level", level) for level in range(5)], alike)
        self.assertEqual(self.json_of("column", "g.tcell", "--axis", "x", "--at", "5,6"), column, "runs of one material are joined")
        self.assertEqual(self.json_of("stats", "g.tcell"), stats)
        self.run_ok("verify", "g.tcell")

    def test_bare_surfaces_at_absolute_paths_give_the_same_bytes_from_every_folder(self):
        for folder, box in (("one", A), ("two", B)):
            os.makedirs(self.path(folder))
            self.write(f"{folder}/a.stl", solids.binary_stl(solids.box_facets(*box)) + bytes(9))
        mesh = ["mesh", self.path("one/a.stl"), self.path("two/a.stl"), "--cells", 9]
        said = "warning: a.stl: 9 bytes after the last facet were skipped"
        for folder in (".", "one"):
            whole = teracell(*mesh, "-o", "g.tcell", cwd=self.path(folder))
            self.assertEqual((whole.status, whole.err.splitlines()[:2]), (0, [said, said]), "a warning for each of two files")
        self.assertEqual(self.bytes("g.tcell"), self.bytes("one/g.tcell"))
        for i, folder in enumerate((".", "two")):
            self.assertEqual(teracell(*mesh, "--shard", f"{i}/2", "-o", self.path("m.tcell"), cwd=self.path(folder)).status, 0)
        self.run_ok("merge", "m.tcell.shard-0-of-2", "m.tcell.shard-1-of-2", "-o", "m.tcell")
        self.assertEqual(self.bytes("m.tcell"), self.bytes("g.tcell"))

    def test_no_report_tells_a_folder_of_the_machine(self):
        for path in ("a.stl", self.path("a.stl"), self.path("./a.stl")):
            self.mesh([{"name": "a", "mesh": path, "material": "steel"}])
            report = self.json_of("info", "g.tcell")["report"]
            self.assertEqual([report["inputs"][0]["path"], report["scene"]["bodies"][0]["mesh"]], ["a.stl", "a.stl"])
        for scene, surfaces in ((self.path("s.json"), []), (None, [self.path("a.stl"), self.path("b.obj")])):
            if scene:
                self.write("s.json", {"grid": {"cells": 9}, "materials": {"steel": {}}, "bodies": [{"mesh": self.path("a.stl"), "material": "steel"}]})
            self.run_ok("mesh", *([scene] if scene else [*surfaces, "--cells", 9]), "-o", self.path("h.tcell"), "--report", "r.json")
            for text in (self.run_ok("info", "h.tcell").out, self.run_ok("info", "h.tcell", "--json").out, self.bytes("r.json").decode()):
                self.assertNotIn(self.folder, text)

    def test_statistics_by_body_where_bodies_are_kept_apart(self):
        bodies = [{"name": "left", "mesh": "a.stl", "material": "steel"}, {"name": "right", "mesh": "b.obj", "material": "steel"}]
        self.mesh(bodies)
        self.refused(2, ['"label_by": "body"', "keeps materials"], "stats", "g.tcell", "--bodies")
        cells = {}
        for name, only in (("left", bodies[:1]), ("right", bodies[1:])):
            self.mesh(only)
            cells[name] = self.json_of("stats", "g.tcell")["materials"][1]
        self.mesh(bodies, label_by="body")
        found = self.json_of("stats", "g.tcell", "--bodies")
        self.assertEqual(found["materials"], self.json_of("stats", "g.tcell")["materials"])
        self.assertEqual([(b["name"], b["material"]) for b in found["bodies"]], [("", 0), ("left", 1), ("right", 1)])
        self.assertEqual(found["bodies"][2]["cells"], cells["right"]["cells"], "the later body wins")
        self.assertEqual(found["bodies"][1]["cells"] + found["bodies"][2]["cells"], found["materials"][1]["cells"])
        text = self.run_ok("stats", "g.tcell", "--bodies").out
        self.assertIn("left: steel", text)
        self.assertIn("right: steel", text)
        self.mesh(bodies, label_by="overlap")
        apart = self.json_of("stats", "g.tcell", "--bodies")["bodies"]
        self.assertEqual([(b["name"], b.get("overlap", False)) for b in apart], [("", False), *((n, o) for n in ("left", "right") for o in (False, True))])
        for i, body in ((1, 1), (3, 2)):
            self.assertEqual(apart[i]["cells"] + apart[i + 1]["cells"], found["bodies"][body]["cells"])
        common = self.json_of("info", "g.tcell")["report"]["overlaps"]["list"]
        self.assertEqual([apart[2]["cells"], apart[4]["cells"]], [0, common[0]["cells"]], "of two bodies the later one owns what both hold")
        self.assertIn("right, in others too: steel", self.run_ok("stats", "g.tcell", "--bodies").out)
        self.run_ok("verify", "g.tcell")
        self.refused(2, ["links", '"overlap"'], "mesh", "s.json", "--links", "-o", "h.tcell")

    def test_graded_axes(self):
        x, y = [-1, 0, 0.25, 1, 2.5, 3, 6, 6.5], [-2.0, 0.5, 1, 1.5, 7]
        self.write("y.txt", "# planes of y\n-2, 0.5 1\n1.5\t7 # the last\n")
        bodies = [{"mesh": "a.stl", "material": "steel"}, {"mesh": "b.obj", "material": "oil"}]
        self.mesh(bodies, {"min": [0, 0, -1], "max": [0.5, 0.5, 6], "step": 0.5, "x": {"planes": x}, "y": {"planes_file": "y.txt"}})
        axes = [solids.graded_centres(x), solids.graded_centres(y), solids.centres(-1, 0.5, 14)]
        self.assert_cells([(*A, 1), (*B, 2)], axes)
        info = self.json_of("info", "g.tcell")["grid"]
        self.assertEqual(info["axes"][0], {"type": "graded", "planes": x})
        self.assertEqual(info["axes"][1], {"type": "graded", "planes": y})
        self.assertEqual((info["min"], info["max"], info["cells"]), ([-1, -2, -1], [6.5, 7, 6], [7, 4, 14]))
        for at, index in ((-1, 0), (0.25, 2), (0.2499, 1), (2.99, 4), (6.5, 6)):
            self.assertEqual(self.slice_npy("g.tcell", "--axis", "x", "--at", at), self.slice_npy("g.tcell", "--axis", "x", "--index", index), at)
        run = self.json_of("column", "g.tcell", "--axis", "x", "--at", "2,6")["runs"][1]
        self.assertEqual((run["min"], run["max"]), (x[run["from"]], x[run["to"]]))
        shape, cells = self.export("g.tcell")
        volume = [0.0] * 3
        for i, m in enumerate(cells):
            k, j = i % 7, i // 7 % 4
            volume[m] += (x[k + 1] - x[k]) * (y[j + 1] - y[j]) * 0.5
        for m in self.json_of("stats", "g.tcell")["materials"]:
            self.assertAlmostEqual(m["volume"], volume[m["id"]])

    def made(self, *options, **auto):
        """Meshes both boxes with planes made; returns the planes of each axis."""
        self.mesh([{"name": "a", "mesh": "a.stl", "material": "steel"}, {"name": "b", "mesh": "b.obj", "material": "oil"}],
                  {"auto": {"finest": 0.25, "coarsest": 2, "pad": 1, **auto}})
        return [axis["planes"] for axis in self.json_of("info", "g.tcell")["grid"]["axes"]]

    def test_planes_are_made_from_flat_faces(self):
        for d, planes in enumerate(self.made(growth=1.5)):
            faces = {v for box in (A, B) for corner in box for v in (corner[d],)}
            self.assertLessEqual(faces, set(planes))
            widths = [hi - lo for lo, hi in zip(planes, planes[1:])]
            self.assertGreaterEqual(min(widths), 0.25 - 1e-9)
            self.assertLessEqual(max(max(a / b, b / a) for a, b in zip(widths, widths[1:])), 1.5 + 1e-9)
        info = self.json_of("info", "g.tcell")
        self.assertEqual(info["planes"]["breaches"], [])
        self.assertLessEqual(info["planes"]["largest_ratio"], 1.5 + 1e-9)
        self.assertEqual([(min(ends), max(ends)) for ends in zip(info["grid"]["min"], info["grid"]["max"])], [(-2, 8), (-2, 6), (-2, 7)])
        stats = self.json_of("stats", "g.tcell")["materials"]
        self.assertAlmostEqual(stats[1]["volume"] + stats[2]["volume"], 64 + 4 * 2 * 4 - 2 * 2 * 3)

    def test_faces_that_are_too_near_and_rules_that_collide_are_told(self):
        self.write("b.obj", solids.obj((4.1, 0, 0), (5, 4, 4)))
        planes = self.made()
        self.assertIn(4.0, planes[0])
        self.assertNotIn(4.1, planes[0])
        self.assertIn("axis x: no plane for a face of body 'b' at 4.1: it is 0.1 mm from a face of body 'a' at 4", self.run_ok("info", "g.tcell").out)
        self.made(fixed={"x": [1, 1.25, 1.7]}, growth=1.2, resolution={"b": {"across": 4}})
        info = self.json_of("info", "g.tcell")
        self.assertEqual(info["planes"]["breaches"], info["report"]["planes"]["breaches"])
        self.assertEqual([(b["axis"], b["rule"], b["at"], b["expected"]) for b in info["planes"]["breaches"]], [("x", "growth", 1.25, 1.2)])
        self.assertIn("axis x at", self.run_ok("info", "g.tcell").out)

    def test_a_dry_run_has_the_planes_of_the_run_and_writes_nothing_else(self):
        planes = self.made(snap="thirds", metals=["steel"])
        before = sorted(os.listdir(self.path(".")))
        said = self.run_ok("mesh", "s.json", "--dry-run", "--write-planes", "planes").out
        self.assertEqual(sorted(os.listdir(self.path("."))), sorted([*before, "planes"]))
        for words in ("cells", "domain", "all rules are held", "nothing was written"):
            self.assertIn(words, said)
        for name, of_axis in zip("xyz", planes):
            with open(self.path(f"planes/{name}.txt")) as file:
                self.assertEqual([float(line) for line in file], of_axis)
        first = self.bytes("g.tcell")
        self.mesh([{"name": "a", "mesh": "a.stl", "material": "steel"}, {"name": "b", "mesh": "b.obj", "material": "oil"}],
                  {name: {"planes_file": f"planes/{name}.txt"} for name in "xyz"})
        self.assertIn("the grids are equal", self.run_ok("diff", "g.tcell", "g.tcell").out)
        self.assertNotEqual(first, b"")
        self.refused(2, ["--write-planes: expected another folder"], "mesh", "s.json", "--write-planes", "planes", "-o", "h.tcell")

    def test_shards_have_the_same_made_planes(self):
        self.made()
        for i in (0, 1):
            self.run_ok("mesh", "s.json", "-o", "p.tcell", "--shard", f"{i}/2")
        self.run_ok("merge", "p.tcell.shard-0-of-2", "p.tcell.shard-1-of-2", "-o", "p.tcell")
        self.assertEqual(self.bytes("p.tcell"), self.bytes("g.tcell"))

    def test_wrong_rules_for_planes_are_usage_errors(self):
        for auto, words in (({"finest": 2}, "at least twice"), ({"growth": 1}, "growth"), ({"resolution": {"c": {"step": 1}}}, "found \"c\""),
                            ({"resolution": {"a": {"step": 0.3}}}, "at least twice"), ({"snap": "thirds"}, "metals"), ({"snap": "edges"}, "snap"),
                            ({"fixed": {"x": [99]}}, "99"), ({"fixed": [1]}, "fixed"), ({"coarse": 1}, "coarse"), ({"coarsest": 1e308}, "1e60"),
                            ({"finest": 1e-30, "coarsest": 1e-29}, "axis x of the grid: ")):
            self.write("s.json", {"grid": {"auto": {"finest": 0.25, "coarsest": 2, **auto}}, "materials": {"air": {}, "steel": {}},
                                  "bodies": [{"name": "a", "mesh": "a.stl", "material": "steel"}]})
            self.refused(2, [words], "mesh", "s.json", "-o", "h.tcell")
        box = {"min": [0, 0, 0], "max": [9, 9, 9]}
        for grid, auto, words in (({"x": {"planes": [0, 1]}}, {"fixed": {"x": [0.5]}}, "grid.auto.fixed.x"), (box, {"pad": 2}, "grid.auto.pad"),
                                  (box, {"fixed": {"y": [10]}}, "s.json: grid: \"fixed\" of axis y"), ({}, {}, "give it \"min\" and \"max\"\n")):
            self.write("s.json", {"grid": {"auto": {"finest": 0.25, "coarsest": 2, **auto}, **grid}, "materials": {"air": {}}, "bodies": []})
            self.refused(2, [words], "mesh", "s.json", "-o", "h.tcell")
        for more in ({"step": 1}, {"pad": 2}):
            self.write("s.json", {"grid": {"auto": {"finest": 0.25, "coarsest": 2}, **more}, "materials": {"air": {}}, "bodies": []})
            self.refused(2, ["exclude each other"], "mesh", "s.json", "-o", "h.tcell")

    def test_a_resolution_of_a_material_that_no_body_has_is_a_warning(self):
        self.mesh([{"name": "a", "mesh": "a.stl", "material": "steel"}], {"auto": {"finest": 0.25, "coarsest": 2, "resolution": {"air": {"step": 1}}}})
        self.assertIn("'air', which no body has", self.run_ok("mesh", "s.json", "--dry-run").err)

    def test_one_axis_may_have_made_planes_beside_others_that_options_decide(self):
        self.mesh([{"name": "a", "mesh": "a.stl", "material": "steel"}], {"x": {"auto": {"finest": 0.5, "coarsest": 1, "pad": 2}}, "step": 1})
        self.run_ok("mesh", "s.json", "--step", 0.5, "-o", "h.tcell")
        for grid, cells in (("g.tcell", [8, 6, 6]), ("h.tcell", [8, 10, 10])):
            self.assertEqual(self.json_of("info", grid)["grid"]["cells"], cells)
        self.refused(2, ["made"], "mesh", "s.json", "--cells", "1,2,3", "-o", "h.tcell")
        self.refused(2, ["--report", "--dry-run"], "mesh", "s.json", "--dry-run", "--report", "r.json")

    def test_transforms(self):
        body = {"mesh": "a.stl", "material": "steel"}
        for more, box in (({"translate": [1, -0.5, 0.25]}, ((1, -0.5, 0.25), (5, 3.5, 4.25))),
                          ({"scale": 0.5}, ((0, 0, 0), (2, 2, 2))),
                          ({"scale": [0.5, 1, 1.25]}, ((0, 0, 0), (2, 4, 5))),
                          ({"rotate": {"axis": [0, 0, 1], "degrees": 90}, "translate": [5, 0, 0]}, ((1, 0, 0), (5, 4, 4))),
                          ({"scale": [1, 0.5, 0.25], "rotate": {"axis": [1, 0, 0], "degrees": -90}}, ((0, 0, -2), (4, 1, 0))),
                          ({"matrix": [-1, 0, 0, 5, 0, 0, 1, 0, 0, 1, 0, 0.5]}, ((1, 0, 0.5), (5, 4, 4.5)))):
            self.mesh([{**body, **more}])
            self.assert_cells([(*box, 1)])

    def test_sample_points_may_lie_elsewhere_in_the_cell(self):
        self.mesh([{"mesh": "a.stl", "material": "steel"}], sample=[0, 0.25, 0.75])
        self.assert_cells([(*A, 1)], [solids.centres(-1, 0.5, n, s) for n, s in ((16, 0), (12, 0.25), (14, 0.75))])
        self.assertEqual(self.json_of("info", "g.tcell")["grid"]["sample"], [0, 0.25, 0.75])

    def test_parts_of_a_file(self):
        self.write("two.stl", solids.ascii_stl(solids.box_facets(*A), "deck fore") + solids.ascii_stl(solids.box_facets(*B), "keel"))
        self.mesh([{"mesh": "two.stl", "part": "deck*", "material": "steel"}])
        self.assert_cells([(*A, 1)])
        self.mesh([{"mesh": "two.stl", "part": "keel", "material": "oil"}])
        self.assert_cells([(*B, 2)])

    def test_options_override_the_grid_of_the_scene(self):
        self.mesh([{"mesh": "a.stl", "material": "steel"}])
        self.run_ok("mesh", "s.json", "--step", 1, "-o", "g.tcell")
        self.assert_cells([(*A, 1)], [solids.centres(-1, 1, n) for n in (8, 6, 7)])
        self.run_ok("mesh", "s.json", "--cells", "4,3,7", "-o", "g.tcell")
        self.assert_cells([(*A, 1)], [solids.centres(-1, 2, 4), solids.centres(-1, 2, 3), solids.centres(-1, 1, 7)])

    def test_paths_are_relative_to_the_scene_file(self):
        self.mesh([{"mesh": "a.stl", "material": "steel"}])
        r = self.run_ok("mesh", self.path("s.json"), "-o", self.path("there.tcell"))
        self.assertEqual(self.bytes("there.tcell"), self.bytes("g.tcell"))
        self.assertIn("there.tcell", r.out)

    def test_a_body_that_owns_no_cell_is_a_warning(self):
        r = self.mesh([{"name": "far", "mesh": "a.stl", "material": "steel", "translate": [100, 0, 0]}])
        self.assertIn("warning: body 'far' owns no cell", r.err)
        self.assertEqual(len(self.json_of("info", "g.tcell")["report"]["warnings"]), 1)

    def test_a_sheet_owns_the_cells_that_it_passes_through(self):
        self.mesh([{"mesh": "b.obj", "material": "oil", "kind": "sheet"}])
        (lo, hi), ns = B, (16, 12, 14)

        def in_sheet(cell):  # whether a face of the box lies between the cell's planes or on the upper one
            planes = [-1 + 0.5 * i for i in cell]
            return any(planes[d] < face <= planes[d] + 0.5 and all(lo[e] <= planes[e] + 0.25 < hi[e] for e in range(3) if e != d)
                       for d in range(3) for face in (lo[d], hi[d]))
        cells = bytes(2 * in_sheet((i, j, k)) for k in range(ns[2]) for j in range(ns[1]) for i in range(ns[0]))
        self.assertEqual(self.export("g.tcell"), (ns[::-1], cells))
        self.assertRegex(self.run_ok("info", "g.tcell").out, r"b: 12 facets in 1 shell, sheet, \d+ cells")

    def test_options_for_solids_leave_sheets_alone(self):
        sheet, solid = {"mesh": "b.obj", "material": "oil", "kind": "sheet"}, {"mesh": "a.stl", "material": "steel"}
        options = (("--fill", "evenodd"), ("--closing", "strict"), ("--stitch", 0))
        self.mesh([sheet])
        for option in options:
            self.refused(2, [option[0], "sheets only"], "mesh", "s.json", *option, "-o", "g.tcell")
        self.mesh([sheet, solid])
        for option in options:
            self.run_ok("mesh", "s.json", *option, "-o", "g.tcell")
            of_sheet, of_solid = self.json_of("info", "g.tcell")["report"]["scene"]["bodies"]
            self.assertEqual((of_sheet["fill"], of_sheet["closing"], "stitch" in of_sheet), ("auto", "cap", False))
            self.assertEqual(of_solid[option[0][2:]], option[1])

    def test_thin_parts_are_counted_and_kept(self):
        self.write("plate.stl", solids.binary_stl(solids.box_facets((0.0, 0.0, 2.0), (4.0, 4.0, 2.125))))
        body = {"mesh": "plate.stl", "material": "steel"}
        r = self.mesh([body])
        self.assertIn("owns no cell: its box is 8 x 8 x 0.25 cells wide", r.err)
        r = self.mesh([{**body, "thin": "keep"}])
        self.assertNotIn("warning", r.err)
        self.assert_cells([((0, 0, 2), (4, 4, 2.5), 1)])
        self.assertEqual(self.json_of("info", "g.tcell")["report"]["bodies"][0]["lost"]["z"], {"number": 64, "widest_65536ths": 16384, "widest": 0.125, "at": [0.25, 0.25, 2.0625]})
        self.assertIn("stretches between two sample points along z: 64, the widest 0.125 mm at (0.25, 0.25, 2.0625)", self.run_ok("info", "g.tcell").out)

    def test_thin_counts_what_is_lost_in_bodies_and_between_them(self):
        self.write("upper.stl", solids.binary_stl(solids.box_facets((0.0, 0.0, 4.125), (4.0, 4.0, 5.0))))
        self.mesh([{"mesh": "a.stl", "material": "steel"}, {"mesh": "upper.stl", "material": "steel"}])
        cells = self.export("g.tcell")
        self.assertNotIn("lost_gaps", self.json_of("info", "g.tcell")["report"])
        self.run_ok("mesh", "s.json", "--thin", "-o", "g.tcell")
        self.assertEqual(self.export("g.tcell"), cells)
        gap, = self.json_of("info", "g.tcell")["report"]["lost_gaps"]
        self.assertEqual(gap, {"material": "steel", "axis": "z", "number": 64, "widest_65536ths": 16384, "widest": 0.125, "at": [0.25, 0.25, 4.0625]})
        self.assertIn("of steel between two sample points along z: 64, the widest 0.125 mm", self.run_ok("info", "g.tcell").out)

"""Assemblies: the same cells as their parts placed by a scene, whatever the format; what `info` says of them."""
import json
import os
import subprocess
import zipfile

import assemblies
import solids
from program import Case, teracell


def glob_of(path):
    return path.replace("a/b [1]*", "a\\/b \\[1]\\*")


class Assemblies(Case):
    def setUp(self):
        super().setUp()
        self.roots, self.shapes = assemblies.machine()
        self.parts = list(assemblies.parts_of(self.roots))
        self.write("m.glb", assemblies.glb(self.roots, self.shapes))
        doc, buffer = assemblies.gltf(self.roots, self.shapes)
        doc["buffers"][0]["uri"] = "the%20buffer.bin"
        self.write("the buffer.bin", buffer)
        self.write("m.gltf", json.dumps(doc))
        self.write("e.gltf", assemblies.embedded_gltf(self.roots, self.shapes))
        assemblies.threemf(self.path("m.3mf"), self.roots, self.shapes, "meter")
        for i, facets in enumerate(self.shapes):
            self.write(f"{i}.stl", solids.binary_stl(facets))

    def scene(self, bodies, units="m", **keys):
        domain = {"m": 1, "cm": 100}[units]
        return {"units": units, "grid": {"min": [-domain, -domain, -domain], "max": [15 * domain, 15 * domain, 11 * domain], "cells": [64, 61, 57]},
                "label_by": "body", "materials": {"air": {"color": "#00000000"}, "steel": {"color": "#8899aa"}}, "bodies": bodies, **keys}

    def mesh(self, name, bodies, **keys):
        self.write(name + ".json", self.scene(bodies, **keys))
        self.run_ok("mesh", name + ".json", "-o", name + ".tcell")
        return self.json_of("stats", name + ".tcell", "--bodies")

    def test_every_format_gives_the_cells_of_the_parts_placed_by_a_scene(self):
        expected = self.mesh("stl", [{"name": p, "mesh": f"{s}.stl", "material": "steel", "matrix": m, "note": "a part"} for p, s, m in self.parts], note="of parts")
        for file in ("m.glb", "m.gltf", "e.gltf", "m.3mf"):
            found = self.mesh("g", [{"name": p, "mesh": file, "part": glob_of(p), "material": "steel"} for p, _, _ in self.parts])
            self.assertEqual(found, expected, file)
            self.assertIn("the grids are equal", self.run_ok("diff", "stl.tcell", "g.tcell").out)

    def test_units_are_converted_once_whatever_the_scene_has(self):
        cm = self.mesh("cm", [{"name": "all", "mesh": "m.glb", "material": "steel"}], units="cm")
        m = self.mesh("m", [{"name": "all", "mesh": "m.3mf", "material": "steel"}])
        cells = [[b["cells"] for b in s["bodies"]] for s in (cm, m)]
        self.assertEqual(*cells)
        report = self.json_of("info", "cm.tcell")["report"]["inputs"][0]
        self.assertEqual((report["unit"], report["factor"]), ("m", 100))

    def test_bare_assemblies_take_their_unit_or_another(self):
        self.run_ok("mesh", "m.3mf", "--cells", 40, "-o", "a.tcell")
        self.assertEqual(self.json_of("info", "a.tcell")["units"], "m")
        self.run_ok("mesh", "m.glb", "--units", "mm", "--cells", 40, "-o", "b.tcell")
        b = self.json_of("info", "b.tcell")
        self.assertEqual(b["units"], "mm")
        self.assertLessEqual({"/plate", "/left/болт", "/right/支持体/a\\/b \\[1]\\*"}, {p["name"] for p in b["patches"]})
        r = teracell("mesh", "m.glb", "--units", "parsec", "--cells", 40, "-o", "c.tcell", cwd=self.folder)
        self.assertEqual((r.status, "expected m, cm, mm, um, nm, in or ft, found 'parsec'" in r.err), (2, True), r.err)

    def test_a_scene_to_edit_and_a_body_for_each_part_are_the_same_cells(self):
        self.run_ok("mesh", "m.3mf", "--by-part", "--cells", 50, "-o", "by.tcell")
        by = self.json_of("stats", "by.tcell")
        self.assertEqual([m["name"] for m in by["materials"]][1:], [glob_of(p) for p, _, _ in self.parts])
        out = self.run_ok("scene", "m.3mf", "--cells", 50, "-o", "edit.json").out
        self.assertIn("edit.json: 7 bodies of 4 materials\nguessed, because no file names them: plate, bolt, болт, a/b [1]*\n", out)
        self.run_ok("mesh", "edit.json", "-o", "edit.tcell")
        edit = {m["name"]: m["cells"] for m in self.json_of("stats", "edit.tcell")["materials"]}
        cells = {m["name"]: m["cells"] for m in by["materials"]}
        self.assertEqual(edit, {"air": cells["air"], "plate": cells["/plate"], "bolt": cells["/left/bolt"] + cells["/right/bolt"],
                                "болт": cells["/left/болт"] + cells["/right/болт"],
                                "a/b [1]*": cells["/left/支持体/a\\/b \\[1]\\*"] + cells["/right/支持体/a\\/b \\[1]\\*"]})
        r = teracell("scene", "m.glb", "-o", "edit.json", cwd=self.folder)
        self.assertEqual((r.status, "edit.json: expected a name that no file has" in r.err), (2, True), r.err)
        self.run_ok("scene", "m.3mf", "--cells", 50, "-o", "edit.json", "--force")
        os.mkdir(self.path("deep"))
        self.run_ok("scene", "m.glb", "0.stl", "--step", 0.25, "-o", "deep/edit.json")
        self.assertEqual([b["mesh"] for b in self.read_json("deep/edit.json")["bodies"]][-2:], ["../m.glb", "../0.stl"])
        self.run_ok("mesh", "deep/edit.json", "-o", "deep.tcell")
        self.assertEqual(teracell("mesh", "edit.json", "--by-part", "-o", "x.tcell", cwd=self.folder).status, 2)

    def test_runs_that_spill_and_shards_see_the_same_parts(self):
        bodies = [{"name": p, "mesh": "m.3mf", "part": glob_of(p), "material": "steel"} for p, _, _ in self.parts]
        self.mesh("whole", bodies)
        for i in (0, 1):
            self.run_ok("mesh", "whole.json", "--shard", f"{i}/2", "-o", "s.tcell")
        self.run_ok("merge", "s.tcell.shard-0-of-2", "s.tcell.shard-1-of-2", "-o", "s.tcell")
        self.assertEqual(self.bytes("s.tcell"), self.bytes("whole.tcell"))

    def test_copies_that_share_their_facets_have_the_bytes_of_facets_one_by_one(self):
        ball = assemblies.ball(28, 28)
        roots = [{"name": f"ball {i}", "shape": 0, "trs": ((2.5 * (i % 10), 2.5 * (i // 10), 0.3 * (i % 3)), (0.1 * i, 1, 0.2, 1), (1, -1 if i % 7 == 0 else 1, 1))}
                 for i in range(98)]
        roots += [dict(roots[5], name="the same"), {"name": "within", "shape": 0, "trs": ((2.5, 0.25, 0), (0, 0, 0, 1), (3, 0.5, 0.5))}]
        for name, shape in {"closed": ball, "open": ball[:-1]}.items():
            self.assertGreater(len(roots) * len(shape), 1 << 17)
            self.write(f"{name}.glb", assemblies.glb(roots, [shape]))
            for cells in (70, 600):
                mesh = ("mesh", f"{name}.glb", "--cells", cells, "--links", "-o")
                self.run_ok(*mesh, "shared.tcell")
                self.run_ok(*mesh, "single.tcell", "--engine", "tree")
                self.run_ok(*mesh, "small.tcell", "--memory", "16MB", "--threads", 1)
                for other in ("single", "small"):
                    self.assertEqual(self.bytes("shared.tcell"), self.bytes(f"{other}.tcell"), (name, cells, other))
            surface = self.json_of("info", "shared.tcell")["report"]["bodies"][0]
            self.assertEqual((surface["shells"], surface["duplicates"]), (99, len(shape)))

    def test_info_shows_the_tree(self):
        out = self.run_ok("info", "m.glb").out
        for line in ("m.glb: GLB, in m, 7 parts of 4 kinds, ", "├─ болт ", "   └─ a/b [1]* ", "plate "):
            self.assertIn(line, out)
        found = self.json_of("info", "m.3mf", "m.glb")
        for file, unit, form in zip(found["files"], ("m", "m"), ("3mf", "glb")):
            self.assertEqual((file["unit"], file["format"]), (unit, form))
            kinds = {p["path"]: p for p in file["parts"]}
            self.assertEqual(kinds["/plate"]["box"], [0, 0, 0, 12, 8, 1])
            self.assertAlmostEqual(kinds["/plate"]["volume"], 96)
            self.assertAlmostEqual(kinds["/plate"]["area"], 232)
            bolt = kinds["/left/bolt"]
            self.assertEqual((bolt["facets"], bolt["closed"], bolt["open_edges"]), (8, True, 0))
            self.assertAlmostEqual(bolt["volume"], 32 / 3 * 0.25 * 0.25 * 0.75)
        self.assertEqual({p["path"]: p["instances"] for p in found["files"][1]["parts"]},
                         {"/plate": 1, "/left/bolt": 2, "/left/болт": 2, "/left/支持体/a\\/b \\[1]\\*": 2})

    def test_bodies_in_any_order_may_take_parts_of_several_files(self):
        files = {"m.glb": 0, "m.3mf": 0}
        bodies = [{"name": f"{f} {p}", "mesh": f, "part": glob_of(p), "material": "steel"} for p, _, _ in self.parts for f in files]
        mixed = self.mesh("mixed", bodies)
        ordered = self.mesh("ordered", sorted(bodies, key=lambda b: b["mesh"] == "m.3mf"))
        cells = [{b["name"]: b["cells"] for b in s["bodies"]} for s in (mixed, ordered)]
        self.assertEqual(*[{name: n for name, n in c.items() if name.startswith("m.3mf")} for c in cells])

    def test_names_in_no_encoding_and_names_too_long_are_found_again(self):
        facets = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
        for i, name in enumerate((b"gr\xfcn", b"n" * 300, "名".encode() * 100, b"tab\x01bed")):
            self.write("odd.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng " + name + b"\n" + facets.encode() + b"g other\n" + facets.encode())
            self.run_ok("scene", "odd.obj", "-o", f"{i}.json")
            self.run_ok("mesh", f"{i}.json", "--cells", 20, "-o", "a.tcell")
            self.run_ok("mesh", "odd.obj", "--by-part", "--cells", 20, "-o", "b.tcell")
            self.assertEqual(len(self.json_of("info", "b.tcell")["materials"]), 3)

    def test_surfaces_without_a_unit_beside_one_that_states_it_are_named(self):
        r = self.run_ok("mesh", "m.3mf", "0.stl", "--cells", 30, "-o", "a.tcell")
        self.assertIn("0.stl states no unit: its coordinates are taken to be in m", r.err)
        self.run_ok("scene", "m.glb", "--units", "mm", "-o", "mm.json")
        self.assertEqual(self.read_json("mm.json")["units"], "mm")

    def test_info_of_surfaces(self):
        self.write("two.obj", "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\no b\nf 1 3 2\nf 1 2 4\nf 1 4 3\n")
        out = self.run_ok("info", "two.obj").out
        self.assertIn("two.obj: OBJ, no unit stated, 2 parts, 1 × 1 × 1", out)
        self.assertIn("open: 3 edges", out)
        self.assertEqual([(p["path"], p["closed"], p["open_edges"]) for p in self.json_of("info", "two.obj")["files"][0]["parts"]],
                         [("/a", True, 0), ("/b", False, 3)])
        os.mkfifo(self.path("pipe"))
        with subprocess.Popen(["cp", self.path("two.obj"), self.path("pipe")]):
            self.assertIn("pipe: OBJ, no unit stated, 2 parts", self.run_ok("info", "pipe").out)
        r = teracell("info", "nothing.stl", cwd=self.folder)
        self.assertEqual((r.status, "nothing.stl" in r.err), (1, True))

    def test_a_missing_or_changed_buffer_is_named(self):
        os.remove(self.path("the buffer.bin"))
        r = teracell("mesh", "m.gltf", "--cells", 40, "-o", "a.tcell", cwd=self.folder)
        self.assertEqual((r.status, "buffers[0]" in r.err and "the buffer.bin" in r.err), (1, True), r.err)
        self.write("the buffer.bin", b"short")
        r = teracell("mesh", "m.gltf", "--cells", 40, "-o", "a.tcell", cwd=self.folder)
        self.assertEqual((r.status, "buffers[0]: cut short" in r.err), (1, True), r.err)
        os.remove(self.path("the buffer.bin"))
        os.mkfifo(self.path("the buffer.bin"))
        r = teracell("info", "m.gltf", cwd=self.folder)
        self.assertEqual((r.status, "buffers[0]: expected a file, found something else" in r.err), (1, True), r.err)

    def test_a_package_that_is_made_to_fill_memory_or_disk_is_refused(self):
        with zipfile.ZipFile(self.path("m.3mf")) as whole, zipfile.ZipFile(self.path("bomb.3mf"), "w", zipfile.ZIP_DEFLATED) as bomb:
            for name in whole.namelist():
                with bomb.open(name, "w") as file:
                    file.write(whole.read(name))
                    for _ in range(70 if name.endswith(".model") else 0):
                        file.write(b" " * (1 << 20))
        r = teracell("info", "bomb.3mf", cwd=self.folder)
        self.assertEqual((r.status, "unpack to more than 250 times as many" in r.err), (1, True), r.err)
        with open(self.path("m.3mf"), "rb") as file:
            told_elsewhere = bytearray(file.read())
        entry = told_elsewhere.index(b"PK\x01\x02")
        while b".model" not in told_elsewhere[entry + 46:entry + 46 + 30]:
            entry = told_elsewhere.index(b"PK\x01\x02", entry + 4)
        told_elsewhere[entry + 20:entry + 28] = b"\xff" * 8
        self.write("large.3mf", bytes(told_elsewhere))
        r = teracell("mesh", "large.3mf", "--cells", 10, "-o", "a.tcell", cwd=self.folder)
        self.assertEqual((r.status, "expected a model of less than 4 GB" in r.err), (1, True), r.err)

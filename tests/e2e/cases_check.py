"""What `check` finds from the outside: as text, as JSON, beside the grid, and over HTTP."""
import json
import os

import solids
from serving import ServeCase


class Check(ServeCase):
    def setUp(self):
        super().setUp()
        self.write("plate.stl", solids.binary_stl(solids.box_facets((2.0, 2.0, 5.0), (18.0, 18.0, 6.0))))
        self.write("far.stl", solids.binary_stl(solids.box_facets((30.0, 30.0, 30.0), (31.0, 31.0, 31.0))))
        self.scene = {"units": "mm", "grid": {"min": [0, 0, 0], "max": [20, 20, 20], "cells": [20, 20, 20]}, "label_by": "body",
                      "materials": {"steel": {}},
                      "bodies": [{"name": "plate", "mesh": "plate.stl", "material": "steel"}, {"name": "far", "mesh": "far.stl", "material": "steel"}]}
        self.write("s.json", self.scene)

    def test_what_is_found_is_printed_and_kept_beside_the_grid(self):
        self.run_ok("mesh", "s.json", "-o", "g.tcell")
        text = self.run_ok("check", "g.tcell").out
        self.assertTrue(text.startswith("g.tcell: 1 error, 1 warning, 0 notes\n"), text)
        self.assertIn("The body 'far' has no cell", text)
        self.assertIn("A wall of 'plate' is 1 cell thick where it is thinnest: 256 cells are below 3.  at (2.5, 2.5, 5.5)", text)
        self.assertIn("g.check.json", text)
        kept = json.loads(self.bytes("g.check.json"))
        self.assertEqual(kept, json.loads(self.run_ok("check", "g.tcell", "--json").out))
        self.assertEqual([(f["kind"], f["bodies"], f["cells"], f["box"]) for f in kept["findings"]],
                         [("empty", ["far"], 0, None), ("thin", ["plate"], 256, [2, 2, 5, 18, 18, 6])])
        self.assertEqual([w["histogram"] for w in kept["walls"] if w["body"] == "plate"], [[256, 0, 0, 0, 0, 0, 0, 0]])
        self.assertEqual(kept["grid_hash"], self.json_of("info", "g.tcell")["file"]["hash"])

    def test_mesh_looks_through_the_grid_when_it_is_done(self):
        text = self.run_ok("mesh", "s.json", "-o", "g.tcell", "--check").out
        self.assertIn("g.tcell: 1 error, 1 warning, 0 notes", text)
        self.assertTrue(os.path.exists(self.path("g.check.json")))
        self.refused(2, ["--check", "--shard"], "mesh", "s.json", "-o", "h.tcell", "--check", "--shard", "0/2")

    def test_nothing_is_left_half_done(self):
        self.run_ok("mesh", "s.json", "-o", "g.tcell")
        self.run_ok("check", "g.tcell", "-o", "elsewhere.json")
        self.assertFalse(os.path.exists(self.path("g.check.json")))
        self.assertTrue(os.path.exists(self.path("elsewhere.json")))
        self.refused(2, ["overwritten"], "check", "g.tcell", "-o", "g.tcell")
        for option, value in (("--thin-cells", "9"), ("--thin-cells", "nan"), ("--narrow-cells", "nan")):
            self.refused(2, [f"{option}: expected 0 to 8, found '{value}'"], "check", "g.tcell", option, value)
        data = bytearray(self.bytes("g.tcell"))
        data[len(data) // 3] ^= 1
        self.write("d.tcell", data)
        self.refused(1, ["d.tcell"], "check", "d.tcell")
        self.assertFalse(os.path.exists(self.path("d.check.json")))
        self.assertFalse(os.path.exists(self.path("d.check.json.partial")))

    def test_a_packed_grid_has_what_was_found_in_its_cells(self):
        self.run_ok("mesh", "s.json", "-o", "g.tcell", "--check")
        found = self.read_json("g.check.json")
        self.run_ok("pack", "g.tcell", "-o", "p.tcell")
        packed = self.read_json("p.check.json")
        self.assertEqual(packed["grid_hash"], self.json_of("info", "p.tcell")["file"]["hash"])
        self.assertNotEqual(packed["grid_hash"], found["grid_hash"])
        self.assertEqual(packed, self.json_of("check", "p.tcell"))
        for key in ("cells_hash", "findings", "totals", "walls", "not_looked_at"):
            self.assertEqual(packed[key], found[key])
        os.mkdir(self.path("r.check.json"))
        self.assertRegex(self.run_ok("pack", "g.tcell", "-o", "r.tcell").err, "^warning: r.tcell does not get what was found .*r.check.json")
        self.assertEqual(self.bytes("r.tcell"), self.bytes("p.tcell"))
        os.replace(self.path("p.tcell"), self.path("g.tcell"))  # in its place, beside what was found before
        self.assertEqual(self.served("g"), packed)
        self.scene["grid"]["cells"] = [20, 20, 21]  # other cells
        self.write("s.json", self.scene)
        self.run_ok("mesh", "s.json", "-o", "g.tcell")
        self.assertIsNone(self.served("g"))
        self.run_ok("pack", "g.tcell", "-o", "q.tcell")
        self.assertFalse(os.path.exists(self.path("q.check.json")))

    def served(self, name):
        """What a server answers about a grid."""
        server = self.serve(f"{name}.tcell")
        listed, answer = server.get("/api/v1/grids").json()["grids"][0], server.get(f"/api/v1/grids/{name}/check")
        self.stop(server)
        self.assertEqual(answer.status, 200 if listed["checked"] else 404)
        return answer.json() if listed["checked"] else None

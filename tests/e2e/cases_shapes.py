"""The JSON that other programs read: the keys that the documents promise, with their types."""
import json

import solids
from program import Case

INT, NUMBER, TEXT, BOOL = "int", "number", "text", "bool"


def fits(value, shape, where=""):
    """Throws unless `value` has the keys of `shape`, with values of the same types. Other keys are allowed. [x] is a list of x."""
    if isinstance(shape, dict):
        assert isinstance(value, dict), f"{where}: expected an object, found {value!r}"
        for key, inner in shape.items():
            assert key in value, f"{where}: no key {key!r} among {sorted(value)}"
            fits(value[key], inner, f"{where}.{key}")
    elif isinstance(shape, list):
        assert isinstance(value, list), f"{where}: expected a list, found {value!r}"
        for i, item in enumerate(value):
            fits(item, shape[0], f"{where}[{i}]")
    else:
        good = {INT: isinstance(value, int) and not isinstance(value, bool), NUMBER: isinstance(value, (int, float)) and not isinstance(value, bool),
                TEXT: isinstance(value, str), BOOL: isinstance(value, bool)}[shape]
        assert good, f"{where}: expected {shape}, found {value!r}"


REPORT = {"schema": INT,
          "bodies": [{"name": TEXT, "facets": INT, "degenerate": INT, "duplicates": INT, "shells": INT,
                      "fill": [{"rule": TEXT, "shells": INT, "why": TEXT}],
                      "holes": [{"at": [NUMBER], "edges": INT, "diameter": NUMBER, "cap_area": NUMBER}],
                      "lost_stretches": {"axis": TEXT, "number": INT}, "cells": INT}],
          "crossings": INT, "warnings": [TEXT], "inputs": [{"path": TEXT, "bytes": INT, "hash": TEXT}]}
RUN_ONLY = {"phases": [{"name": TEXT, "seconds": NUMBER}], "peak_memory_bytes": INT, "threads": INT, "exact_decisions": INT, "spilled_bytes": INT,
            "resumed_chunks": INT}
INFO = {"schema": INT, "units": TEXT, "ray_axis": TEXT,
        "grid": {"min": [NUMBER], "max": [NUMBER], "cells": [INT], "sample": [NUMBER], "axes": [{"type": TEXT}]},
        "materials": [{"id": INT, "name": TEXT, "color": TEXT}], "levels": [{"level": INT, "cells": [INT], "stored": BOOL}],
        "file": {"bytes": INT, "version": TEXT, "hash": TEXT}, "crossings": INT, "bits_per_crossing": NUMBER, "report": REPORT}
STATS = {"schema": INT, "region": [INT], "materials": [{"id": INT, "name": TEXT, "cells": INT, "volume": NUMBER}]}
COLUMN = {"schema": INT, "axis": TEXT, "at": [INT],
          "runs": [{"from": INT, "to": INT, "min": NUMBER, "max": NUMBER, "material": INT, "name": TEXT}]}


class Shapes(Case):
    def setUp(self):
        super().setUp()
        self.write("a.stl", solids.binary_stl(solids.box_facets((0.0, 0.0, 0.0), (4.0, 3.0, 2.0))))
        self.write("empty-handed.stl", solids.binary_stl(solids.box_facets((0.01, 0.01, 0.01), (0.02, 0.02, 0.02))))
        self.run_ok("mesh", "a.stl", "empty-handed.stl", "--cells", 10, "-o", "g.tcell", "--report", "r.json")

    def test_info(self):
        j = self.json_of("info", "g.tcell")
        fits(j, INFO)
        self.assertEqual((j["schema"], j["units"], j["file"]["bytes"]), (1, "m", len(self.bytes("g.tcell"))))
        self.assertEqual([m["id"] for m in j["materials"]], [0, 1, 2])
        for axis, n in zip(j["grid"]["axes"], j["grid"]["cells"]):
            self.assertEqual(set(axis), {"type", "min", "step", "first", "cells"})
            self.assertEqual((axis["type"], axis["cells"], axis["first"]), ("uniform", n, 0))
        self.assertEqual([l["level"] for l in j["levels"]], list(range(len(j["levels"]))))
        self.assertEqual(j["levels"][-1]["cells"], [1, 1, 1])
        for level in j["levels"]:
            if level["stored"]:
                fits(level, {"chunks": INT, "bytes": INT})
        self.assertTrue(j["levels"][0]["stored"])

    def test_stats_and_column(self):
        j = self.json_of("stats", "g.tcell")
        fits(j, STATS)
        self.assertEqual([m["box"] is None for m in j["materials"]], [m["cells"] == 0 for m in j["materials"]])
        self.assertEqual(len(j["materials"]), 3)
        fits(self.json_of("column", "g.tcell", "--axis", "y", "--at", "1,1"), COLUMN)

    def test_report(self):
        told, kept = json.loads(self.bytes("r.json")), self.json_of("info", "g.tcell")["report"]
        fits(told, {**REPORT, **RUN_ONLY})
        fits(kept, REPORT)
        for key in kept:
            self.assertEqual(told[key], kept[key], key)
        text = json.dumps(kept)
        for word in (*RUN_ONLY, "seconds", "memory", "date", "time"):
            self.assertNotIn(f'"{word}', text, "the file must not depend on the run")
        self.assertEqual(kept["inputs"][0]["path"], "a.stl")
        self.assertEqual(kept["inputs"][0]["bytes"], len(self.bytes("a.stl")))
        self.assertEqual([b["name"] for b in kept["bodies"]], ["a", "empty-handed"])
        self.assertEqual(kept["bodies"][0]["facets"], 12)
        self.assertEqual(kept["bodies"][1]["cells"], 0)
        self.assertIn("empty-handed", kept["warnings"][0])

    def test_the_report_of_the_file_holds_the_scene_as_normalised(self):
        scene = self.json_of("info", "g.tcell")["report"]["scene"]
        self.assertEqual([b["mesh"] for b in scene["bodies"]], ["a.stl", "empty-handed.stl"])

    def test_a_scene_without_bodies_has_empty_lists(self):
        self.write("s.json", {"grid": {"min": [0, 0, 0], "max": [1, 1, 1], "cells": [3, 2, 1]}, "bodies": []})
        self.run_ok("mesh", "s.json", "-o", "e.tcell")
        report = self.json_of("info", "e.tcell")["report"]
        self.assertEqual((report["bodies"], report["inputs"], report["warnings"]), ([], [], []))
        self.assertEqual(self.export("e.tcell"), ((1, 2, 3), bytes(6)))
        self.write("s.json", {"grid": {"cells": 10}, "bodies": []})
        self.refused(1, ["no min and max", "no facets"], "mesh", "s.json", "-o", "e.tcell")

    def test_text_output_is_for_people(self):
        for args in (["info", "g.tcell"], ["stats", "g.tcell"], ["column", "g.tcell", "--axis", "z", "--at", "3,3"]):
            r = self.run_ok(*args)
            self.assertNotIn("{", r.out)
            self.assertEqual(r.err, "")

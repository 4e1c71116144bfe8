"""Materials and bodies whose names have what separates names in a list: such a name stands in double quotes."""
import re

import solids
from program import Case

NAMES = ["air", "a,b", "c=d", 'e"f']
SHOWN = 'air, "a,b", "c=d", "e""f"'  # as they have to be typed


class Names(Case):
    def setUp(self):
        super().setUp()
        for i in (1, 2, 3):  # a cell each, in 8 x 3 x 3
            self.write(f"{i}.stl", solids.binary_stl(solids.box_facets((2.0 * i, 1.0, 1.0), (2.0 * i + 1, 2.0, 2.0))))
        self.write("s.json", {"grid": {"min": [0, 0, 0], "max": [8, 3, 3], "step": 1}, "label_by": "body", "units": "m",
                              "materials": {name: {"color": f"#{40 * i:02x}ff80"} for i, name in enumerate(NAMES)},
                              "bodies": [{"name": NAMES[i] + ", a body", "mesh": f"{i}.stl", "material": NAMES[i]} for i in (1, 2, 3)]})
        self.run_ok("mesh", "s.json", "-o", "g.tcell")
        self.ids = {m["name"]: m["id"] for m in self.json_of("info", "g.tcell")["materials"]}
        self.assertEqual(set(self.ids), set(NAMES))

    def test_numbers_of_a_map(self):
        _, cells = self.export("g.tcell", "--map", 'air=9,"a,b"=6,"c=d"=7,"e""f"=8')
        self.assertEqual(bytes(cells), bytes([9] * 34 + [6, 9, 7, 9, 8] + [9] * 33))

    def test_weights(self):
        self.run_ok("partition", "g.tcell", "--ranks", 2, "--weight", '"a,b"=1,"c=d"=2,"e""f"=4,air=0', "-o", "p.json")
        plan = self.read_json("p.json")
        self.assertEqual((plan["weights"], plan["total"]), ({"air": 0, "a,b": 1, "c=d": 2, 'e"f': 4}, 7))

    def test_materials_that_are_exported(self):
        self.run_ok("export", "g.tcell", "--format", "openfoam", "--fluid", 'air,"a,b"', "-o", "case")
        self.assertEqual(re.search(rb"nCells: *(\d+)", self.bytes("case/constant/polyMesh/owner"))[1], b"70")
        self.run_ok("export", "g.tcell", "--material", '"c=d","e""f"', "-o", "s.ply")
        self.assertIn(b"\nelement vertex 16\n", self.bytes("s.ply"))

    def test_what_is_seen(self):
        labels = {NAMES[i]: i for i in (1, 2, 3)}
        for name, typed in (("a,b", '"a,b"'), ("c=d", '"c=d"'), ('e"f', '"e""f"')):
            pictures = []
            for shown in (["--materials", typed], ["--bodies", typed[:-1] + ', a body"'], ["--labels", labels[name]]):
                self.run_ok("render", "g.tcell", "--view", "z", "--flat", "--size", "64,48", *shown, "-o", "v.png")
                pictures.append(self.bytes("v.png"))
            self.assertEqual(pictures[0], pictures[2])
            self.assertEqual(pictures[1], pictures[2])

    def test_a_name_that_is_none_is_refused_with_those_that_there_are(self):
        for option, given, args in (("--map", "air=0,a,b=1", ["export", "g.tcell", "-o", "x.npy"]), ("--map", "b=1", ["export", "g.tcell", "-o", "x.npy"]),
                                    ("--weight", "b=1", ["partition", "g.tcell", "--ranks", 2, "-o", "x.json"]),
                                    ("--fluid", "a,b", ["export", "g.tcell", "--format", "openfoam", "-o", "x"]),
                                    ("--material", "a,b", ["export", "g.tcell", "-o", "x.ply"]),
                                    ("--materials", "a,b", ["render", "g.tcell", "-o", "x.png"])):
            said = self.refused(2, option, *args, option, given)
            self.assertIn("in double quotes" if "=0," in given else SHOWN, said)
        self.refused(2, ["--bodies", '"a,b, a body", "c=d, a body", "e""f, a body"', "'b'"], "render", "g.tcell", "-o", "x.png", "--bodies", "b")

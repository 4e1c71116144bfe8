"""What happens inside boundary cells, from the outside: patches, links and fractions."""
import struct

import solids
from program import Case

CHANNELS = ("--links", "--fractions", "2,2,4")


class Boundary(Case):
    def setUp(self):
        super().setUp()
        v = solids.box_vertices((2.0, 2.0, 2.0), (7.25, 8.0, 8.0))
        lines = ["v %r %r %r" % p for p in v]
        for name, quad in zip(("inlet", "outlet", "wall", "wall", "wall", "roof"), ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))):
            lines += [f"g {name}", "f " + " ".join(str(i + 1) for i in quad)]
        self.write("duct.obj", "\n".join(lines) + "\n")
        self.write("s.json", {"grid": {"min": [0, 0, 0], "max": [10, 10, 10], "cells": [10, 10, 10]}, "units": "mm",
                              "materials": {"air": {}, "steel": {}}, "bodies": [{"mesh": "duct.obj", "material": "steel"}]})

    def mesh(self, *more, name="g.tcell"):
        self.run_ok("mesh", "s.json", "-o", name, *more)
        return name

    def test_info_lists_patches_with_areas_and_channels_with_bytes(self):
        told = self.json_of("info", self.mesh(*CHANNELS))
        self.assertEqual([(p["name"], p["body"], p["area"]) for p in told["patches"]],
                         [(s, "", 100) for s in ("xmin", "xmax", "ymin", "ymax", "zmin", "zmax")] +
                         [("inlet", "duct", 36), ("outlet", "duct", 36), ("wall", "duct", 94.5), ("roof", "duct", 31.5)])
        channels = {c["name"]: c for c in told["channels"]}
        self.assertEqual(set(channels), {"fractions", "links"})
        self.assertEqual(channels["fractions"]["about"], {"samples": [2, 2, 4]})
        self.assertGreater(min(c["bytes"] for c in channels.values()), 0)
        text = self.run_ok("info", "g.tcell").out
        for part in ("patches     wall    94.5 mm²\n", "inlet   36 mm²\n", "fractions  ", "2 x 2 x 4 sub-samples", "links  "):
            self.assertIn(part, text)
        self.run_ok("verify", "g.tcell")

    def test_cells_and_patches_are_the_same_without_channels(self):
        plain, full = self.mesh(name="plain.tcell"), self.mesh(*CHANNELS)
        self.assertEqual(self.export(plain), self.export(full))
        a, b = self.json_of("info", plain), self.json_of("info", full)
        self.assertEqual(a["patches"], b["patches"])
        self.assertEqual(a["levels"], b["levels"])
        self.assertEqual(a["channels"], [])

    def test_links_are_listed_with_places_and_patches(self):
        patches = [p["name"] for p in self.json_of("info", self.mesh("--links"))["patches"]]
        self.run_ok("export", "g.tcell", "--format", "links", "-o", "l.npy", "--region", "0,4,4,10,5,5")
        data = self.bytes("l.npy")
        records = data[10 + struct.unpack_from("<H", data, 8)[0]:]
        found = [struct.unpack_from("<iiiIIIiHH", records, at) for at in range(0, len(records), 32)]
        # Sample points at 1.5, 2.5 ...: the walls at x = 2 and x = 7.25 are half and three quarters of the way. A point on a lower side is inside.
        self.assertEqual([(*r[:6], patches[r[6]], *r[7:]) for r in found],
                         [(1, 4, 4, 0, 32768, 32768, "inlet", 0, 1), (6, 4, 4, 0, 49152, 49152, "outlet", 1, 0)])

    def test_walls_of_openfoam_are_patches_of_the_surface(self):
        self.mesh("--links")
        self.run_ok("export", "g.tcell", "--format", "openfoam", "--patches", "-o", "case")
        text = self.bytes("case/constant/polyMesh/boundary").decode()
        for name in ("inlet", "outlet", "wall", "roof", "xmin", "zmax"):
            self.assertIn(f"    {name}\n", text)
        self.assertNotIn("    steel\n", text)
        self.assertIn("nFaces          36;", text)

    def test_what_is_not_there_is_said(self):
        self.mesh(name="plain.tcell")
        for args, words in ((("--format", "links", "-o", "l.npy"), "no links"),
                            (("--format", "openfoam", "--patches", "-o", "case"), "no links"),
                            (("-o", "b.vti", "--fractions"), "no fractions"),
                            (("-o", "b.h5", "--fractions"), "no fractions"),
                            (("-o", "b.npy", "--fractions"), "no such option")):
            self.refused(2, words, "export", "plain.tcell", *args)
        for samples, words in (("3,4,4", "power"), ("0,1,1", "power"), ("512,1,1", "256"), ("256,256,2", "65536"), ("4,4", "--fractions"), ("a,b,c", "--fractions")):
            self.refused(2, words, "mesh", "s.json", "-o", "no.tcell", "--fractions", samples)
        self.no_debris()

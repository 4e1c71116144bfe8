"""Wrong usage: exit status 2 and one paragraph that names what is wrong, and the allowed range or the nearest known name."""
import os
import pathlib
import re

import solids
from program import Case, teracell

BODY = {"mesh": "box.stl", "material": "steel"}
GRID = {"min": [-1, -1, -1], "max": [5, 4, 3], "cells": [6, 5, 4]}


class Usage(Case):
    def setUp(self):
        super().setUp()
        self.write("box.stl", solids.binary_stl(solids.box_facets((0.0, 0.0, 0.0), (4.0, 3.0, 2.0))))
        self.run_ok("mesh", "box.stl", "--cells", "12,10,8", "-o", "g.tcell")  # levels 0 to 4 have 12, 6, 3, 2 and 1 cells along x

    def test_help_and_version(self):
        general = self.run_ok("--help").out
        commands = re.findall(r"^  ([a-z]+)  ", general.split("Commands:")[1], re.M)
        self.assertIn("mesh", commands)
        for args in (*[[c, "--help"] for c in commands], ["--version"]):
            r = self.run_ok(*args)
            self.assertTrue(r.out and not r.err, args)
        self.assertEqual(self.run_ok("help").out, general)
        self.assertEqual(self.run_ok("help", "mesh").out, self.run_ok("mesh", "--help").out)
        self.refused(2, ["no command 'mehs'"], "help", "mehs")
        bare = teracell(cwd=self.folder)
        self.assertEqual((bare.status, bare.out, bare.err), (2, "", general))

    def test_no_argument_of_a_command_is_called_like_its_options(self):
        for command in re.findall(r"^  ([a-z]+)  ", self.run_ok("--help").out.split("Commands:")[1], re.M):
            told, options = self.run_ok(command, "--help").out.split("Options:")
            arguments = re.findall(r"^  ([a-z]\S*)", told.partition("Positionals:")[2], re.M)
            names = [name.lstrip("-") for option in re.findall(r"^  (-\S*)", options, re.M) for name in option.split(",")]
            self.assertIn("help", names)
            self.assertEqual(bool(arguments), "Positionals:" in told)
            self.assertEqual(set(arguments) & set(names), set(), f"newer versions of CLI11 refuse {command}")

    def test_licenses(self):
        notice = (pathlib.Path(__file__).resolve().parents[2] / "NOTICE").read_text()
        self.assertEqual(self.run_ok("--licenses").out, notice)
        for name in ("three.js", "Preact", "Boost.Asio", "CLI11", "Zstandard", "xxHash", "zlib"):
            self.assertIn(name, notice)

    def test_tables_use_singular_and_plural(self):
        told = self.run_ok("info", "g.tcell").out
        for phrase in ("1 chunk ", "0 chunks", "12 facets in 1 shell,", " B\n"):
            self.assertIn(phrase, told)
        self.assertRegex(self.run_ok("mesh", "box.stl", "--cells", 9, "-o", "h.tcell").out, r" s, 1\.\d kB, \d+\.\d MB of memory")
        self.assertRegex(self.run_ok("verify", "g.tcell").out, r"sound\. 1\.\d kB, 1 chunk on 4 stored levels")

    def test_digits_are_grouped_and_headings_have_units(self):
        size = "1,200 x 1,000 x 11 = 13,200,000"
        self.assertIn(f"h.tcell: {size} cells in", self.run_ok("mesh", "box.stl", "--cells", "1200,1000,11", "-o", "h.tcell").out)
        told = self.run_ok("info", "h.tcell").out
        self.assertIn(f"\ncells       {size}\n", told)
        inside = self.json_of("stats", "h.tcell")["materials"][1]["cells"]
        self.assertIn(f"nonzero, {inside:,} cells\n", told)
        for command, phrases in (("stats", [" volume, m³ ", f" {inside:,} "]), ("column", ["column along z at x = ", " m (cell 600), y = ", " from, m ", " to, m "])):
            said = self.run_ok(command, "h.tcell", *(["--axis", "z", "--at", "600,500"] if command == "column" else [])).out
            for phrase in phrases:
                self.assertIn(phrase, said)
        self.assertIn("all of 13,200,000 cells", self.run_ok("diff", "h.tcell", "h.tcell").out)

    def test_commands_and_options(self):
        for phrases, args in (
                (["no command 'meshh'", "mean mesh?"], ["meshh"]),
                (["no command 'slcie'", "mean slice?"], ["slcie", "g.tcell"]),
                (["no option '--foo'", "--help"], ["--foo"]),
                (["no option '--cels'", "mean --cells?"], ["mesh", "box.stl", "--cels", "4", "-o", "x.tcell"]),
                (["no command 'nothing'. The commands are mesh"], ["nothing"]),
                (["no option '--level'. See: teracell info --help"], ["info", "g.tcell", "--level", "1"]),
                (["no option '-q'"], ["info", "g.tcell", "-q"]),
                (["nothing more", "second"], ["stats", "g.tcell", "second"]),
                (["--output"], ["mesh", "box.stl", "--cells", 4]),
                (["--output"], ["slice", "g.tcell", "--axis", "z", "--index", "0"]),
                (["--output", "value"], ["export", "g.tcell", "-o"]),
                (["inputs"], ["mesh", "-o", "x.tcell"]),
                (["grid", ".tcell"], ["info"]),
                (["--at, --place", "found neither"], ["column", "g.tcell", "--axis", "z"]),
                (["--at, --place", "found both"], ["column", "g.tcell", "--axis", "z", "--at", "1,1", "--place", "1,1"]),
                (["--place", "2 coordinates", "'1,2,3'"], ["column", "g.tcell", "--axis", "z", "--place", "1,2,3"]),
                (["--place", "along z", "found 9"], ["column", "g.tcell", "--axis", "y", "--place", "1,9"]),
                (["'pyramid'", "stadium"], ["sample", "pyramid", "-o", "x"])):
            self.refused(2, phrases, *args)

    def test_mesh_options(self):
        mesh = lambda *more: ["mesh", "box.stl", "-o", "x.tcell", *more]
        for phrases, args in (
                (["--cells", "--step"], mesh()),
                (["--cells", "1 to 2147483646", "found 0"], mesh("--cells", 0)),
                (["--cells", "whole number", "'many'"], mesh("--cells", "many")),
                (["--cells", "3 whole numbers", "'10,10'"], mesh("--cells", "10,10")),
                (["pad"], mesh("--cells", 2)),
                (["--cells and --step"], mesh("--cells", 10, "--step", 1)),
                (["--step", "above 0", "-1"], mesh("--step", -1)),
                (["--step", "number", "'x'"], mesh("--step", "x")),
                (["at most 2147483646 cells", "larger step"], mesh("--step", 1e-300)),
                (["--pad", "0 to", "-1"], mesh("--cells", 10, "--pad", -1)),
                (["--axis", "auto", "x", "y", "z", "w"], mesh("--cells", 10, "--axis", "w")),
                (["--fill", "evenodd"], mesh("--cells", 10, "--fill", "odd")),
                (["--threads", "1 to 1024"], mesh("--cells", 10, "--threads", 0)),
                (["--threads", "whole number", "'two'"], mesh("--cells", 10, "--threads", "two")),
                (["--step", "once", "2 times"], mesh("--step", 1, "--step", 2)),
                (["--progress", "plain"], mesh("--cells", 10, "--progress", "loud")),
                (["--engine", "scan"], mesh("--cells", 10, "--engine", "magic")),
                (["--report", "--output", "same"], mesh("--cells", 10, "--report", "x.tcell")),
                (["--output", ".tcell", "found"], ["mesh", "box.stl", "--cells", 10, "-o", "./box.stl"]),
                (["overwritten"], ["mesh", "box.stl", "--cells", 10, "-o", "box.tcell", "--report", "./box.stl"])):
            self.refused(2, phrases, *args)
        for slip in ("s.json", "a.STL", "a.obj", "a.ply", "a.stl.gz", "a.png", "a.npy"):
            self.refused(2, ["--output", ".tcell", slip], "mesh", "box.stl", "--cells", 10, "-o", slip)
        self.refused(2, ["g.tcell", "meshed already"], "mesh", "g.tcell", "--cells", 10, "-o", "x.tcell")
        self.write("s.json", {"grid": GRID, "materials": {"steel": {}}, "bodies": [BODY]})
        self.refused(2, ["one scene", "2 files"], "mesh", "s.json", "box.stl", "-o", "x.tcell")
        os.link(self.path("box.stl"), self.path("box.tcell"))
        self.refused(2, "overwritten", "mesh", "s.json", "-o", "box.tcell")
        self.refused(2, ["--pad", "begins and ends"], "mesh", "s.json", "--pad", 2, "-o", "x.tcell")

    def test_values_out_of_range_name_the_range(self):
        cut = lambda *more: ["slice", "g.tcell", "-o", "x.png", *more]
        for phrases, args in (
                (["--index", "along z", "0 to 7", "level 0", "found 8"], cut("--axis", "z", "--index", 8)),
                (["along z", "0 to 7", "found -1"], cut("--axis", "z", "--index", -1)),
                (["along x", "0 to 5", "level 1", "found 6"], cut("--axis", "x", "--index", 6, "--level", 1)),
                (["--level", "0 to 4", "found 5"], cut("--axis", "x", "--index", 0, "--level", 5)),
                (["--level", "0 to 4", "found -1"], cut("--axis", "x", "--at", 0, "--level", -1)),
                (["--index", "whole number", "'1.5'"], cut("--axis", "x", "--index", 1.5)),
                (["--axis", "x, y or z", "'w'"], cut("--axis", "w", "--index", 0)),
                (["--index", "--at"], cut("--axis", "z")),
                (["--index", "--at"], cut("--axis", "z", "--index", 0, "--at", 0)),
                (["--region", "along y", "0 to 10", "0 to 11"], cut("--axis", "z", "--index", 0, "--region", "0,0,5,11")),
                (["--region", "along z", "not empty"], cut("--axis", "x", "--index", 0, "--region", "3,4,4,4")),
                (["--region", "4 whole numbers"], cut("--axis", "z", "--index", 0, "--region", "1,2,3")),
                ([".png", ".npy", "'x.jpg'"], ["slice", "g.tcell", "--axis", "z", "--index", 0, "-o", "x.jpg"]),
                (["outside", "x is 0 to 11", "y is 0 to 9"], ["column", "g.tcell", "--axis", "z", "--at", "12,0"]),
                (["outside", "y is 0 to 9", "z is 0 to 7"], ["column", "g.tcell", "--axis", "x", "--at", "0,-1"]),
                (["--at", "2 whole numbers"], ["column", "g.tcell", "--axis", "x", "--at", "5"]),
                (["--region", "along x", "0 to 12"], ["stats", "g.tcell", "--region", "0,0,0,13,1,1"]),
                (["--region", "along z", "empty"], ["stats", "g.tcell", "--region", "0,0,3,1,1,3"]),
                (["--region", "6 whole numbers", "'a'"], ["stats", "g.tcell", "--region", "a"]),
                (["--region", "6 whole numbers"], ["stats", "g.tcell", "--region", ""]),
                (["--region", "6 whole numbers"], ["export", "g.tcell", "--region", "", "-o", "x.npy"]),
                (["--region", "along x", "0 to 3", "level 2"], ["export", "g.tcell", "--level", 2, "--region", "0,0,0,4,1,1", "-o", "x.npy"]),
                (["--level: expected", "0 to 4"], ["export", "g.tcell", "--level", 5, "-o", "x.npy"]),
                ([".npy", ".raw", "--format", "export --list"], ["export", "g.tcell", "-o", "x.bin"]),
                (["--fluid", "'water'"], ["export", "g.tcell", "-o", "case", "--format", "openfoam", "--fluid", "water"]),
                (["--zarr-version", "2 to 3", "'4'"], ["export", "g.tcell", "-o", "x.zarr", "--zarr-version", 4]),
                (["--ranks", "npy", "no such option"], ["export", "g.tcell", "-o", "x.npy", "--ranks", 2]),
                (["--profile", "gprmax", "'matlab'"], ["export", "g.tcell", "-o", "x.h5", "--profile", "matlab"]),
                (["--epsilon", "'water'"], ["export", "g.tcell", "-o", "x.h5", "--profile", "meep", "--epsilon", "water=1.77"]),
                (["--epsilon", "none for"], ["export", "g.tcell", "-o", "x.xml", "--format", "openems"]),
                (["--refine", "M,N", "leaves"], ["export", "g.tcell", "-o", "x.npy", "--format", "leaves"]),
                (["--refine", "0 to 16", "'17,2'"], ["export", "g.tcell", "-o", "x.vtu", "--refine", "17,2"]),
                (["--refine", "npy", "no such option"], ["export", "g.tcell", "-o", "x.npy", "--refine", 3]),
                (["--want", "'water'", "air"], ["export", "g.tcell", "-o", "x.vtu", "--refine", 3, "--want", "material:water=0"]),
                (["--want", "links", "meshed without"], ["export", "g.tcell", "-o", "x.vtu", "--refine", 3, "--want", "patch:xmin=0"]),
                (["--want", "box:", "'box:9,9,9,8,8,8'"], ["export", "g.tcell", "-o", "x.vtu", "--refine", 3, "--want", "box:9,9,9,8,8,8=0"]),
                (["--want", "--refine"], ["export", "g.tcell", "-o", "case", "--format", "openfoam", "--want", "interface=1"]),
                (["--level", "expected 0", "1"], ["export", "g.tcell", "-o", "x.vtu", "--refine", 3, "--level", 1]),
                (["--count", "--refine"], ["export", "g.tcell", "--count"]),
                (["--json", "--count"], ["export", "g.tcell", "-o", "x.npy", "--json"]),
                (["--output", "none"], ["export", "g.tcell", "--format", "vtu", "--refine", 3]),
                (["--format", "npy", "raw"], ["export", "g.tcell", "-o", "x.npy", "--format", "vtk"])):
            self.refused(2, phrases, *args)

    def test_a_map_names_all_materials_that_are_written(self):
        corner = ["export", "g.tcell", "--region", "0,0,0,1,1,1", "--map", "air=5"]
        self.run_ok(*corner, "-o", "x.npy")
        self.refused(2, ["--map", "none for"], *corner, "-o", "x.zarr")  # the cells of its coarse levels reach beyond the region

    def test_at_outside_the_domain(self):
        lo, hi = [self.json_of("info", "g.tcell")["grid"][k][2] for k in ("min", "max")]
        for at in (lo - 1e-9, hi + 1e-9, "nan", "inf", 1e300):
            self.refused(2, ["--at", "along z", f"{lo:.3g}", f"{hi:.3g}"], "slice", "g.tcell", "--axis", "z", "--at", at, "-o", "x.png")

    def test_scene_keys_and_values(self):
        for phrases, change in (
                (["unknown key \"bodys\"", "\"bodies\""], {"bodys": []}),
                (["grid", "unknown key \"cell\"", "\"cells\""], {"grid": {**GRID, "cell": 3}}),
                (["bodies[0]", "unknown key \"materiel\"", "\"material\""], {"bodies": [{**BODY, "materiel": "x"}]}),
                (["materials.steel", "unknown key \"colour\"", "\"color\""], {"materials": {"steel": {"colour": "#000000"}}}),
                (["bodies[0].material", "nearest is \"steel\"", "found \"stel\""], {"bodies": [{**BODY, "material": "stel"}]}),
                (["bodies[0]", "mesh"], {"bodies": [{"material": "steel"}]}),
                (["bodies[0].fill", "auto, nonzero, evenodd", "\"even\""], {"bodies": [{**BODY, "fill": "even"}]}),
                (["bodies[0].priority", "integer"], {"bodies": [{**BODY, "priority": 1.5}]}),
                (["matrix", "translate"], {"bodies": [{**BODY, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0], "translate": [1, 0, 0]}]}),
                (["bodies[0].matrix", "singular"], {"bodies": [{**BODY, "matrix": [0] * 12}]}),
                (["materials.steel.color", "#rrggbb", "\"red\""], {"materials": {"steel": {"color": "red"}}}),
                (["units", "m, cm, mm", "\"km\""], {"units": "km"}),
                (["sample[0]", "0 to below 1"], {"sample": [1, 0, 0]}),
                (["label_by", "material, body"], {"label_by": "bodies"}),
                (["grid.x.planes", "ascend", "plane 2"], {"grid": {**GRID, "x": {"planes": [0, 1, 1]}}}),
                (["grid", "min", "max", "found 9 and 5"], {"grid": {**GRID, "min": [9, 0, 0]}}),
                (["cells and step"], {"grid": {**GRID, "step": 1}}),
                (["grid.cells"], {"grid": {**GRID, "cells": [1, 2]}}),
                (["bodies", "array"], {"bodies": {}})):
            self.write("s.json", {"grid": GRID, "materials": {"steel": {}}, "bodies": [BODY], **change})
            self.refused(2, ["s.json: ", *phrases], "mesh", "s.json", "-o", "x.tcell")

    def test_a_scene_that_is_not_json(self):
        for text, phrase in (("{", "line 1"), ('{"grid": {},\n "bodies": [}', "line 2"), ("[]", "expected an object"), ("", "line 1")):
            self.write("s.json", text)
            self.refused(2, ["s.json: ", phrase], "mesh", "s.json", "-o", "x.tcell")

    def test_an_existing_output_stays_when_usage_is_wrong(self):
        before = self.bytes("g.tcell")
        self.refused(2, "--cells", "mesh", "box.stl", "--cells", 0, "-o", "g.tcell")
        self.assertEqual(self.bytes("g.tcell"), before)

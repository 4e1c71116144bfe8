"""Surfaces that can't be meshed: exit status 1, and the message says what is wrong, where, what was expected and what was found."""
import gzip
import math
import struct
import subprocess

import solids
from program import PROGRAM, Case, Result

BOX = solids.box_facets((0.0, 0.0, 0.0), (4.0, 3.0, 2.0))
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"


class Inputs(Case):
    def refuse(self, name, contents, phrases, status=1, *more):
        self.write(name, contents)
        self.refused(status, [name, *phrases], "mesh", name, "--cells", 10, "-o", "x.tcell", *more)

    def cells_of_box(self):
        self.write("box.stl", solids.binary_stl(BOX))
        self.run_ok("mesh", "box.stl", "--cells", 10, "-o", "box.tcell")
        return self.json_of("stats", "box.tcell")["materials"][1]["cells"]

    def test_files_that_are_not_there(self):
        self.refused(1, ["no.stl", "No such file"], "mesh", "no.stl", "--cells", 4, "-o", "x.tcell")
        self.refused(1, ["no.json", "No such file"], "mesh", "no.json", "-o", "x.tcell")
        self.refused(1, [self.folder, "folder"], "mesh", self.folder, "--cells", 4, "-o", "x.tcell")
        scene = {"grid": {"cells": 4}, "materials": {"a": {}}, "bodies": [{"mesh": "no.stl", "material": "a"}]}
        self.write("s.json", scene)
        self.refused(1, ["no.stl", "No such file"], "mesh", "s.json", "-o", "x.tcell")
        self.write("s.json", {**scene, "grid": {"cells": 4, "x": {"planes_file": "no.txt"}}})
        self.refused(1, ["no.txt", "No such file"], "mesh", "s.json", "-o", "x.tcell")

    def test_open_surfaces_are_described(self):
        words = ["'open'", "not closed", "3 edges", "within the box (4, 0, 0) to (4, 3, 2)", "(4, 0, 0)", '"closing": "cap"']
        self.refuse("open.stl", solids.binary_stl(BOX[:-1]), words, 1, "--closing", "strict")

    def test_open_surfaces_are_closed(self):
        self.write("open.stl", solids.binary_stl(BOX[:-1]))
        run = self.run_ok("mesh", "open.stl", "--cells", 10, "--write-caps", "caps.stl", "-o", "x.tcell")
        self.assertIn("1 hole (3 edges)", run.err)
        self.assertEqual(self.json_of("stats", "x.tcell")["materials"][1]["cells"], self.cells_of_box())
        self.assertEqual(len(self.bytes("caps.stl")), 84 + 3 * 50)
        hole, = self.json_of("info", "x.tcell")["report"]["bodies"][0]["holes"]
        self.assertEqual(hole["edges"], 3)

    def test_flipped_facets(self):
        flipped = [BOX[0][::-1], *BOX[1:]]
        self.refuse("flipped.stl", solids.binary_stl(flipped), ["not closed", "matched by its reverse", "evenodd"], 1, "--fill", "nonzero", "--closing", "strict")
        self.run_ok("mesh", "flipped.stl", "--cells", 10, "-o", "x.tcell")
        self.assertEqual(self.json_of("info", "x.tcell")["report"]["bodies"][0]["fill"][0]["rule"], "evenodd")

    def test_files_without_facets(self):
        self.refuse("empty.stl", b"", ["empty"])
        self.refuse("none.stl", solids.binary_stl([]), ["no facet"])
        self.refuse("none.obj", OBJ, ["no facet"])
        self.refuse("solid.stl", "solid a\nendsolid a\n", ["no facet"])

    def test_text_that_poses_as_stl(self):
        self.refuse("list.stl", "milk\nbread and butter\n" * 20, ["not a surface file", "STL, OBJ, PLY, OFF, 3MF, glTF or STEP", "milk"])
        self.refuse("rock.stl", "solid as a rock\nnothing else\n", ["line 2", "'facet'", "'nothing else'"])

    def test_files_of_another_kind_are_named(self):
        for name, contents, phrases in (("page.obj", "<!DOCTYPE html>\n<html></html>\n", ["a web page"]),
                                        ("part.brep", "DBRep_DrawableShape\n", ["this is an Open CASCADE BREP file: expected STL, OBJ, PLY, OFF, 3MF, glTF or STEP; export it as one of these"]),
                                        ("part.stl.gz", gzip.compress(b"DBRep_DrawableShape\n"), ["an Open CASCADE BREP file, compressed by gzip"])):
            self.refuse(name, contents, phrases)
        self.cells_of_box()
        self.refuse("grid.stl", self.bytes("box.tcell"), ["a grid that teracell made", "teracell info"])

    def test_what_readers_skip_is_warned_of_once(self):
        cells = self.cells_of_box()
        text = solids.ascii_stl(BOX)
        obj = "".join(f"v {x} {y} {z}\n" for facet in BOX for x, y, z in facet) + "".join(f"f {i} {i + 1} {i + 2}\n" for i in range(1, 3 * len(BOX), 3))
        ply = solids.ply((0.0, 0.0, 0.0), (4.0, 3.0, 2.0), "ascii").decode().splitlines()
        body = ply.index("end_header") + 1
        longer = "\n".join([*ply[:body], *(row + " 255 0.5" for row in ply[body:])]) + "\n"  # as MeshLab has written it
        said = f"{len(ply) - body} rows have more values than the header declares, the first in line {body + 1}, of vertex: these values were left out."
        for name, contents, warnings in (("longer.ply", longer, [said]), ("behind.stl", solids.binary_stl(BOX) + bytes(120), ["120 bytes after the last facet were skipped"]),
                                         ("open.stl", text[: text.rindex("endsolid")], ["the file ends without 'endsolid': it may be cut short"]),
                                         ("color.stl", text.replace("outer", "color 1 0 0\nouter"), ["12 lines that are not STL were skipped, the first is line 3, 'color 1 0 0'"]),
                                         ("line.stl", text.replace("\n", " "), []),
                                         ("lines.obj", obj + "l 1 2\np 3\n", ["1 polyline and 1 point were skipped"]),
                                         ("surface.obj", obj + "surf 0 1 0 1 1 2 3 4\n", ["1 free-form surface was skipped: convert surfaces to polygons where the body needs them"])):
            self.write(name, contents)
            r = self.run_ok("mesh", name, name, "--cells", 10, "-o", "x.tcell")
            expected = [f"{name}: {w}" for w in warnings]
            said = [w for w in r.err.splitlines() if "owns no cell" not in w]
            self.assertEqual(said, [f"warning: {w}" for w in expected])
            self.assertEqual([w for w in self.json_of("info", "x.tcell")["report"]["warnings"] if "owns no cell" not in w], expected)
            for w in expected:
                self.assertIn(w, self.run_ok("info", "x.tcell").out)
            self.assertEqual(self.json_of("stats", "x.tcell")["materials"][2]["cells"], cells, name)

    def test_invalid_numbers(self):
        for bad, shown in ((math.nan, "nan"), (math.inf, "inf"), (-math.inf, "-inf")):
            (a, b, c), *rest = BOX
            self.refuse("bad.stl", solids.binary_stl([((bad, 0.0, 0.0), b, c), *rest]), ["facet 0", "finite", shown])
        self.refuse("bad.obj", OBJ.replace("v 0 1 0", "v 0 1e400 0"), ["line 3", "1e400", "too large"])
        text = solids.ascii_stl(BOX)
        x = text.index("vertex ") + 7
        self.refuse("large.stl", text[:x] + "1e39" + text[text.index(" ", x):], ["line 4", "'1e39'", "too large for float32 (at most 3.4e38)"])
        self.refuse("word.obj", OBJ.replace("v 0 1 0", "v 0 one 0"), ["line 3", "number", "'one'"])
        self.refuse("tiny.obj", OBJ.replace("v 0 1 0", "v 0 1e-80 0"), ["line 3", "1e-75"])

    def test_numbers_that_disagree(self):
        whole = solids.binary_stl(BOX)
        self.refuse("cut.stl", whole[:-50], ["12 facets", "684", "634", "cut short"])
        self.refuse("lie.stl", whole[:80] + struct.pack("<I", 4000000000) + whole[84:], ["4000000000 facets", "cut short"])
        self.refuse("index.obj", OBJ + "f 1 2 9\n", ["line 5", "vertex 9", "4"])
        ply = solids.ply((0.0, 0.0, 0.0), (1.0, 1.0, 1.0), "ascii")
        self.refuse("cut.ply", ply[:-10], ["cut short", "face 5 of 6"])
        self.refuse("index.ply", ply.replace(b"4 0 2 3 1", b"4 0 2 3 8"), ["below 8", "found 8"])
        self.refuse("cut.stl.gz", gzip.compress(whole)[:-20], ["cut short"])

    def test_ascii_stl_that_ends_early(self):
        text = solids.ascii_stl(BOX)
        self.refuse("early.stl", text[: text.rindex("endloop")], ["line", "endloop", "end of the file"])

    def test_a_part_that_is_not_there(self):
        self.write("two.stl", solids.ascii_stl(BOX, "deck"))
        self.write("s.json", {"grid": {"cells": 9}, "materials": {"a": {}}, "bodies": [{"mesh": "two.stl", "part": "keel*", "material": "a"}]})
        self.refused(1, ["two.stl", "keel*", "'deck'"], "mesh", "s.json", "-o", "x.tcell")

    def test_planes_files_name_the_line(self):
        self.write("box.stl", solids.binary_stl(BOX))
        scene = {"grid": {"cells": 9, "x": {"planes_file": "x.txt"}}, "materials": {"a": {}}, "bodies": [{"mesh": "box.stl", "material": "a"}]}
        self.write("s.json", scene)
        self.write("x.txt", "0\n1\nfour\n")
        self.refused(1, ["x.txt:3", "number", "four"], "mesh", "s.json", "-o", "x.tcell")
        self.write("s.json", {**scene, "grid": {"cells": 9, "x": {"planes_file": "/dev/zero"}}})
        self.refused(1, ["/dev/zero", "at most"], "mesh", "s.json", "-o", "x.tcell")

    def test_names_send_no_control_characters_to_the_terminal(self):
        box = solids.binary_stl(BOX)
        for name, shown in ((b"e\x1b[31m\n.stl", "e?[31m?"), (b"a\xff.stl", "a\ufffd"), ("\u00e5\u009b.stl".encode(), "\u00e5?")):
            self.write(name.decode(errors="surrogateescape"), box)
            output = name[:-4] + b".tcell"
            r = Result(name, subprocess.run([PROGRAM, "mesh", name, "--cells", "9", "-o", output], cwd=self.folder, capture_output=True))
            self.assertEqual((r.status, r.err), (0, ""))
            info = Result(name, subprocess.run([PROGRAM, "info", output], cwd=self.folder, capture_output=True))
            self.assertEqual(info.status, 0, info.err)
            gone = Result(name, subprocess.run([PROGRAM, "mesh", b"no" + name, "--cells", "9", "-o", output], cwd=self.folder, capture_output=True))
            self.assertEqual(gone.status, 1)
            self.assert_paragraph(gone.err)
            for said in (r.out, info.out, gone.err):
                self.assertIn(shown, said)
                self.assertTrue(all(c.isprintable() or c in "\n\ufffd" for c in said), repr(said))
        self.write("box.stl", box)
        scene = {"grid": {"cells": 9}, "materials": {"a": {}}, "bodies": [{"mesh": "box.stl", "material": "a"}]}
        for change, phrase in (({"materials": {"a": {}, "\x1b[2J": {}}}, 'materials["\\u001b[2J"]'),
                               ({"units": "\x9b"}, 'found "?"'), ({"\x1b]0;x\x07": 1}, "unknown key"),
                               ({"bodies": [{**scene["bodies"][0], "name": "a\rb"}]}, "bodies[0].name: expected a string without control characters")):
            self.write("s.json", {**scene, **change})
            self.refused(2, ["s.json: ", phrase], "mesh", "s.json", "-o", "x.tcell")
        self.write("s.json", b'{"units": "\xff"}')
        self.refused(2, ["s.json: line 1", "UTF-8"], "mesh", "s.json", "-o", "x.tcell")
        self.refused(2, ["no command '?[0m'"], "\x1b[0m")

    def test_existing_output_stays_when_a_new_run_fails(self):
        self.cells_of_box()
        before = self.bytes("box.tcell")
        self.write("x.tcell", before)
        self.refuse("open.stl", solids.binary_stl(BOX[:-1]), ["not closed"], 1, "--closing", "strict")
        self.assertEqual(self.bytes("x.tcell"), before)

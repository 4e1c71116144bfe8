"""Bare surfaces on the command line: formats, --cells, --step, --pad, several bodies. The surfaces are boxes, whose cells are known."""
import solids
from program import Case

LO, HI = (0.0, 0.0, 0.0), (10.0, 5.0, 2.0)


class BareMeshes(Case):
    def assert_cells(self, axes, boxes, grid="g.tcell"):
        shape = tuple(len(axes[d]) for d in (2, 1, 0))
        self.assertEqual(self.export(grid), (shape, solids.cells_of(axes, boxes)))

    def test_every_format_gives_the_same_cells(self):
        axes = [solids.centres(-0.5, 0.5, n) for n in (22, 12, 6)]
        for name, contents in solids.every_format(LO, HI).items():
            self.write(name, contents)
            self.run_ok("mesh", name, "--cells", 22, "-o", "g.tcell")
            self.assert_cells(axes, [(LO, HI, 1)])

    def test_cells_step_and_pad(self):
        self.write("box.stl", solids.binary_stl(solids.box_facets(LO, HI)))
        for options, low, step, cells in ((["--cells", 22], -0.5, 0.5, (22, 12, 6)),
                                          (["--cells", 20, "--pad", 0], 0, 0.5, (20, 10, 4)),  # a box fills its grid
                                          (["--cells", 26, "--pad", 3], -1.5, 0.5, (26, 16, 10)),
                                          (["--cells", "12,7,4"], -1, 1, (12, 7, 4)),
                                          (["--step", 0.75, "--pad", 2], -1.5, 0.75, (18, 11, 7))):
            said = self.run_ok("mesh", "box.stl", *options, "-o", "g.tcell").out
            if options == ["--cells", 22]:
                self.assertIn("cells: 22 counts the cells of the longest axis, x with its pad; cells are cubes, so other axes have fewer", said)
            elif options == ["--cells", "12,7,4"]:
                self.assertNotIn("longest", said)
            self.assertEqual([(a["min"], a["step"], a["first"], a["cells"]) for a in self.json_of("info", "g.tcell")["grid"]["axes"]],
                             [(low, step, 0, n) for n in cells])
            self.assert_cells([solids.centres(low, step, n) for n in cells], [(LO, HI, 1)])

    def test_materials_are_file_stems_and_later_bodies_win(self):
        boxes = [(LO, HI, 1), ((2.0, 1.0, 0.5), (6.0, 4.0, 1.5), 2), ((4.0, 2.0, 1.0), (8.0, 3.0, 3.0), 3)]
        self.write("hull.stl", solids.binary_stl(solids.box_facets(*boxes[0][:2])))
        self.write("tank.obj", solids.obj(*boxes[1][:2]))
        self.write("mast.ply", solids.ply(*boxes[2][:2], "ascii"))
        said = self.run_ok("mesh", "hull.stl", "tank.obj", "mast.ply", "--step", 0.5, "-o", "g.tcell")
        overlaps = "hull and tank have 96 cells in common, some of them owned by a third body; 2 more pairs overlap too"
        self.assertIn(f"overlaps: {overlaps}\n", said.out)
        self.assertIn(f"overlaps    {overlaps}\n", self.run_ok("info", "g.tcell").out)
        info = self.json_of("info", "g.tcell")
        self.assertEqual([m["name"] for m in info["materials"]], ["air", "hull", "tank", "mast"])
        self.assert_cells([solids.centres(-0.5, 0.5, n) for n in (22, 12, 8)], boxes)
        self.run_ok("mesh", "mast.ply", "tank.obj", "hull.stl", "--step", 0.5, "-o", "r.tcell")
        self.assert_cells([solids.centres(-0.5, 0.5, n) for n in (22, 12, 8)], [(lo, hi, 4 - m) for lo, hi, m in reversed(boxes)], "r.tcell")

    def test_equal_stems_are_numbered(self):
        for name in ("box.stl", "box.obj"):
            self.write(name, solids.every_format(LO, HI)["binary.stl" if name == "box.stl" else "box.obj"])
        self.run_ok("mesh", "box.stl", "box.obj", "--cells", 12, "-o", "g.tcell")
        names = [m["name"] for m in self.json_of("info", "g.tcell")["materials"]]
        self.assertEqual(len(set(names)), 3)
        self.assertTrue(all(n.startswith("box") for n in names[1:]), names)

    def test_faces_through_sample_points_give_the_same_cells_for_every_ray_axis(self):
        # Steps of 1 from -0.5: sample points lie on every face, edge and corner of the boxes.
        boxes = [((0.0, 0.0, 0.0), (4.0, 3.0, 2.0), 1), ((4.0, 0.0, 0.0), (6.0, 3.0, 2.0), 2), ((1.0, 3.0, 0.0), (5.0, 5.0, 2.0), 3)]
        for i, (lo, hi, _) in enumerate(boxes):
            self.write(f"{i}.stl", solids.binary_stl(solids.box_facets(lo, hi)))
        grid = {"min": [-1.5, -1.5, -1.5], "max": [8.5, 6.5, 4.5], "cells": [10, 8, 6]}
        materials = {"a": {}, "b": {}, "c": {}}
        self.write("s.json", {"grid": grid, "materials": materials, "bodies": [{"mesh": f"{i}.stl", "material": m} for i, m in enumerate("abc")]})
        for axis in ("x", "y", "z", "auto"):
            self.run_ok("mesh", "s.json", "--axis", axis, "-o", "g.tcell")
            self.assert_cells([solids.centres(-1.5, 1, n) for n in (10, 8, 6)], boxes)

    def test_fill_evenodd_leaves_the_overlap_out(self):
        both = solids.box_facets(LO, HI) + solids.box_facets((4.0, 1.0, 0.5), (12.0, 4.0, 1.5))
        self.write("two.stl", solids.binary_stl(both))
        axes = [solids.centres(-0.5, 0.5, n) for n in (26, 12, 6)]
        overlap = ((4.0, 1.0, 0.5), (10.0, 4.0, 1.5), 0)
        union = [(LO, HI, 1), ((4.0, 1.0, 0.5), (12.0, 4.0, 1.5), 1)]
        for fill, boxes in (("auto", union), ("nonzero", union), ("evenodd", union + [overlap])):
            self.run_ok("mesh", "two.stl", "--step", 0.5, "--fill", fill, "-o", "g.tcell")
            self.assert_cells(axes, boxes)

    def test_more_than_256_materials_make_16_bit_arrays(self):
        bodies, materials, boxes = [], {}, []
        for i in range(300):
            lo = (float(i % 20), float(i // 20), 0.0)
            hi = (lo[0] + 1, lo[1] + 1, 1.0)
            self.write(f"{i}.stl", solids.binary_stl(solids.box_facets(lo, hi)))
            materials[f"m{i}"] = {"color": f"#{i * 40503 % 0xFFFFFF:06x}"}
            bodies.append({"mesh": f"{i}.stl", "material": f"m{i}"})
        self.write("s.json", {"grid": {"min": [0, 0, 0], "max": [20, 15, 1], "cells": [20, 15, 1]}, "materials": materials, "bodies": bodies})
        self.run_ok("mesh", "s.json", "-o", "g.tcell")
        self.assertEqual(self.export("g.tcell"), ((1, 15, 20), list(range(1, 301))))
        self.assertEqual(self.slice_npy("g.tcell", "--axis", "z", "--index", 0), ((15, 20), list(range(1, 301))))
        picture = self.slice_png("g.tcell", "--axis", "z", "--index", 0)
        self.assertEqual((picture.kind, picture.bits), (6, 8), "too many colours for a palette")
        for r, row in enumerate(picture.rows):
            for u, c in enumerate(row):
                n = (14 - r) * 20 + u
                self.assertEqual(c, (*(n * 40503 % 0xFFFFFF).to_bytes(3, "big"), 255))

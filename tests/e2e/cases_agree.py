"""export, slice, column and stats must agree on the cells of one grid, the stadium."""
import json
import math
import pathlib
import random
import shutil
import tempfile

import pyramid
from program import Case, read_npy, read_png, teracell

ORDER = [1, 3, 2, 0]  # explosive, structure, grandstand, air: the strongest first
UV = {"z": (0, 1), "y": (0, 2), "x": (1, 2)}


class Stadium(Case):
    @classmethod
    def setUpClass(cls):
        cls.home = pathlib.Path(tempfile.mkdtemp(prefix="teracell-e2e-stadium-"))
        cls.addClassCleanup(shutil.rmtree, cls.home, ignore_errors=True)
        for args in (["sample", "stadium", "-o", "stadium"], ["mesh", "stadium/scene.json", "-o", "g.tcell"], ["export", "g.tcell", "-o", "g.npy"]):
            r = teracell(*args, cwd=cls.home)
            assert r.status == 0, r.err
        cls.shape, cls.cells = read_npy((cls.home / "g.npy").read_bytes())
        cls.levels = [(cls.shape, pyramid.masks(cls.cells))]
        while cls.levels[-1][0] != (1, 1, 1):
            cls.levels.append(pyramid.halve(*cls.levels[-1]))
        cls.grid, cls.scene = cls.home / "g.tcell", cls.home / "stadium/scene.json"
        materials = json.loads(cls.scene.read_text())["materials"]
        cls.colors = [pyramid.color(materials[m]["color"]) for m in ("air", "explosive", "grandstand", "structure")]

    def level_cells(self, level):
        shape, sets = self.levels[level]
        return shape, pyramid.strongest(sets, ORDER)

    def test_sample_has_the_default_grid_and_every_material(self):
        self.assertEqual(self.shape, (60, 240, 300))
        self.assertEqual(set(self.cells), {0, 1, 2, 3})

    def test_slices_are_the_planes_of_the_export(self):
        for axis, n in (("x", 300), ("y", 240), ("z", 60)):
            for index in sorted({0, n - 1, *range(3, n, 13)}):
                rows, columns, expected = pyramid.plane(self.shape, self.cells, axis, index)
                shape, found = self.slice_npy(self.grid, "--axis", axis, "--index", index)
                self.assertEqual(shape, (rows, columns))
                self.assertEqual(found, expected, f"{axis} {index}")

    def assert_picture(self, picture, plane, colors, said):
        """The picture has the colour of each value of a plane, and v goes up."""
        rows, columns, expected = plane
        self.assertEqual((picture.width, picture.height), (columns, rows))
        for r in range(rows):
            v = rows - 1 - r
            self.assertEqual(picture.rows[r], [colors[m] for m in expected[v * columns : (v + 1) * columns]], f"{said} row {r}")

    def test_pictures_show_v_up_in_the_colours_of_the_scene(self):
        for axis, index in (("z", 5), ("y", 77), ("x", 167), ("z", 0)):
            picture = self.slice_png(self.grid, "--axis", axis, "--index", index)
            self.assertEqual((picture.kind, picture.bits), (3, 2))
            self.assert_picture(picture, pyramid.plane(self.shape, self.cells, axis, index), self.colors, f"{axis} {index}")

    def test_pictures_of_coarse_levels_blend_the_colours_of_the_set(self):
        blends = [pyramid.blend([c for m, c in enumerate(self.colors) if s >> m & 1]) if s else None for s in range(16)]
        for axis, index, level in (("z", 3, 1), ("y", 20, 2), ("x", 12, 3), ("z", 0, 5), ("z", 0, 9)):
            picture = self.slice_png(self.grid, "--axis", axis, "--index", index, "--level", level)
            self.assert_picture(picture, pyramid.plane(*self.levels[level], axis, index), blends, f"{axis} {index} level {level}")

    def test_every_level_holds_the_union_of_the_level_below(self):
        self.assertEqual(len(self.levels), 10)
        for level in range(10):
            self.assertEqual(self.export(self.grid, "--level", level), self.level_cells(level), f"level {level}")
        for level, axis, index in ((1, "x", 80), (2, "y", 31), (3, "z", 4), (4, "x", 9), (7, "y", 1)):
            shape, cells = self.level_cells(level)
            rows, columns, expected = pyramid.plane(shape, cells, axis, index)
            self.assertEqual(self.slice_npy(self.grid, "--axis", axis, "--index", index, "--level", level), ((rows, columns), expected))

    def test_views_show_the_first_material_of_each_column(self):
        nz, ny, nx = self.shape
        at = lambda x, y, z: self.cells[(z * ny + y) * nx + x]
        # The picture's size, and for its column and row the cells from the front to the back.
        views = {
            "x": (ny, nz, lambda c, r: (at(x, ny - 1 - c, nz - 1 - r) for x in range(nx))),
            "-x": (ny, nz, lambda c, r: (at(x, c, nz - 1 - r) for x in reversed(range(nx)))),
            "y": (nx, nz, lambda c, r: (at(c, y, nz - 1 - r) for y in range(ny))),
            "-z": (nx, ny, lambda c, r: (at(c, ny - 1 - r, z) for z in reversed(range(nz)))),
        }
        for view, (width, height, column) in views.items():
            self.run_ok("render", self.grid, "--view", view, "--flat", "--size", f"{width},{height}", "-o", "v.png", "--background", "#00000000")
            picture = read_png(self.bytes("v.png"))
            self.assertEqual((picture.width, picture.height), (width, height))
            for r in range(0, height, 3):
                expected = [next((self.colors[m] for m in column(c, r) if m), (0, 0, 0, 0)) for c in range(width)]
                self.assertEqual(picture.rows[r], expected, f"{view} row {r}")

    def test_regions_are_cut_from_the_whole(self):
        rng = random.Random(7)
        for level in (0, 0, 0, 1, 2, 3):
            shape, cells = self.level_cells(level)
            n = shape[::-1]
            lo = [rng.randrange(n[d]) for d in range(3)]
            hi = [rng.randint(lo[d] + 1, n[d]) for d in range(3)]
            expected = pyramid.box(shape, cells, lo, hi)
            region = ",".join(map(str, lo + hi))
            self.assertEqual(self.export(self.grid, "--region", region, "--level", level), (tuple(hi[d] - lo[d] for d in (2, 1, 0)), expected), region)
            self.run_ok("export", self.grid, "--region", region, "--level", level, "-o", "box.raw")
            self.assertEqual(self.bytes("box.raw"), expected)
            for axis, (u, v) in UV.items():
                w = "xyz".index(axis)
                cut_lo, cut_hi = list(lo), list(hi)
                cut_lo[w], cut_hi[w] = lo[w], lo[w] + 1
                window = f"{lo[u]},{lo[v]},{hi[u]},{hi[v]}"
                args = ("--axis", axis, "--index", lo[w], "--level", level, "--region", window)
                expected = pyramid.box(shape, cells, cut_lo, cut_hi)
                self.assertEqual(self.slice_npy(self.grid, *args), ((hi[v] - lo[v], hi[u] - lo[u]), expected), args)
                if level == 0:
                    picture = self.slice_png(self.grid, *args)
                    top = expected[-picture.width :]
                    self.assertEqual((picture.width, picture.height), (hi[u] - lo[u], hi[v] - lo[v]))
                    self.assertEqual(picture.rows[0], [self.colors[m] for m in top])

    def test_at_takes_the_cell_that_holds_the_coordinate(self):
        # z runs from -3 to 57 in steps of 1: a plane belongs to the cell above it, and the domain's upper end to the last cell.
        for at, index in ((-3, 0), (-2.0000001, 0), (-2, 1), (3.5, 6), (56.999, 59), (57, 59)):
            _, _, expected = pyramid.plane(self.shape, self.cells, "z", index)
            self.assertEqual(self.slice_npy(self.grid, "--axis", "z", "--at", at)[1], expected, at)
        shape, cells = self.level_cells(3)
        for at, index in ((-150, 0), (-142.5, 0), (-142, 1), (150, 37)):
            _, _, expected = pyramid.plane(shape, cells, "x", index)
            self.assertEqual(self.slice_npy(self.grid, "--axis", "x", "--at", at, "--level", 3)[1], expected, at)

    def test_a_plane_at_any_angle_has_the_cells_of_its_pixels(self):
        nz, ny, nx = self.shape
        low, width, height, pixel = (-150, -120, -3), 160, 120, 1.7  # cells are 1 wide
        colors = [tuple(c) for c in self.colors]
        for normal, offset, centre in (((1, 2, 3), 60, (10, 3, 20)), ((0.2, -0.1, 1), 5, (-90, 40, 5)), ((1, 0, 0), 17.25, (0, 0, 20))):
            size = math.sqrt(sum(n * n for n in normal))
            n = [x / size for x in normal]
            right = [-n[1] / math.hypot(n[0], n[1]), n[0] / math.hypot(n[0], n[1]), 0]  # z is up
            up = [n[1] * right[2] - n[2] * right[1], n[2] * right[0] - n[0] * right[2], n[0] * right[1] - n[1] * right[0]]
            off = offset / size - sum(a * b for a, b in zip(n, centre))
            middle = [c + off * a for c, a in zip(centre, n)]
            args = ("--plane", ",".join(map(str, (*normal, offset))), "--centre", ",".join(map(str, centre)), "--pixel", pixel, "--size", f"{width},{height}", "--level", 0)
            shape, found = self.slice_npy(self.grid, *args)
            picture = self.slice_png(self.grid, *args)
            self.assertEqual((shape, (picture.width, picture.height)), ((height, width), (width, height)))
            inside = 0
            for j in range(height):
                for i in range(width):
                    at = [m + pixel * ((i + 0.5 - width / 2) * r + (j + 0.5 - height / 2) * u) - lo for m, r, u, lo in zip(middle, right, up, low)]
                    if any(abs(x - round(x)) < 1e-9 for x in at):
                        continue  # between cells rounding decides
                    x, y, z = map(math.floor, at)
                    is_inside = 0 <= x < nx and 0 <= y < ny and 0 <= z < nz
                    inside += is_inside
                    material = self.cells[(z * ny + y) * nx + x] if is_inside else 0
                    color = tuple(picture.rows[height - 1 - j][i])
                    if found[j * width + i] != material or color != (colors[material] if is_inside else (0, 0, 0, 0)):
                        self.fail(f"{args}: pixel {i}, {j} at {at}: {found[j * width + i]}, {color}")
            self.assertGreater(inside, 1000)
        self.refused(2, ["--axis, --plane", "both"], "slice", self.grid, "--axis", "z", "--index", 3, "--plane", "0,0,1,3", "-o", "p.png")
        self.refused(2, ["--axis, --plane", "neither"], "slice", self.grid, "--index", 3, "-o", "p.png")
        self.refused(2, ["--region: expected a slice across an axis, found --plane"], "slice", self.grid, "--plane", "0,0,1,3", "--region", "0,0,1,1", "-o", "p.png")
        self.refused(2, ["--centre: expected --plane too"], "slice", self.grid, "--axis", "z", "--index", 3, "--centre", "0,0,0", "-o", "p.png")

    def test_columns_are_rows_of_the_export(self):
        nz, ny, nx = self.shape
        rng = random.Random(11)
        low = (-150, -120, -3)
        names = ["air", "explosive", "grandstand", "structure"]
        for axis, (u, v) in UV.items():
            w = "xyz".index(axis)
            n, stride = (nx, ny, nz), (1, nx, nx * ny)
            for corner in (False, True, False, False, False, False, False, False):
                a, b = (n[u] - 1, n[v] - 1) if corner else (rng.randrange(n[u]), rng.randrange(n[v]))
                j = self.json_of("column", self.grid, "--axis", axis, "--at", f"{a},{b}")
                self.assertEqual((j["schema"], j["axis"], j["at"]), (1, axis, [a, b]))
                found, end = [], 0
                for i, run in enumerate(j["runs"]):
                    self.assertEqual(run["from"], end)
                    self.assertLess(run["from"], run["to"])
                    self.assertEqual((run["min"], run["max"]), (low[w] + run["from"], low[w] + run["to"]))
                    self.assertEqual(run["name"], names[run["material"]])
                    if i:
                        self.assertNotEqual(run["material"], j["runs"][i - 1]["material"], "neighbouring runs have different materials")
                    found += [run["material"]] * (run["to"] - run["from"])
                    end = run["to"]
                place = f"{low[u] + a + rng.choice((0, 0.5, 0.875))},{low[v] + b + rng.choice((0, 0.5, 0.875))}"  # cells have sides of 1
                self.assertEqual(self.json_of("column", self.grid, "--axis", axis, f"--place={place}"), j)
                start = a * stride[u] + b * stride[v]
                self.assertEqual(bytes(found), self.cells[start : start + (n[w] - 1) * stride[w] + 1 : stride[w]], f"{axis} {a},{b}")

    def test_stats_count_the_cells_of_the_export(self):
        nz, ny, nx = self.shape
        regions = [None, [0, 0, 0, nx, ny, nz], [165, 75, 2, 175, 80, 9], [10, 20, 3, 211, 200, 41], [299, 239, 59, 300, 240, 60]]
        for region in regions:
            args = ["--region", ",".join(map(str, region))] if region else []
            j = self.json_of("stats", self.grid, *args)
            x0, y0, z0, x1, y1, z1 = region or [0, 0, 0, nx, ny, nz]
            self.assertEqual(j["region"], [x0, y0, z0, x1, y1, z1])
            for m in j["materials"]:
                count, lo, hi = 0, [nx, ny, nz], [0, 0, 0]
                for z in range(z0, z1):
                    for y in range(y0, y1):
                        row = self.cells[(z * ny + y) * nx + x0 : (z * ny + y) * nx + x1]
                        here = row.count(m["id"])
                        if here:
                            count += here
                            first, last = x0 + row.index(m["id"]), x0 + row.rindex(m["id"]) + 1
                            lo = [min(p) for p in zip(lo, (first, y, z))]
                            hi = [max(p) for p in zip(hi, (last, y + 1, z + 1))]
                self.assertEqual(m["cells"], count, m)
                self.assertAlmostEqual(m["volume"], count)
                self.assertEqual(m["box"], lo + hi if count else None, m)

    def test_the_report_counts_the_cells_that_bodies_own(self):
        report = self.json_of("info", self.grid)["report"]
        of = {m: sum(b["cells"] for b in report["bodies"] if b["name"] in names) for m, names in
              ((1, ["charge"]), (2, ["lower tier", "upper tier"]))}
        for m, cells in of.items():
            self.assertEqual(cells, self.cells.count(m))
        self.assertEqual(sum(b["cells"] for b in report["bodies"]), len(self.cells) - self.cells.count(0))

    def test_cells_are_the_same_for_rays_along_any_axis(self):
        for axis in "xyz":
            self.run_ok("mesh", self.scene, "--axis", axis, "-o", "a.tcell")
            self.assertEqual(self.json_of("info", "a.tcell")["ray_axis"], axis)
            self.assertEqual(self.export("a.tcell"), (self.shape, self.cells))
            self.assertEqual(self.export("a.tcell", "--level", 3), self.level_cells(3))
            self.run_ok("verify", "a.tcell")

    def test_the_file_is_the_same_for_any_number_of_threads(self):
        expected = self.grid.read_bytes()
        for threads in (1, 2, 3):
            self.run_ok("mesh", self.scene, "--threads", threads, "-o", "t.tcell")
            self.assertEqual(self.bytes("t.tcell"), expected, f"{threads} threads")
        for threads in (1, 3):
            self.run_ok("slice", self.grid, "--axis", "y", "--index", 100, "--threads", threads, "-o", f"{threads}.png")
        self.assertEqual(self.bytes("1.png"), self.bytes("3.png"))

"""`slice --true` on graded axes: each pixel is the cell that its middle lies in."""
import bisect
import random

import solids
from program import Case

COLORS = ["#000000", "#ff0000", "#00ff00", "#0000ff", "#ffff00", "#ff00ff"]


class ToScale(Case):
    def setUp(self):
        super().setUp()
        rng = random.Random(11)
        self.planes = []
        for cells in (37, 23, 5):
            planes = [rng.uniform(-5, 5)]
            while len(planes) <= cells:
                planes.append(planes[-1] + rng.choice([1, 1, 1, 20]) * rng.uniform(0.05, 0.3))
            self.planes.append(planes)
        bodies = []
        for i in range(30):
            spans = [sorted(rng.sample(range(len(p)), 2)) for p in self.planes]
            self.write(f"{i}.stl", solids.binary_stl(solids.box_facets(*zip(*((p[a], p[b]) for p, (a, b) in zip(self.planes, spans))))))
            bodies.append({"name": f"{i}", "mesh": f"{i}.stl", "material": f"m{rng.randrange(1, 6)}"})
        self.write("s.json", {"grid": {a: {"planes": p} for a, p in zip("xyz", self.planes)}, "units": "m", "bodies": bodies,
                              "materials": {f"m{i}": {"color": c} for i, c in enumerate(COLORS)}})
        self.run_ok("mesh", "s.json", "-o", "g.tcell")

    def shown(self, axis, level, lo, hi, pixels):
        """The cell of each pixel, counted from `lo`, and how long these cells are."""
        planes = self.planes["xyz".index(axis)]
        planes = [*planes[: -1 : 1 << level], planes[-1]][lo : hi + 1 if hi else None]
        length = planes[-1] - planes[0]
        return [bisect.bisect(planes, planes[0] + (i + 0.5) / pixels * length) - 1 for i in range(pixels)], length

    def test_every_pixel_is_the_cell_that_its_middle_lies_in(self):
        for across, u, v in (("z", "x", "y"), ("y", "x", "z"), ("x", "y", "z")):
            for more, level, (u0, v0, u1, v1) in (([], 0, (0, 0, None, None)), (["--level", 1], 1, (0, 0, None, None)), (["--level", 2], 2, (0, 0, None, None)),
                                                  (["--region", "7,1,20,4"], 0, (7, 1, 20, 4)), (["--level", 1, "--region", "2,1,9,3"], 1, (2, 1, 9, 3))):
                args = ["--axis", across, "--index", 1, *more]
                cells = self.slice_png("g.tcell", *args).rows[::-1]
                for pixels in (1, 50, 333, None):
                    picture = self.slice_png("g.tcell", *args, "--true", *(["--pixels", pixels] if pixels else []))
                    columns, width = self.shown(u, level, u0, u1, picture.width)
                    rows, height = self.shown(v, level, v0, v1, picture.height)
                    if pixels is None:
                        self.assertEqual(max(picture.width, picture.height), 1024)
                    else:
                        self.assertEqual(picture.width, pixels)
                    self.assertLessEqual(abs(picture.height - max(1, picture.width * height / width)), 1 if pixels else height / width + 1)
                    self.assertEqual(picture.rows[::-1], [[cells[r][c] for c in columns] for r in rows], (args, pixels))

    def test_usage(self):
        args = ["slice", "g.tcell", "--axis", "z", "--index", 0]
        self.refused(2, ["--true", "a picture"], *args, "--true", "-o", "a.npy")
        self.refused(2, ["--pixels", "--true"], *args, "--pixels", 100, "-o", "a.png")
        for pixels in (0, -1, 1 << 21):
            self.refused(2, ["--pixels: expected 1 to 1048576", f"found {pixels}"], *args, "--true", "--pixels", pixels, "-o", "a.png")

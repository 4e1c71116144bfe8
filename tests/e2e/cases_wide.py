"""Axes with more cells than are held in memory."""
import os
import resource
import subprocess
import zlib

import solids
from program import PROGRAM, Case, png_chunks, read_png

LONGEST = 2_147_483_646  # cells, the most of an axis
WIDTH, LO, HI = 200_000_000, 60_000_000, 140_000_000  # cells of the grid; the first cell of the box and the one behind it


class Wide(Case):
    width, lo, hi = WIDTH, LO, HI

    def setUp(self):
        super().setUp()
        self.write("box.stl", solids.binary_stl(solids.box_facets((float(self.lo), 0.0, 0.0), (float(self.hi), 1.0, 1.0))))
        self.write("s.json", {"units": "m", "grid": {"min": [0, 0, 0], "max": [self.width, 1, 1], "step": 1},
                              "materials": {"air": {"color": "#000000"}, "rock": {"color": "#ffffff"}},
                              "bodies": [{"mesh": "box.stl", "material": "rock"}]})
        self.run_ok("mesh", "s.json", "-o", "g.tcell", "--axis", "x")

    def run_in_little_memory(self, most, *args):
        """`most`: bytes. The memory of this process when it forked counts too, so it must stay small."""
        process = subprocess.Popen([PROGRAM, *map(str, args)], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        self.assertLess(used.ru_maxrss << 10, most)


class WideSlices(Wide):
    def write_in_little_memory(self, *args):
        self.run_in_little_memory(2 * WIDTH, *args)  # two bytes per cell

    def assert_row(self, blocks, cells_per_byte, rock):
        """Expects 0, then `rock` where the box is, then 0 again."""
        at, lo, hi = 0, LO // cells_per_byte, HI // cells_per_byte
        for block in blocks:
            begin, end = (min(max(n - at, 0), len(block)) for n in (lo, hi))
            self.assertEqual(block.count(rock, begin, end), end - begin)
            self.assertEqual(block.count(0), len(block) - (end - begin))
            at += len(block)
        self.assertEqual(at, WIDTH // cells_per_byte)

    def test_arrays(self):
        for args in (["slice", "g.tcell", "--axis", "z", "--index", 0, "--threads", 2], ["export", "g.tcell"]):
            self.write_in_little_memory(*args, "-o", "a.npy")
            with open(self.path("a.npy"), "rb") as f:
                f.seek(128)
                self.assert_row(iter(lambda: f.read(1 << 20), b""), 1, 1)

    def test_pictures(self):
        for axis in "zy":
            self.write_in_little_memory("slice", "g.tcell", "--axis", axis, "--index", 0, "-o", "p.png", "--threads", 2)
            row = zlib.decompress(b"".join(body for name, body in png_chunks(self.bytes("p.png")) if name == b"IDAT"))
            self.assertEqual(row[0], 0, "no filter")
            self.assert_row([row[1:]], 8, 255)

    def test_a_picture_to_scale(self):
        self.write_in_little_memory("slice", "g.tcell", "--axis", "z", "--index", 0, "--true", "--pixels", 1000, "-o", "p.png")
        picture = read_png(self.bytes("p.png"))
        self.assertEqual([pixel[0] for pixel in picture.rows[0]], [0] * 300 + [255] * 400 + [0] * 300)
        self.assertEqual(picture.height, 1)


class LongPartition(Wide):
    width, lo, hi = LONGEST, 600_000_000, 1_400_000_000

    def test_partitions_cost_by_runs(self):
        rock = lambda lo, hi: max(0, min(hi, self.hi) - max(lo, self.lo))
        for method in ("blocks", "slabs"):
            for more, weights in (([], (1, 1)), (["--weight", "air=1,rock=0"], (1, 0)), (["--weight", "air=0.5,rock=3"], (0.5, 3))):
                self.run_in_little_memory(64 << 20, "partition", "g.tcell", "--ranks", 8, "--method", method, *more, "-o", "p.json")
                plan, at = self.read_json("p.json"), 0
                total = weights[0] * (self.width - rock(0, self.width)) + weights[1] * rock(0, self.width)
                self.assertEqual(plan["total"], total)
                for part in plan["parts"]:
                    lo, hi = part["box"][0], part["box"][3]
                    self.assertEqual((lo, part["box"][1:3], part["box"][4:]), (at, [0, 0], [1, 1]))
                    self.assertEqual(part["weight"], weights[0] * (hi - lo - rock(lo, hi)) + weights[1] * rock(lo, hi))
                    self.assertLessEqual(abs(part["weight"] - total / 8), 2 * max(weights), (method, more))
                    at = hi
                self.assertEqual(at, self.width)

    def test_weights_of_which_all_are_0_are_refused(self):
        self.refused(2, "--weight: expected work in some cell of the grid, found 0 in all of them",
                     "partition", "g.tcell", "--ranks", 8, "--weight", "air=0,rock=0", "-o", "p.json")

    def test_advice_names_options_of_the_command(self):
        little = lambda: resource.setrlimit(resource.RLIMIT_AS, (200 << 20, 200 << 20))
        self.refused(1, "out of memory, or of threads: free some, or take fewer --ranks\n",
                     "partition", "g.tcell", "--ranks", 2_000_000, "-o", "p.json", preexec_fn=little)

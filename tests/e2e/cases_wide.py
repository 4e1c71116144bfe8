"""Slices whose rows are too wide to be held in memory."""
import os
import subprocess
import zlib

import solids
from program import PROGRAM, Case, png_chunks

WIDTH, LO, HI = 200_000_000, 60_000_000, 140_000_000  # cells of the grid; the first cell of the box and the one behind it


class Wide(Case):
    def setUp(self):
        super().setUp()
        self.write("box.stl", solids.binary_stl(solids.box_facets((float(LO), 0.0, 0.0), (float(HI), 1.0, 1.0))))
        self.write("s.json", {"units": "m", "grid": {"min": [0, 0, 0], "max": [WIDTH, 1, 1], "step": 1},
                              "materials": {"air": {"color": "#000000"}, "rock": {"color": "#ffffff"}},
                              "bodies": [{"mesh": "box.stl", "material": "rock"}]})
        self.run_ok("mesh", "s.json", "-o", "g.tcell", "--axis", "x")

    def write_in_little_memory(self, *args):
        process = subprocess.Popen([PROGRAM, *map(str, args)], cwd=self.folder, stdin=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        self.assertLess(used.ru_maxrss << 10, 2 * WIDTH, "more than two bytes per cell; the memory of this process when it forked counts too, so it must stay small")

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

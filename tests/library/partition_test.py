"""What `teracell partition` writes, read back through C++, Fortran and Python (C: tests/store/whole/partition_test.cpp)."""
import json
import pickle
import subprocess
import unittest

import teracell

from support import ENVIRONMENT, PROGRAM, SOURCES, compiled, folder, grids, run


def setUpModule():
    global path, written
    path = folder / "parts.json"
    run(PROGRAM, "partition", grids[0], "--ranks", "7", "--weight", "air=1,explosive=2.5,grandstand=0.1,structure=0", "--align", "4", "--halo", "2", "-o", path)
    written = json.loads(path.read_text())


def swapped(box):
    """From x, y, z to z, y, x, and back."""
    return tuple(box[2::-1]) + tuple(box[:2:-1])


class Partitions(unittest.TestCase):
    def test_the_file_says_which_grid_it_is_of(self):
        self.assertEqual(written["grid_hash"], json.loads(run(PROGRAM, "info", grids[0], "--json"))["file"]["hash"])
        self.assertEqual(teracell.Partition(path).grid_hash, teracell.open(grids[0]).hash)
        self.assertNotEqual(teracell.Partition(path).grid_hash, teracell.open(grids[1]).hash)

    def test_compiled_languages_read_what_is_written(self):
        for source in ("parts.cpp", "parts.f90"):
            plan, *parts = [line.split() for line in run(compiled(SOURCES / source), path, text=True, cwd=folder).splitlines()]
            self.assertEqual([int(n) for n in plan[:6]], [written["ranks"], *written["cells"], written["align"], written["halo"]])
            self.assertEqual((float(plan[6]), plan[7], plan[8]), (written["total"], written["method"], written["grid_hash"]))
            self.assertEqual(len(parts), 7)
            for found, part in zip(parts, written["parts"]):
                self.assertEqual([int(n) for n in found[:12]], part["box"] + part["halo_box"])
                self.assertEqual(float(found[12]), part["weight"])
                self.assertEqual([int(n) for n in found[13:]], part["neighbours"])

    def test_python_reads_what_is_written(self):
        partition = teracell.Partition(path)
        self.assertEqual((len(partition), partition.cells, partition.align, partition.halo, partition.total, partition.method),
                         (7, tuple(written["cells"][::-1]), 4, 2, written["total"], "blocks"))
        self.assertEqual(partition.cells, teracell.open(grids[0]).shape)
        for rank, (found, part) in enumerate(zip(partition, written["parts"])):
            self.assertEqual(found, (rank, swapped(part["box"]), swapped(part["halo_box"]), part["weight"], part["neighbours"]))
        self.assertEqual(partition[-1].rank, 6)
        self.assertEqual([p.rank for p in partition[2:4]], [2, 3])
        for rank in (7, -8, 2**70):
            with self.assertRaises(IndexError):
                partition[rank]
        self.assertEqual(list(pickle.loads(pickle.dumps(partition))), list(partition))
        shape = teracell.open(grids[0]).read(partition[3].halo_box).shape
        self.assertEqual(shape, tuple(partition[3].halo_box[d + 3] - partition[3].halo_box[d] for d in range(3)))

    def test_what_is_no_partition_is_refused(self):
        part = written["parts"][2]
        for change, words in (({"halo": 3}, "halo_box"), ({"halo": 2.0}, "halo: expected a whole number from 0 to 2147483646, found 2.0"), ({"align": 5}, "multiples of 5"),
                              ({"grid_hash": "x" * 32}, "grid_hash"), ({"cells": written["cells"] + [1]}, "cells: expected an array of 3, found an array of 4"),
                              ({"parts": written["parts"][:2] + [{**part, "halo_box": part["box"]}] + written["parts"][3:]}, "rank 2.*halo_box")):
            (folder / "wrong.json").write_text(json.dumps({**written, **change}))
            with self.assertRaisesRegex(teracell.FormatError, words):
                teracell.Partition(folder / "wrong.json")
        with self.assertRaises(teracell.IoError):
            teracell.Partition(folder / "none.json")
        said = subprocess.run([compiled(SOURCES / "parts.cpp"), folder / "none.json"], capture_output=True, text=True, env=ENVIRONMENT)
        self.assertEqual(said.stderr.split()[:2], ["2", "2"])  # TC_IO, ENOENT


if __name__ == "__main__":
    unittest.main()

"""What the Python clients share: the server's address, results of `teracell` itself, plain requests."""
import json
import os
import pathlib
import subprocess
import unittest
import urllib.error
import urllib.request

import numpy

SERVER = os.environ["TERACELL_URL"]
FOLDER = os.environ["TERACELL_FOLDER"]
GRIDS = json.loads(pathlib.Path(FOLDER, "grids.json").read_text())


def teracell(*args):
    subprocess.run([os.environ["TERACELL"], *map(str, args)], cwd=FOLDER, check=True, stdout=subprocess.DEVNULL)


def exported(grid, level):
    """Material ids [z][y][x]."""
    return numpy.load(os.path.join(FOLDER, f"{grid}.{level}.npy"))


def levels(grid):
    return range(len(GRIDS[grid]["levels"]))


LEVELS = [(grid, level) for grid in GRIDS for level in levels(grid)]


def get(path):
    with urllib.request.urlopen(f"{SERVER}/{path}", timeout=30) as answer:
        return answer.read()


class Case(unittest.TestCase):
    def assert_same(self, found, expected):
        """Expects the same type, shape and values."""
        self.assertEqual((found.dtype, found.shape), (expected.dtype, expected.shape))
        wrong = numpy.argwhere(found != expected)
        self.assertEqual(len(wrong), 0, f"{len(wrong)} values differ, the first at {wrong[:1]}")

    def assert_missing(self, path):
        """Expects status 404 with nothing that a client could take for data."""
        with self.assertRaises(urllib.error.HTTPError) as refused:
            get(path)
        self.assertEqual((refused.exception.code, refused.exception.read()), (404, b""), path)

#!/usr/bin/env python3
"""Writes the scene of a benchmark: one OBJ mesh in its cubic domain of N^3 cells, which the peers use too.

Usage: cubic_scene.py mesh.obj N scene.json
The domain's centre is that of the mesh's box; its edge is the longest extent with one cell of pad at either end.
"""
import json
import os
import sys


def cubic_scene(mesh, n):
    lo, hi = [float("inf")] * 3, [float("-inf")] * 3
    with open(mesh) as lines:
        for line in lines:
            if line.startswith("v "):
                vertex = [float(word) for word in line.split()[1:4]]
                lo = [min(pair) for pair in zip(lo, vertex)]
                hi = [max(pair) for pair in zip(hi, vertex)]
    edge = max(b - a for a, b in zip(lo, hi)) * n / (n - 2)
    centre = [(a + b) / 2 for a, b in zip(lo, hi)]
    return {
        "units": "mm",
        "grid": {
            "min": [c - edge / 2 for c in centre],
            "max": [c + edge / 2 for c in centre],
            "cells": [n, n, n],
        },
        "materials": {"stone": {"color": "#c9b79c"}},
        "bodies": [{"mesh": os.path.abspath(mesh), "material": "stone"}],
    }


if __name__ == "__main__":
    if len(sys.argv) != 4 or not sys.argv[2].isdigit() or int(sys.argv[2]) < 3:
        sys.exit(__doc__)
    with open(sys.argv[3], "w") as scene:
        json.dump(cubic_scene(sys.argv[1], int(sys.argv[2])), scene, indent=1)
        scene.write("\n")

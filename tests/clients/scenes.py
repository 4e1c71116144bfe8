"""The two grids that the clients read. No size is a multiple of that of a chunk or a tile, and none can be halved evenly.

stadium: the built-in scene, three materials, in chunks of 64 cells whose edges cut bodies.
parts: 300 materials, so that a cell takes two bytes, and a graded axis, in slices of several tiles.
"""
import colorsys
import json
import os
import pathlib
import random
import subprocess

BOX = [((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)), ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
       ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)), ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))]


def unit_cube():
    facets = [f for a, b, c, d in BOX for f in ((a, b, c), (a, c, d))]
    lines = [f"facet normal 0 0 0 outer loop {' '.join('vertex %g %g %g' % v for v in facet)} endloop endfacet" for facet in facets]
    return "solid cube\n" + "\n".join(lines) + "\nendsolid cube\n"


def parts():
    """Cubes that are stretched and turned, a hundred per layer, over a domain of 1301 x 701 x 9 cells."""
    draw = random.Random(4)
    count = 300
    bodies, materials = [], {"filler": {"color": "#f4f1ea"}}
    for i in range(count):
        r, g, b = colorsys.hsv_to_rgb(draw.random(), 0.35 + 0.6 * draw.random(), 0.5 + 0.5 * draw.random())
        materials[f"part {i}"] = {"color": "#%02x%02x%02x" % (int(255 * r), int(255 * g), int(255 * b))}
        bodies.append({"name": f"part {i}", "mesh": "cube.stl", "material": f"part {i}",
                       "matrix": [4 + 9 * draw.random(), draw.uniform(-2, 2), 0, 5 + 10 * (i % 20), draw.uniform(-2, 2), 3 + 7 * draw.random(), 0,
                                  3 + 7 * (i // 20), 0, 0, 0.3 + 0.5 * draw.random(), draw.choice([0, 0.2, 0.4])]})
    planes = [0.0]
    for i in range(1301):  # finer in the middle
        planes.append(planes[-1] + 0.1 + 0.15 * abs(i - 650) / 650)
    return {"units": "mm", "grid": {"min": [0, 0, 0], "max": [planes[-1], 110, 1.1], "cells": [1301, 701, 9], "x": {"planes": planes}},
            "background": "filler", "materials": materials, "bodies": bodies}


def write(program, folder):
    """Writes the scenes' files into the folder and returns the arguments of `teracell mesh` by grid."""
    subprocess.run([program, "sample", "stadium", "-o", "stadium"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    pathlib.Path(folder, "cube.stl").write_text(unit_cube())
    pathlib.Path(folder, "parts.json").write_text(json.dumps(parts()))
    return {"stadium": ["stadium/scene.json", "--cells", "301"], "parts": ["parts.json"]}

"""Forty grids: what is read, how cells are placed, what is inside, what closes and thickens, and how it is worked out. They are small, and their
rays meet edges, vertices and facets."""
import gzip
import io
import json

import assemblies
from surfaces import *

def threemf(*assembly):
    file = io.BytesIO()
    assemblies.threemf(file, *assembly, "inch")
    return file.getvalue()


BALL, RING = ball(4.0, 6), torus(4.0, 1.5, 5)
LUMP = on_lattice(ball(5.0, 7), 0.5)  # with steps of 1 or 0.5, sample points lie on its vertices, edges and facets
CUBE = box((-3.0, -3.0, -3.0), (3.0, 3.0, 3.0))
OPEN = [f for i, f in enumerate(BALL) if i % 37 != 5]
TURN = {"axis": [1, 2, 3], "degrees": 37}
LATTICE = {"min": [-8, -8, -8], "max": [8, 8, 8], "step": 0.5}

GRIDS = []  # (name, inputs, arguments of `teracell mesh`)


def grid(name, inputs, *arguments):
    texts = {file: json.dumps(what) if isinstance(what, dict) else what for file, what in inputs.items()}
    GRIDS.append((name, {file: text.encode() if isinstance(text, str) else text for file, text in texts.items()}, arguments))


def scene(name, surfaces, cells, *arguments, bodies=None, **keys):
    """A scene of PLY files. `bodies` has the keys of each body beside its mesh."""
    materials = {f"m{i}": {} for i in range(len(surfaces))}
    listed = [{"mesh": f"{i}.ply", "material": f"m{i}", **(bodies[i] if bodies else {})} for i in range(len(surfaces))]
    grid(name, {**{f"{i}.ply": ply(s) for i, s in enumerate(surfaces)}, "s.json": {"grid": cells, "materials": materials, "bodies": listed, **keys}},
         "s.json", *arguments)


# Files.
grid("STL", {"a.stl": stl(RING)}, "a.stl", "--cells", 70)
grid("ASCII STL, compressed", {"a.stl.gz": gzip.compress(ascii_stl(RING).encode())}, "a.stl.gz", "--cells", 70)
grid("OBJ with groups", {"a.obj": obj({"ring": RING, "ball": BALL})}, "a.obj", "--by-part", "--cells", 60, "--links")
grid("PLY, big endian", {"a.ply": big_ply(RING)}, "a.ply", "--step", 0.17)
grid("OFF", {"a.off": off(RING)}, "a.off", "--cells", "64,33,47")
grid("glTF", {"a.gltf": assemblies.embedded_gltf(*assemblies.machine())}, "a.gltf", "--by-part", "--cells", 90)
grid("GLB, in millimetres", {"a.glb": assemblies.glb(*assemblies.machine())}, "a.glb", "--by-part", "--cells", 90, "--units", "mm")
grid("3MF", {"a.3mf": threemf(*assemblies.machine())}, "a.3mf", "--by-part", "--cells", 90)

# Places of cells.
scene("rays along x", [LUMP], LATTICE, "--axis", "x")
scene("rays along y", [LUMP], LATTICE, "--axis", "y")
scene("rays along z", [LUMP], LATTICE, "--axis", "z")
scene("graded axes", [LUMP, RING], {d: {"planes": [i * abs(i) / 12 for i in range(-10, 11)]} for d in "xyz"})
scene("sample points of Yee cells", [LUMP, RING], LATTICE, sample=[0, 0.5, 0.5])
scene("sample points on planes", [LUMP], LATTICE, sample=[0, 0, 0])
scene("planes at faces", [CUBE, moved(CUBE, (0.37, 1.0, 2.0))], {"auto": {"finest": 0.05, "coarsest": 1, "resolution": {"m1": {"across": 9}}}})
scene("planes by thirds", [CUBE, moved(CUBE, (6.0, 0.1, 0.0), (1.0, 1.0, 0.01))],
      {"auto": {"finest": 0.02, "coarsest": 1, "snap": "thirds", "metals": ["m1"], "growth": 1.17}}, bodies=[{}, {"thin": "keep"}])
scene("far from the origin", [moved(LUMP, (1e9, -1e9, 1e9))], {"step": 0.25})
scene("near the smallest numbers", [moved(BALL, (0.0, 0.0, 0.0), (1e-70, 1e-70, 1e-70))], {"cells": 50})
scene("near the largest numbers", [moved(BALL, (0.0, 0.0, 0.0), (1e70, 1e70, 1e70))], {"cells": 50})
scene("many cells along one axis", [moved(LUMP, (0.0, 0.0, 0.0), (1e5, 1.0, 1.0))], {"cells": [100_000, 12, 12]})

# Bodies at their places.
scene("turned by 37 degrees", [CUBE, RING], LATTICE, bodies=[{"rotate": TURN}, {"rotate": {"axis": [0, 1, 0.1], "degrees": -111.1}}])
scene("turned by quarters", [CUBE, LUMP], LATTICE, bodies=[{"rotate": {"axis": [0, 0, 1], "degrees": 90}}, {"scale": [-1, 1, 0.5], "translate": [1, 0, 0]}])
scene("sheared", [BALL], LATTICE, bodies=[{"matrix": [1, 0.3, 0, 1 / 3, 0, 0.9, 0.1, 0, 0, 0, 1.1, 0]}])
scene("stronger and weaker", [BALL, RING, CUBE], LATTICE, "--thin", bodies=[{"priority": 2}, {"material": "air"}, {"priority": -1, "rotate": TURN}],
      label_by="body")
scene("side by side", [moved(CUBE, (6.0 * i, 0.0, 6.0 * (i // 2))) for i in range(4)], {"step": 0.75})

# What is inside.
scene("nonzero", [BALL + moved(BALL, (1.0, 1.0, 1.0)) + RING], LATTICE, bodies=[{"fill": "nonzero"}])
scene("evenodd", [BALL + moved(BALL, (1.0, 1.0, 1.0)) + RING], LATTICE, bodies=[{"fill": "evenodd"}])
scene("distinct, given twice", [LUMP + [(a, c, b) for a, b, c in LUMP] + RING], LATTICE)
scene("facets that belong to nothing", [soup(150, 3)], LATTICE, bodies=[{"fill": "evenodd"}])

# What is open or thin.
scene("holes", [OPEN, moved(OPEN, (2.0, 1.0, 0.0))], LATTICE, "--fractions", "2,4,2", "--links", bodies=[{}, {"rotate": TURN}])
scene("a wide hole", [BALL[:-150]], LATTICE)
scene("seams", [shaken(BALL, 0.02, 5)], LATTICE)
scene("relief", [relief(16, 8)], {"min": [0, 0, -2], "max": [16, 16, 5], "cells": [64, 48, 56]}, bodies=[{"closing": {"extrude": "-z"}}])
scene("sheet", [LUMP, moved(RING, (0.01, 0.0, 0.0))], LATTICE, bodies=[{"kind": "sheet"}, {"kind": "sheet", "rotate": TURN}])
scene("needles that are kept", [needles(60, 2), BALL], LATTICE, "--thin", bodies=[{"thin": "keep", "priority": 1}, {}])

# Ways to work it out, and what lies inside the boundary.
scene("by search", [LUMP, RING], LATTICE, "--engine", "tree")
scene("in slices", [LUMP, RING], LATTICE, "--engine", "slice", "--threads", 3)
scene("in little memory", [ball(6.0, 40)], {"cells": 120}, "--memory", "16M")
scene("shares and links", [BALL, RING, LUMP], LATTICE, "--fractions", "4,4,4", "--links", bodies=[{"rotate": TURN}, {}, {"priority": -1}])
grid("the stadium", {}, "stadium/scene.json", "--links", "--thin")
assert len(GRIDS) == 40

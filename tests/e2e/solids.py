"""Boxes: surfaces in every format, and the cells they must have. A box owns its lower faces and not its upper ones, so
its cells are those with low <= sample point < high: an oracle without geometry."""
import gzip
import math
import struct

CORNERS = [(i & 1, i >> 1 & 1, i >> 2 & 1) for i in range(8)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]  # outward


def box_vertices(lo, hi):
    return [tuple((lo, hi)[c[d]][d] for d in range(3)) for c in CORNERS]


def box_facets(lo, hi):
    v = box_vertices(lo, hi)
    return [(v[q[0]], v[q[a]], v[q[a + 1]]) for q in QUADS for a in (1, 2)]


def binary_stl(facets):
    out = bytearray(b"boxes".ljust(80, b"\0") + struct.pack("<I", len(facets)))
    for f in facets:
        out += struct.pack("<12fH", 0, 0, 0, *[x for v in f for x in v], 0)
    return bytes(out)


def ascii_stl(facets, name="box"):
    lines = [f"solid {name}"]
    for f in facets:
        lines += ["facet normal 0 0 0", " outer loop", *[f"  vertex {v[0]!r} {v[1]!r} {v[2]!r}" for v in f], " endloop", "endfacet"]
    return "\n".join(lines + [f"endsolid {name}", ""])


def obj(lo, hi):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in box_vertices(lo, hi)]
    return "\n".join(lines + ["f " + " ".join(str(i + 1) for i in q) for q in QUADS] + [""])


def ply(lo, hi, order):
    head = (f"ply\nformat {order} 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\n"
            "element face 6\nproperty list uchar int vertex_indices\nend_header\n").encode()
    v = box_vertices(lo, hi)
    if order == "ascii":
        return head + "\n".join([" ".join(map(repr, p)) for p in v] + ["4 " + " ".join(map(str, q)) for q in QUADS] + [""]).encode()
    mark = "<" if order == "binary_little_endian" else ">"
    return head + b"".join(struct.pack(mark + "3d", *p) for p in v) + b"".join(struct.pack(mark + "B4i", 4, *q) for q in QUADS)


def every_format(lo, hi):
    """name -> contents."""
    f = box_facets(lo, hi)
    return {"binary.stl": binary_stl(f), "ascii.stl": ascii_stl(f).encode(), "box.obj": obj(lo, hi).encode(),
            "ascii.ply": ply(lo, hi, "ascii"), "little.ply": ply(lo, hi, "binary_little_endian"),
            "big.ply": ply(lo, hi, "binary_big_endian"), "zipped.stl.gz": gzip.compress(binary_stl(f)),
            "misnamed.dat": binary_stl(f)}


def centres(low, step, n, sample=0.5):
    return [low + (i + sample) * step for i in range(n)]


def graded_centres(planes, sample=0.5):
    return [a + sample * (b - a) for a, b in zip(planes, planes[1:])]


def cells_of(axes, boxes):
    """Material ids, C order [z][y][x]; `boxes` are (lo, hi, material), the strongest last."""
    out = bytearray(math.prod(map(len, axes)))
    nx, ny = len(axes[0]), len(axes[1])
    for lo, hi, material in boxes:
        inside = [[i for i, c in enumerate(axes[d]) if lo[d] <= c < hi[d]] for d in range(3)]
        for z in inside[2]:
            for y in inside[1]:
                for x in inside[0]:
                    out[(z * ny + y) * nx + x] = material
    return bytes(out)

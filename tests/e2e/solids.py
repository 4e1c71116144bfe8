"""Boxes: surfaces in every format, and the cells that they must have. A box owns its lower faces and not its upper ones, so
its cells are those with low <= sample point < high."""
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


def flip(facet):
    return (facet[0], facet[2], facet[1])


def walls(lo, hi):
    """A box without bottom and top."""
    return [f for f in box_facets(lo, hi) if len({v[2] for v in f}) > 1]


def ply_of(facets):
    """A binary PLY file with doubles."""
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {3 * len(facets)}\nproperty double x\nproperty double y\nproperty double z\n"
            f"element face {len(facets)}\nproperty list uchar uint vertex_indices\nend_header\n").encode()
    return (head + b"".join(struct.pack("<9d", *[x for v in f for x in v]) for f in facets)
            + b"".join(struct.pack("<B3I", 3, 3 * i, 3 * i + 1, 3 * i + 2) for i in range(len(facets))))


def read_facets(data):
    """The facets of a file: STL (binary), PLY (ASCII, or binary as ply_of() writes it) or a simple OBJ."""
    if data[:4] == b"ply\n":
        head, body = data.split(b"end_header\n", 1)
        vertices, faces = (int(head.split(f"element {what} ".encode())[1].split()[0]) for what in ("vertex", "face"))
        if b"format ascii" in head:
            lines = body.split(b"\n")
            v = [tuple(map(float, line.split()[:3])) for line in lines[:vertices]]
            return [tuple(v[int(i)] for i in line.split()[1:4]) for line in lines[vertices : vertices + faces]]
        x = struct.unpack(f"<{3 * vertices}d", body[: 24 * vertices])
        return [tuple(tuple(x[9 * i + 3 * k : 9 * i + 3 * k + 3]) for k in range(3)) for i in range(faces)]
    if data[:2] in (b"v ", b"# "):
        lines = [line.split() for line in data.split(b"\n")]
        v = [tuple(map(float, words[1:4])) for words in lines if words[:1] == [b"v"]]
        return [tuple(v[int(w.split(b"/")[0]) - 1] for w in words[1:4]) for words in lines if words[:1] == [b"f"]]
    return [tuple(x[3 + 3 * k : 6 + 3 * k] for k in range(3)) for x in struct.iter_unpack("<12fH", data[84:])]


def open_edges(facets):
    """Directed edges that their reverse does not match, with their net count."""
    net = {}
    for f in facets:
        for a, b in zip(f, f[1:] + f[:1]):
            if a != b:
                key, sign = ((a, b), 1) if a < b else ((b, a), -1)
                net[key] = net.get(key, 0) + sign
    return {edge: n for edge, n in net.items() if n}


def volume(facets):
    """By the divergence theorem."""
    return math.fsum(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]) for a, b, c in facets) / 6

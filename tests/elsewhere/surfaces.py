"""Surfaces made by additions, multiplications, divisions and square roots of doubles alone, which round alike on every machine: a sine does not."""
import random
import struct

import solids


def circle(quarter):
    """4 * quarter points of the unit circle, from (1, 0) on."""
    points = [((1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)) for t in (i / quarter for i in range(quarter))]
    for _ in range(3):
        points += [(-y, x) for x, y in points[-quarter:]]
    return points


def turned(profile, quarter, closed=False):
    """What a line of (radius, z), upwards on the outside, leaves when it is turned around z."""
    around = circle(quarter)
    rings = [[(r * x, r * y, z) for x, y in around] for r, z in profile]
    facets = []
    for a, b in zip(rings, rings[1:] + rings[:1] if closed else rings[1:]):
        for i in range(len(around)):
            k = (i + 1) % len(around)
            facets += [f for f in ((a[i], a[k], b[k]), (a[i], b[k], b[i])) if len(set(f)) == 3]
    return facets


def ball(radius, quarter):
    side = circle(quarter)
    half = side[3 * quarter:] + side[:quarter + 1]
    return turned([(radius * max(x, 0.0), radius * y) for x, y in half], quarter)


def torus(radius, tube, quarter):
    return turned([(radius + tube * x, tube * y) for x, y in circle(quarter)], quarter, closed=True)


def moved(facets, by, times=(1.0, 1.0, 1.0)):
    return [tuple(tuple(v[d] * times[d] + by[d] for d in range(3)) for v in f) for f in facets]


def on_lattice(facets, step):
    """Vertices on the points of a lattice: rays through these meet edges and vertices, and facets lose their area."""
    return [tuple(tuple(round(x / step) * step for x in v) for v in f) for f in facets]


def soup(count, seed):
    """Facets that belong to nothing."""
    rng = random.Random(seed)
    return [tuple(tuple(rng.randrange(-40, 41) / 8 for _ in range(3)) for _ in range(3)) for _ in range(count)]


def shaken(facets, by, seed):
    """Every vertex of every facet is moved on its own, so that all edges are seams."""
    rng = random.Random(seed)
    return [tuple(tuple(x + by * (rng.random() - 0.5) for x in v) for v in f) for f in facets]


def relief(n, seed):
    """An open surface over n x n squares, of facets that face upwards."""
    rng = random.Random(seed)
    height = [[rng.randrange(64) / 16 for _ in range(n + 1)] for _ in range(n + 1)]
    at = lambda i, j: (float(i), float(j), height[i][j])
    return [f for i in range(n) for j in range(n) for f in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))]


def needles(count, seed):
    """Tetrahedra, long and thinner than a cell."""
    rng = random.Random(seed)
    out = []
    for _ in range(count):
        a = [rng.random() * 8 - 4 for _ in range(3)]
        b = [x + rng.random() * 6 - 3 for x in a]
        c, d = ([x + (rng.random() - 0.5) / 8 for x in a] for _ in range(2))
        p = [tuple(q) for q in (a, b, c, d)]
        out += [(p[0], p[2], p[1]), (p[0], p[1], p[3]), (p[1], p[2], p[3]), (p[2], p[0], p[3])]
    return out


def obj(groups):
    """A group for each name, with its facets."""
    lines, count = [], 0
    for name, facets in groups.items():
        lines.append(f"g {name}")
        for f in facets:
            lines += ["v %r %r %r" % v for v in f] + [f"f {count + 1} {count + 2} {count + 3}"]
            count += 3
    return "\n".join(lines + [""])


def off(facets):
    lines = ["OFF", f"{3 * len(facets)} {len(facets)} 0", *["%r %r %r" % v for f in facets for v in f]]
    return "\n".join(lines + [f"3 {3 * i} {3 * i + 1} {3 * i + 2}" for i in range(len(facets))] + [""])


def big_ply(facets):
    head = (f"ply\nformat binary_big_endian 1.0\nelement vertex {3 * len(facets)}\nproperty double x\nproperty double y\nproperty double z\n"
            f"element face {len(facets)}\nproperty list uchar uint vertex_indices\nend_header\n").encode()
    return (head + b"".join(struct.pack(">9d", *[x for v in f for x in v]) for f in facets)
            + b"".join(struct.pack(">B3I", 3, 3 * i, 3 * i + 1, 3 * i + 2) for i in range(len(facets))))


ply, stl, ascii_stl, box = solids.ply_of, solids.binary_stl, solids.ascii_stl, solids.box_facets

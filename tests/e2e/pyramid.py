"""Coarser levels by brute force, and the colours of sets, mixed with equal weights."""


def masks(cells):
    """Cells as sets: one byte per cell, one bit per material."""
    return cells.translate(bytes(1 << i if i < 8 else 0 for i in range(256)))


def unite(a, b):
    return (int.from_bytes(a, "little") | int.from_bytes(b, "little")).to_bytes(len(a), "little")


def halve(shape, sets):
    """The next level: (shape, sets), C order [z][y][x]."""
    nz, ny, nx = shape
    row = lambda z, y: sets[(z * ny + y) * nx : (z * ny + y + 1) * nx]
    out = []
    for z in range(0, nz, 2):
        for y in range(0, ny, 2):
            both = row(z, y)
            for zz, yy in ((z, y + 1), (z + 1, y), (z + 1, y + 1)):
                if zz < nz and yy < ny:
                    both = unite(both, row(zz, yy))
            even, odd = both[0::2], both[1::2]
            out.append(unite(even, odd.ljust(len(even), b"\0")))
    return tuple((n + 1) // 2 for n in shape), b"".join(out)


def strongest(sets, order):
    """The strongest material of each set; `order` lists the materials, the strongest first."""
    table = bytes(next((m for m in order if s >> m & 1), 255) for s in range(256))
    return sets.translate(table)


def box(shape, values, lo, hi):
    """The cells of a box (x, y, z, half open) of an array."""
    nz, ny, nx = shape
    return b"".join(values[(z * ny + y) * nx + lo[0] : (z * ny + y) * nx + hi[0]] for z in range(lo[2], hi[2]) for y in range(lo[1], hi[1]))


def plane(shape, values, axis, index):
    """(rows, columns, values) of a slice, [v][u]."""
    d = "xyz".index(axis)
    lo, hi = [0, 0, 0], list(shape[::-1])
    lo[d], hi[d] = index, index + 1
    columns, rows = (hi[e] for e in range(3) if e != d)
    return rows, columns, box(shape, values, lo, hi)


def color(text):
    return tuple(int(text[i : i + 2], 16) for i in range(1, len(text), 2)) + ((255,) if len(text) == 7 else ())


def blend(colors):
    """The mean of premultiplied 8-bit colours with equal weights. Halves are rounded up, and the result has straight alpha, as in a PNG."""
    if len(colors) == 1:
        return colors[0]
    half_up = lambda a, b: (2 * a + b) // (2 * b)
    n = len(colors)
    alpha = half_up(sum(c[3] for c in colors), n)
    if alpha == 0:
        return 0, 0, 0, 0
    mean = [half_up(sum(half_up(c[i] * c[3], 255) for c in colors), n) for i in range(3)]
    return (*[min(255, half_up(m * 255, alpha)) for m in mean], alpha)
